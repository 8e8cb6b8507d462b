# SPDX-License-Identifier: Apache-2.0
"""Springback after implicit forming: the same case file as after explicit, one key changed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.model import Model, PrescribedDisplacement
from tests.regression.test_springback import CURVATURE, LENGTH, THICKNESS, YOUNG, bend, bend_model, curvature_of, moment
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end


def implicit_model() -> Model:
    """The strip of test_springback, bent implicitly: nothing but its mass holds it, as in explicit dynamics."""
    settings = {"inertia": 1.0, "damping": 2e3, "max_increment": 0.05}
    model = build_model(StampingCase.model_validate(bend(procedure="implicit", implicit=settings)))
    turn = PrescribedDisplacement("right", 4, CURVATURE * LENGTH)
    return replace(model, stages=(replace(model.stages[0], prescribed=(turn,)),))


@pytest.fixture(scope="module")
def bent(tmp_path_factory) -> Result:
    return run_to_end(implicit_model(), tmp_path_factory.mktemp("bend") / "out")


def test_a_bent_strip_keeps_the_curvature_of_the_closed_form(bent) -> None:
    """k - M(k)/E I."""
    assert len(bent.times) == 4
    assert curvature_of(bent.points(2)) == pytest.approx(CURVATURE, rel=1e-3)
    kept = CURVATURE - moment(CURVATURE) / (YOUNG * THICKNESS**3 / 12)
    assert curvature_of(bent.points(3)) == pytest.approx(kept, rel=1e-3)


def test_one_key_changed_gives_the_same_springback(bent, tmp_path) -> None:
    other = run_to_end(bend_model(), tmp_path / "out")
    assert set(bent.field_names) == set(other.field_names)
    assert curvature_of(bent.points(3)) == pytest.approx(curvature_of(other.points(3)), rel=1e-3)
    largest = [r.summary["springback"]["largest_mm"] for r in (bent, other)]
    assert largest[0] == pytest.approx(largest[1], rel=5e-3)


def test_what_is_recorded_of_springback(bent) -> None:
    """The last step holds the released part, with the way since the step before; energies go on."""
    sprung = bent.field("springback", 3)
    np.testing.assert_allclose(sprung, bent.field("displacement", 3) - bent.field("displacement", 2), atol=1e-12)
    assert not bent.field("springback", 2).any()
    assert bent.summary["springback"]["largest_mm"] == pytest.approx(np.linalg.norm(sprung, axis=1).max())
    assert bent.summary["springback"]["increments"] == 4
    history = bent.history
    assert list(history["stage"][-5:]) == ["bend", *4 * ["springback"]]
    assert (np.diff(history["increment"]) == 1).all()
    assert (np.diff(history["time"]) > 0).all()
    assert (np.diff(history["elastic_energy"])[-4:] < 0).all()
    np.testing.assert_allclose(
        np.diff(history["external_work"])[-4:], np.diff(history["elastic_energy"])[-4:], rtol=0.01
    )
    assert abs(history["energy_error_percent"][-1]) < 0.5
    np.testing.assert_allclose(bent.field("eqps", 3), bent.field("eqps", 2), rtol=1e-6)
    assert np.abs(bent.field("reaction_force", 3)).max() < 1e-3


@pytest.mark.parametrize("before_the_end", [4, 2])
def test_a_run_stopped_before_or_within_springback_resumes_to_the_same_bits(
    bent, tmp_path: Path, before_the_end
) -> None:
    run_in_two_parts(implicit_model(), tmp_path / "out", len(bent.history["time"]) - before_the_end)
    assert_same_bits(tmp_path / "out", bent.folder)
