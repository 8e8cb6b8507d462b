# SPDX-License-Identifier: Apache-2.0
"""Inertia and damping in implicit stampings: their work in closed form, and the blanks that they steady."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model
from presswork.recorder import Outcome, run_model
from tests.regression.test_implicit_stamping import CUP, STRIP
from tests.regression.whole_runs import run_stamping

DENSITY, WAY, DURATION, RISE = 7.85e-9, 40.0, 0.02, 0.5
MASS = DENSITY * 10 * 4 * 0.8
"""Of the quarter of the strip that is computed [t]."""
PEAK = WAY / (DURATION * (1 - RISE))
"""Velocity between the smooth start and the smooth end, here half-way [mm/s]."""


def carry_strip(folder: Path, **implicit: float) -> Outcome:
    """Carry a strip along, which nothing else holds, by its end."""
    stage = {"name": "carry", "duration": DURATION, "ramp": RISE * DURATION,
             "displacement": [{"set": "right", "component": "x", "value": WAY}]}  # fmt: skip
    steel = {**STRIP["materials"]["steel"], "density": DENSITY}
    blank = {**STRIP["blank"], "symmetry": ["y"], "size": [10, 8]}
    data = {**copy.deepcopy(STRIP), "boundary": {}, "stages": [stage], "blank": blank, "materials": {"steel": steel}}
    settings = {"max_increment": 0.005, **implicit}
    return run_model(build_model(StampingCase.model_validate({**data, "implicit": settings})), folder, threads=1)


def test_work_against_inertia_is_the_kinetic_energy(tmp_path) -> None:
    """Of a strip carried along; when it stands again, what is left is what backward Euler lost."""
    outcome = carry_strip(tmp_path / "out", inertia=1.0)
    assert outcome.status == "completed", outcome.reason
    history = outcome.result.history
    middle = np.argmin(np.abs(history["time"] - 0.5 * DURATION))
    kinetic = 0.5 * MASS * PEAK**2
    assert history["inertia_work"][middle] == pytest.approx(kinetic, rel=0.03)
    assert history["external_work"][middle] == pytest.approx(kinetic, rel=0.03)
    assert 0.0 <= history["inertia_work"][-1] < 0.05 * kinetic
    np.testing.assert_allclose(outcome.result.field("displacement")[:, 0], WAY, rtol=1e-5)
    assert history["time"][-1] == pytest.approx(DURATION)


def test_damping_takes_its_work_and_a_warning_says_when_it_is_much(tmp_path) -> None:
    """c m times the integral of the squared velocity: 3/8 of the peak's in the mean of a half-cosine rise."""
    damping = 1e3
    damped, free = (carry_strip(tmp_path / f"{c:g}", inertia=1.0, damping=c).result for c in (damping, 0.0))
    work = damped.history["inertia_work"][-1] - free.history["inertia_work"][-1]
    assert work == pytest.approx(damping * MASS * PEAK**2 * DURATION * (1 - 2 * RISE + 2 * 3 / 8 * RISE), rel=0.01)
    assert any("inertia took" in w and "implicit.inertia" in w for w in damped.summary["warnings"])


def test_a_blank_that_lies_loose_is_drawn(tmp_path) -> None:
    """The holder stands off; with the sheet's own mass it goes through, as by explicit dynamics, and inertia takes
    little."""
    loose: dict[str, Any] = copy.deepcopy(CUP)
    loose["blank"] |= {"thickness": 0.5, "size": [90, 90]}
    loose["tools"]["holder"]["gap"] = 0.9
    loose["stages"] = [{"name": "draw", "tools": {"punch": {"stroke": 10}}}]
    steadied = run_stamping(loose, tmp_path / "out", implicit={"inertia": 1.0})
    energy = steadied.summary["energy"]
    assert 0.0 < energy["inertia_work"] < 0.01 * (energy["elastic_energy"] + energy["plastic_work"])
    assert [text for text in steadied.summary["warnings"] if "shells are too long" not in text] == []
    other = run_stamping(loose, tmp_path / "explicit", procedure="explicit", implicit={})
    late = steadied.history["punch.stroke"] > 5
    force = np.interp(steadied.history["punch.stroke"], other.history["punch.stroke"], other.history["punch.force"])
    np.testing.assert_allclose(steadied.history["punch.force"][late].mean(), force[late].mean(), rtol=0.05)


def test_damping_without_inertia_is_refused() -> None:
    with pytest.raises(CaseError, match=r"implicit.damping.*inertia is 0.*inertia = 1"):
        StampingCase.model_validate({**CUP, "implicit": {"damping": 1e3}})
