# SPDX-License-Identifier: Apache-2.0
"""Upsetting with friction by explicit dynamics, slow enough for inertia to be small, against the implicit procedure."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.recorder import run_model
from presswork.results import Result

RADIUS, HEIGHT, STROKE = 10.0, 15.0, 4.5


def upset(procedure: str, folder: Path, **stage: Any) -> Result:
    """Upset a cylinder between two rough tools, all of its height."""
    steel: dict[str, Any] = {
        "young": 210e3,
        "poisson": 0.3,
        "hardening": {"law": "swift", "K": 700, "e0": 0.01, "n": 0.2},
    }
    output = {"steps": 1}
    if procedure == "explicit":
        steel["density"], output["rows"] = "7850 kg/m^3", 40
    case = Case.model_validate({
        "title": "upsetting", "analysis": "axisymmetric", "procedure": procedure, "materials": {"steel": steel},
        "workpiece": {"material": "steel", "element": "quad4_1pt",
                      "mesh": {"size": [RADIUS, HEIGHT], "cells": [8, 12]}},
        "tools": {"punch": {"profile": [[0, HEIGHT], [30, HEIGHT]], "contact": "coulomb", "mu": 0.1},
                  "anvil": {"profile": [[0, 0], [30, 0]], "contact": "coulomb", "mu": 0.1}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}},
        "stages": [{"name": "upset", "tools": {"punch": {"stroke": STROKE, "direction": [0, -1]}}, **stage}],
        "output": output,
    })  # fmt: skip
    outcome = run_model(build_model(case), folder, threads=1)
    assert outcome.status == "completed"
    return outcome.result


@pytest.fixture(scope="module")
def implicit(tmp_path_factory: pytest.TempPathFactory) -> Result:
    return upset("implicit", tmp_path_factory.mktemp("implicit") / "out")


def compare_forces(explicit: Result, implicit: Result) -> np.ndarray:
    """Force over the implicit one, row by row, each by its mean stroke, once all of the cylinder flows."""
    stroke, force = explicit.history["punch.stroke"], explicit.history["punch.force"]
    mean = 0.5 * (stroke + np.concatenate([[0.0], stroke[:-1]]))
    expected = np.interp(mean, implicit.history["punch.stroke"], implicit.history["punch.force"])
    return np.asarray((force / expected)[mean > 0.5])


def test_slow_upsetting_with_friction_agrees_with_the_implicit_procedure(implicit: Result, tmp_path: Path) -> None:
    """2 ms: forces within 0.5 %, work, strain and shape within 0.2 %; the balance within 0.01 %."""
    explicit = upset("explicit", tmp_path / "out", duration="2 ms")
    assert compare_forces(explicit, implicit) == pytest.approx(1.0, abs=0.005)
    assert explicit.field("eqps").max() == pytest.approx(implicit.field("eqps").max(), rel=2e-3)
    np.testing.assert_allclose(explicit.points(-1), implicit.points(-1), atol=2e-3 * RADIUS)
    history = explicit.history
    assert history["kinetic_energy"][-1] < 1e-3 * history["internal_energy"][-1]
    assert np.abs(history["energy_error_percent"]).max() < 0.01
    stroke, force = (np.concatenate([[0.0], implicit.history[f"punch.{name}"]]) for name in ("stroke", "force"))
    assert history["external_energy"][-1] == pytest.approx(np.trapezoid(force, stroke), rel=2e-3)
    assert history["friction_energy"][-1] > 0.005 * history["internal_energy"][-1]
    assert explicit.summary["warnings"] == []


def test_an_even_velocity_and_little_time_show_inertia(implicit: Result, tmp_path: Path) -> None:
    """50 us without a ramp: forces are off by tens of per cent, which a ramp and 20 times the time take away."""
    explicit = upset("explicit", tmp_path / "out", duration="50 us", ramp=0)
    assert np.abs(compare_forces(explicit, implicit) - 1).max() > 0.1
    assert np.abs(explicit.history["energy_error_percent"]).max() < 1.0
