# SPDX-License-Identifier: Apache-2.0
"""Explicit bodies of tetrahedra in space on new meshes: against one mesh, conservation, and the same bits."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case.space.schema import SpaceCase
from presswork.explicit.arrays import SolidArrays
from presswork.law.history import AXES, STRESS
from presswork.process.begin import begin
from presswork.process.explicit.new_meshes import IntervalMeshes
from presswork.process.explicit.present_bodies import find_held
from tests.regression.whole_runs import compare_with_restart
from tests.verification.test_explicit_tools_in_space import BLOCK, Data, run

pytest.importorskip("mmgpy", reason="new meshes in space are made by mmgpy")

SPIKE: Data = copy.deepcopy(BLOCK) | {
    "procedure": "explicit",
    "workpiece": {
        "material": "steel", "element": "tet4_nodal", "mesh": {"kind": "box", "size": [12, 12, 10], "cells": [5, 5, 4]}
    },
    "tools": {
        "die": {
            "shape": "round", "profile": [[5, 25], {"to": [5, 10], "radius": 3}, [40, 10]], "contact": "shear", "m": 0.3
        },
        "anvil": {"shape": "plane", "normal": [0, 0, 1], "contact": "shear", "m": 0.3},
    },
    "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}},
    "stages": [{"name": "press", "duration": "1 ms", "tools": {"die": {"stroke": 5, "direction": [0, 0, -1]}}}],
    "explicit": {"target_step": "0.3 us"},
    "output": {"steps": 1, "rows": 40},
}  # fmt: skip


def upset(**remesh: Any) -> Data:
    """Return a block of tetrahedra that is upset by 40 %."""
    case = copy.deepcopy(BLOCK) | {"procedure": "explicit", "output": {"steps": 1, "rows": 20}}
    case["workpiece"] |= {"element": "tet4_nodal"}
    case["explicit"] = {"target_step": "0.3 us"}
    return case | {"remesh": remesh}


def test_upsetting_on_new_meshes_is_that_on_one() -> None:
    one = run(upset(enabled=False))[1]
    taken, rows = run(upset(every=0.25))
    assert rows[-1]["remeshes"] >= 3
    ratio = np.array([b["die.force"] / a["die.force"] for a, b in zip(one[4:18], rows[4:18], strict=True)])
    np.testing.assert_allclose(ratio, 1.0, atol=0.03)
    ends = [(row["x_max"], row["y_max"]) for row in (one[-1], rows[-1])]
    np.testing.assert_allclose(ends[1], ends[0], rtol=0.01)
    (volume,) = taken.observers.find(IntervalMeshes).bodies.measure()
    assert volume == pytest.approx(750.0, rel=2e-3)
    assert taken.solids.added_mass().mass == pytest.approx(750.0 * 7.85e-9, rel=1e-6)
    assert rows[-1]["internal_energy"] == pytest.approx(one[-1]["internal_energy"], rel=0.02)


@pytest.mark.validation
def test_a_spike_goes_on_where_its_first_mesh_would_fail() -> None:
    taken, rows = run(SPIKE | {"remesh": {"smallest_size": 1.0, "max_cells": 4000}})
    assert rows[-1]["remeshes"] >= 2
    assert rows[-1]["die.stroke"] == pytest.approx(5.0, rel=1e-6)
    assert rows[-1]["z_max"] > 10.1  # metal rises into the hole
    assert sum(taken.observers.find(IntervalMeshes).bodies.measure()) == pytest.approx(1440.0, rel=5e-3)
    gaps = taken.domain._find_gaps(taken.solids.position[np.unique(taken.model.mesh.boundary_faces)])
    assert gaps.min() > -0.05


def test_linear_velocities_and_stresses_come_to_a_new_mesh() -> None:
    taken = begin(build_model(SpaceCase(**(upset(every=1.0) | {"explicit": {}}))), 1)  # no added mass
    next(taken.advance())

    def fields(points: np.ndarray) -> np.ndarray:
        return 100.0 + points @ np.arange(1.0, 19.0).reshape(3, 6)

    def place_cells() -> np.ndarray:
        return taken.solids.position[taken.model.mesh.blocks[0].connectivity].mean(axis=1)

    taken.solids.velocity = fields(taken.solids.position)[:, :3]
    state = taken.solids.state_as_given()
    state[SolidArrays].find_kept(0, STRESS)[:, 0] = fields(place_cells())
    taken.solids.take_state_as_given(state)
    np.testing.assert_allclose(taken.solids.stress, fields(place_cells()), rtol=1e-12)
    mean = np.average(taken.solids.velocity, axis=0, weights=taken.solids.mass)
    assert taken.observers.find(IntervalMeshes).remesh("asked for")
    np.testing.assert_allclose(taken.solids.stress, fields(place_cells()), rtol=1e-6)
    shift = taken.solids.velocity - fields(taken.solids.position)[:, :3]
    free = ~find_held(taken)
    assert np.ptp(shift[free[:, 2], 2]) < 1e-6  # one for all nodes: the body goes on as fast
    after = np.average(taken.solids.velocity, axis=0, weights=taken.solids.mass)
    np.testing.assert_allclose(after[2], mean[2], rtol=1e-12)


def test_a_restart_gives_the_same_bits() -> None:
    compare_with_restart(build_model(SpaceCase(**upset(every=0.25))), 8, 2, until=12)


def test_a_hot_body_keeps_its_heat_on_new_meshes() -> None:
    case = upset(every=0.5)
    case["materials"] = {"steel": {"library": "c45"}}
    die = {"temperature": 200, "conductance": "10 kW/(m^2*K)"}
    case["tools"]["die"] |= {"heat": die}
    case["heat"] = {"initial_temperature": 1100}
    case["stages"][0]["duration"] = "20 ms"
    case["explicit"] = {"target_step": "6 us"}
    taken, rows = run(case)
    assert rows[-1]["remeshes"] >= 1
    axes = taken.solids.state()[SolidArrays].find_kept(0, AXES).reshape(-1, 2, 3)
    products = axes @ axes.transpose(0, 2, 1)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(2), products.shape), atol=1e-12)
    assert rows[-1]["heat_stored"] == pytest.approx(
        rows[-1]["heat_plastic"] + rows[-1]["heat_tools"] + rows[-1]["heat_friction"], rel=1e-6
    )
    before, after = rows[9]["heat_stored"], rows[10]["heat_stored"]
    assert abs(after - before) < 0.2 * abs(rows[-1]["heat_stored"]) + 1.0
    assert taken.heat.arrays.temperature.min() < 1080.0
