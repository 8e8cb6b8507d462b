# SPDX-License-Identifier: Apache-2.0
"""What a new mesh may not change: homogeneous states, forces, closed forms."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.process.begin import begin


def run(case):
    """Rows of the history, and the recording at its end."""
    recording = begin(build_model(case), 1)
    rows = [recording.row(report) for report in recording.advance()]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, recording


def upsetting(remesh, *, stroke, cells, contact, size=(10.0, 15.0), analysis="axisymmetric"):
    """A block of linear hardening, 700 + 300 e MPa, under a flat platen."""
    width, height = size
    hardening = {"law": "linear", "yield_stress": 700, "modulus": 300}
    return Case(
        title="upsetting",
        analysis=analysis,
        workpiece={"material": "steel", "mesh": {"size": list(size), "cells": cells}},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": hardening}},
        tools={"punch": {"profile": [[0, height], [8 * width, height]], **contact}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}],
        output={"steps": 1},
        solver={"max_increment": 0.02},
        remesh=remesh,
    )


@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_homogeneous_upsetting_does_not_know_of_its_meshes(analysis):
    """Without friction all points share one state: 29 new meshes leave it even, and the force as without any."""
    case = {"stroke": 9.0, "cells": [6, 9], "contact": {"contact": "frictionless"}, "analysis": analysis}
    once, _ = run(upsetting(None, **case))
    often, recording = run(upsetting({"every": 1 / 30, "quality": 0.01}, **case))
    assert often["remeshes"][-1] >= 25
    strain = recording.procedure.state.eqps[0]
    assert np.ptp(strain) < 1e-8 * strain.mean()
    force = np.interp(often["punch.stroke"], once["punch.stroke"], once["punch.force"])
    np.testing.assert_allclose(often["punch.force"], force, rtol=1e-4)


def test_upsetting_with_friction_and_a_new_mesh_every_2_percent_keeps_its_force():
    """To 60 % of the height, m = 0.15: within 0.5 % of the run on one mesh until the side folds onto the platen.

    From 48 % on nodes of the side come to lie on the platen one after the other, on every mesh at other strokes.
    """
    case = {"stroke": 9.0, "cells": [20, 30], "contact": {"contact": "shear", "m": 0.15}}
    once, _ = run(upsetting(None, **case))
    often, recording = run(upsetting({"every": 1 / 30}, **case))
    assert often["remeshes"][-1] >= 29
    force = np.interp(often["punch.stroke"], once["punch.stroke"], once["punch.force"])
    error = np.abs(often["punch.force"] / force - 1)
    assert error[often["punch.stroke"] < 0.48 * 15].max() < 0.005
    assert error.max() < 0.01
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 0.5
