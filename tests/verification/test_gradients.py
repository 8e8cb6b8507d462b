# SPDX-License-Identifier: Apache-2.0
"""Derivatives found in a run, against central differences of whole runs and closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.case.solid.schema import Case
from tests.problems.differentiated import differentiate, largest_error, run_case, upset_cylinder

BY = {
    "materials.steel.young": 200e3,
    "materials.steel.hardening.K": 700.0,
    "materials.steel.hardening.n": 0.2,
    "tools.punch.m": 0.2,
    "stages.0.tools.punch.stroke": 1.2,
    "workpiece.mesh.size.0": 10.0,
}


def test_upsetting_has_the_derivatives_of_whole_runs(tmp_path: Path) -> None:
    data = upset_cylinder(points={"rim": [10, 0]})
    found = differentiate(Case, data, ["punch.force", "rim.x", "damage_cockcroft_latham_max"], BY, tmp_path)
    for key, columns in found.items():
        for name, (own, other) in columns.items():
            assert largest_error(own, other) < 1e-6, (key, name)


def test_force_on_a_cylinder_rises_with_friction_by_the_closed_form(tmp_path: Path) -> None:
    """Thin friction: p / sigma0 = 1 + m d / (3 sqrt3 h) of a cylinder that does not harden (slab method)."""
    flow, radius, half = 300.0, 20.0, 5.0
    data = upset_cylinder(gradients={"by": ["tools.punch.m"]})
    data["workpiece"] = {
        **data["workpiece"],
        "mesh": {"kind": "rectangle", "size": [radius, half], "cells": [24, 6], "pattern": "quad"},
    }
    data["materials"] = {
        "steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": flow, "modulus": 0.0}}
    }
    data["tools"] = {"punch": {"profile": [[0, half], [60, half]], "contact": "shear", "m": 0.005}}
    data["stages"] = [{"name": "upset", "tools": {"punch": {"stroke": 0.2, "direction": [0, -1]}}}]
    found = run_case(Case, data, tmp_path).history
    height, now = 2.0 * (half - 0.2), radius * np.sqrt(half / (half - 0.2))
    own = found["d(punch.force)/d(tools.punch.m)"][-1] / (np.pi * now**2) / flow
    assert own == pytest.approx(2.0 * now / (3.0 * np.sqrt(3.0) * height), rel=0.01)
