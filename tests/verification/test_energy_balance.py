# SPDX-License-Identifier: Apache-2.0
"""The energy balance of the implicit procedure: each side against the integral of forces that the history has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Case, Result, run

STEEL = {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300}}
MU, WAY, PRESS = 0.2, 10.0, 0.005


def block(size: list[float], cells: list[int], origin: list[float]) -> dict[str, Any]:
    return {"material": "steel", "element": "quad4_fbar", "mesh": {"size": size, "cells": cells, "origin": origin}}


def drag(folder: Path, **other: Any) -> Result:
    """Press a block 10 x 5 mm by 0.005 mm and drag its upper edge along x by 10 mm."""
    press = [{"set": "slider.top", "component": "y", "value": -PRESS},
             {"set": "slider.top", "component": "x", "value": 0}]  # fmt: skip
    along = [{"set": "slider.top", "component": "y", "value": 0},
             {"set": "slider.top", "component": "x", "value": WAY}]  # fmt: skip
    case = Case(
        title="block dragged over a block",
        analysis="plane_strain",
        workpiece=block([40, 5], [40, 5], [0, 0]),
        materials={"steel": STEEL},
        boundary={"floor": {"set": "bottom", "fix": ["x", "y"]}},
        bodies={"slider": block([10, 5], [8, 4], [5, 5])},
        contacts={"slide": {"between": ["slider", "workpiece"], "contact": "coulomb", "mu": MU}},
        stages=[{"name": "press", "displacement": press}, {"name": "drag", "displacement": along}],
        solver={"max_increment": 0.1},
        output={"steps": 1},
        **other,
    )
    outcome = run(case, folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return Result(folder)


def test_block_dragged_over_a_block_loses_its_work_to_friction(tmp_path) -> None:
    """The dragged edge's work and what friction takes are both the integral of the contact's force over the way."""
    result = drag(tmp_path / "out")
    energy, history = result.summary["energy"], result.history
    dragged = np.array([stage == "drag" for stage in history["stage"]])
    force = history["slide.force_x"][dragged]
    assert force[1:] == pytest.approx(MU * -history["slide.force_y"][dragged][1:], rel=1e-3)
    way = WAY * (history["time"][dragged] - 1.0)
    work = float(np.trapezoid(np.append(0.0, force), np.append(0.0, way)))
    assert work > 2000.0
    assert energy["friction_work"] == pytest.approx(work, rel=0.005)
    assert energy["external_work"] == pytest.approx(work + energy["elastic_energy"], rel=0.005)
    assert abs(energy["error_percent"]) < 0.1
