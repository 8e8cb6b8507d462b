# SPDX-License-Identifier: Apache-2.0
"""The square cup of Cheng (1995), chapter 4, by the explicit procedure beside the experiment."""

from __future__ import annotations

import numpy as np
import pytest
from square_cup import EXPERIMENT, STROKE, draw_cup, draw_in

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def cup(tmp_path_factory):
    return draw_cup(tmp_path_factory.mktemp("cup"))


def test_the_implicit_procedure_draws_the_same_cup(cup, tmp_path) -> None:
    """One key changed: draw-in within 0.3 mm, punch force within 6 %, thickness strain within 0.01 and 0.04."""
    other = draw_cup(tmp_path, 2.0, 'procedure="implicit"')
    for angle in EXPERIMENT:
        np.testing.assert_allclose(draw_in(other, angle), draw_in(cup, angle), atol=0.3)
    forces = [np.interp(STROKE, r.history["punch.stroke"], r.history["punch.force"]) for r in (cup, other)]
    np.testing.assert_allclose(forces[1], forces[0], rtol=0.06)
    thin, thick = np.subtract(*(r.summary["extremes"]["thickness_strain"] for r in (cup, other)))
    assert abs(thin) < 0.01
    assert abs(thick) < 0.04


@pytest.mark.parametrize("angle", EXPERIMENT)
def test_draw_in_follows_the_experiment(cup, angle) -> None:
    """One choice of holder force and friction for all strokes: within 0.75 mm, 0.45 along the diagonal."""
    apart = np.abs(draw_in(cup, angle) - EXPERIMENT[angle])
    assert apart.max() < (0.75 if angle == 0 else 0.45)


def test_the_cup_is_symmetric_and_quasi_static(cup) -> None:
    np.testing.assert_allclose(draw_in(cup, 0), draw_in(cup, 90), atol=1e-3)
    assert cup.summary["warnings"] == []
    assert np.abs(cup.history["energy_error_percent"]).max() < 0.5
