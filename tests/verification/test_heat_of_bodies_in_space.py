# SPDX-License-Identifier: Apache-2.0
"""Heat between deformable bodies in space: half-spaces in contact, a slice against plane strain, a gap."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.case import Case, CaseError, build_model
from presswork.case.heat.schema import HeatCase
from presswork.case.space.schema import SpaceCase
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.facing import find_facing, sum_pairs
from presswork.process.heat import HeatProcedure
from tests.problems.heat import meet_half_spaces

STEEL = {
    "young": "200 GPa",
    "poisson": 0.0,
    "magnitudes": "any",
    "density": "7800 kg/m^3",
    "thermal": {"conductivity": 30, "specific_heat": "650 J/(kg*K)"},
    "hardening": {"law": "linear", "yield_stress": 5000, "modulus": 0},
}
PASSES = {"conductance": [[0, 0], [1e-6, "10 kW/(m^2*K)"]]}


def compute(case: Any) -> ImplicitProcedure:
    """Compute a case to its end."""
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    return procedure


@pytest.mark.parametrize(
    ("element", "columns"),
    [pytest.param("hex8_fbar", 2, marks=pytest.mark.validation), ("hex8_fbar", 3), ("tet4_mini", 2)],
)
def test_two_bodies_pressed_together_are_two_half_spaces(element: str, columns: int) -> None:
    """Blocks at 1200 and 200 degrees C, 10 kW/m2K, after 1 s: 851.37 and 548.63; on meshes that match or do not."""
    hot = meet_half_spaces(1200, 200, np.sqrt(30.0 * 7800e-12 * 650e6), 10.0, 1.0)
    assert hot == pytest.approx(851.37, abs=0.01)
    depth = {"size": [2, 1, 60], "grading": [1, 1, 300]}
    below = {"origin": [0, 0, -60], "size": [2, 1, 60], "grading": [1, 1, 1 / 300]}
    done = compute(
        SpaceCase.model_validate(
            {
                "title": "half-spaces",
                "analysis": "solid",
                "workpiece": {
                    "material": "steel", "element": element, "mesh": {**depth, "cells": [columns, 1, 30]},
                },
                "bodies": {
                    "lower": {
                        "material": "steel", "element": element, "initial_temperature": 200,
                        "mesh": {**below, "cells": [2, 1, 30]},
                    }
                },
                "materials": {"steel": STEEL},
                "contacts": {"face": {"between": ["workpiece", "lower"], "contact": "frictionless", "heat": PASSES}},
                "heat": {"initial_temperature": 1200},
                "boundary": {
                    **{f"{body}{side}": {"set": f"{body}{side}", "fix": [axis]}
                       for body in ("", "lower.") for side, axis in (("left", "x"), ("bottom", "y"))},
                    "floor": {"set": "lower.back", "fix": ["z"]},
                },
                "stages": [
                    {"name": "press", "duration": 1.0,
                     "displacement": [{"set": "front", "component": "z", "value": -0.01}]}
                ],
                "solver": {"initial_increment": 0.02, "max_increment": 0.1},
            }
        )
    )  # fmt: skip
    temperature, sets = done.state[HeatArrays].temperature, done.model.mesh.node_sets
    assert temperature[sets["back"]] == pytest.approx(hot, abs=4.0)
    assert temperature[sets["lower.front"]] == pytest.approx(1400 - hot, abs=4.0)
    assert np.ptp(temperature[sets["back"]]) < (0.01 if element == "hex8_fbar" else 1.0)
    assert done.heat is not None
    stored = abs(done.heat.forming.stored(done.state[HeatArrays]))
    assert stored < 1e-8 * 2 * 60 * 7800e-12 * 650e6 * 1000, "what one loses the other gains"


@pytest.mark.parametrize("element", ["hex8", "tet4_mini"])
def test_bodies_that_lie_on_each_other_exchange_heat_alone(element: str) -> None:
    """Two half-spaces without forming: 851.37 and 548.63 degrees C after 1 s."""
    mesh = {"size": [2, 1, 60], "grading": [1, 1, 300], "cells": [2, 1, 40]}
    lower = {**mesh, "origin": [0, 0, -60], "grading": [1, 1, 1 / 300], "cells": [3, 1, 40]}
    case = {
        "title": "half-spaces",
        "analysis": "heat",
        "geometry": "solid",
        "initial_temperature": 200,
        "workpiece": {"material": "steel", "element": element, "mesh": mesh, "initial_temperature": 1200},
        "bodies": {"die": {"material": "steel", "element": element, "mesh": lower}},
        "contacts": {"face": {"between": ["workpiece", "die"], "conductance": "10 kW/(m^2*K)"}},
        "materials": {"steel": {"density": "7800 kg/m^3", **STEEL["thermal"]}},
        "stages": [{"name": "wait", "duration": 1.0}],
    }
    done = HeatProcedure(build_model(HeatCase.model_validate(case)), threads=1)
    for _ in done.advance():
        pass
    hot, cold = (done.state["temperature"][done.model.mesh.node_sets[name]].mean() for name in ("back", "die.front"))
    assert hot == pytest.approx(851.37, abs=4.0)
    assert cold == pytest.approx(548.63, abs=4.0)
    assert abs(done.stored()) < 1e-8 * 2 * 60 * 7800e-12 * 650e6 * 1000


def press(dimension: int) -> ImplicitProcedure:
    """A hot bar, 10 x 6 mm, is upset by a quarter on a cooler, wider block, with friction and with a gap of 0.2 mm."""
    heat = {"conductance": [[0, "2 kW/(m^2*K)"], [100, "10 kW/(m^2*K)"]], "gap": 0.2}
    stroke = {"name": "press", "duration": 0.2}
    case: dict[str, Any] = {
        "title": "hot",
        "workpiece": {"material": "c45"},
        "bodies": {"block": {"material": "c45", "initial_temperature": 300}},
        "materials": {"c45": {"library": "c45"}},
        "contacts": {"face": {"between": ["workpiece", "block"], "contact": "coulomb", "mu": 0.1, "heat": heat}},
        "heat": {"initial_temperature": 1000, "surroundings": {"ambient": 20, "emissivity": 0.8}},
    }
    if dimension == 2:
        case["analysis"] = "plane_strain"
        case["workpiece"]["mesh"] = {"size": [10, 6], "cells": [8, 6]}
        case["bodies"]["block"]["mesh"] = {"origin": [0, -5], "size": [15, 5], "cells": [10, 4]}
        case["boundary"] = {
            "side": {"set": "left", "fix": ["x"]}, "other": {"set": "block.left", "fix": ["x"]},
            "floor": {"set": "block.bottom", "fix": ["y"]},
        }  # fmt: skip
        stroke["displacement"] = [{"set": "top", "component": "y", "value": -1.5}]
        return compute(Case.model_validate({**case, "stages": [stroke]}))
    case["analysis"] = "solid"
    case["workpiece"]["mesh"] = {"size": [10, 1, 6], "cells": [8, 1, 6]}
    case["bodies"]["block"]["mesh"] = {"origin": [0, 0, -5], "size": [15, 1, 5], "cells": [10, 1, 4]}
    case["boundary"] = {
        "side": {"set": "left", "fix": ["x"]}, "other": {"set": "block.left", "fix": ["x"]},
        "floor": {"set": "block.back", "fix": ["z"]},
        **{f"{body}{side}": {"set": f"{body}{side}", "fix": ["y"]}
           for body in ("", "block.") for side in ("bottom", "top")},
    }  # fmt: skip
    stroke["displacement"] = [{"set": "front", "component": "z", "value": -1.5}]
    return compute(SpaceCase.model_validate({**case, "stages": [stroke]}))


def test_a_slice_passes_heat_as_in_plane_strain() -> None:
    """Temperatures of both bodies within 1 % of the fall, and all heat by kind."""
    plane, space = press(2), press(3)
    here, there = space.state[HeatArrays], plane.state[HeatArrays]
    away = []
    for own, other in zip(space.model.bodies, plane.model.bodies, strict=True):
        points, flat = space.model.mesh.points[list(own.points)], plane.model.mesh.points[list(other.points)]
        match = [int(np.abs(flat - p[[0, 2]]).sum(axis=1).argmin()) for p in points]
        away.append(np.abs(here.temperature[list(own.points)] - there.temperature[list(other.points)][match]).max())
    assert there.temperature.min() > 290.0
    assert np.ptp(there.temperature) > 600.0
    assert max(away) < 0.01 * 700.0
    np.testing.assert_allclose(here.heat, there.heat, rtol=0.01, atol=1e-3 * np.abs(there.heat).max())
    for done in (plane, space):
        assert done.heat is not None
        arrays = done.state[HeatArrays]
        assert done.heat.forming.stored(arrays) == pytest.approx(arrays.heat.sum(), rel=1e-6)


def test_faces_share_the_area_that_they_face() -> None:
    """A square of one face over one of four, shifted by a quarter: three quarters of it, at the gap between."""
    own = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], dtype=float)
    grid = np.array([[x, y, -0.1] for y in (0, 2, 4) for x in (1, 3, 5)], dtype=float)
    points = np.concatenate([own, grid])
    under = np.array([[0, 3, 2, 1]], dtype=np.int32)  # outwards is down
    over = np.array([[i, i + 1, i + 4, i + 3] for i in (4, 5, 7, 8)], dtype=np.int32)
    found = find_facing(points, under, over, np.array([0.2]), None)
    assert found.area.sum() == pytest.approx(12.0, rel=1e-12)
    assert found.gap == pytest.approx(0.1)
    assert (found.area @ found.own_shape).sum() == pytest.approx(12.0)
    _, (area,) = sum_pairs(found, under, over, found.area)
    assert area.sum() == pytest.approx(12.0)
    assert len(find_facing(points, under, over, np.array([0.05]), None).area) == 0
    with pytest.raises(ValueError, match="reach must have shape"):
        _core.find_facing_faces(points, under, over, np.zeros(3))


def test_heat_of_a_contact_needs_heat() -> None:
    mesh = {"size": [1, 1, 1], "cells": [1, 1, 1]}
    case = {
        "title": "cold",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": mesh, "initial_temperature": 20},
        "bodies": {"lower": {"material": "steel", "mesh": {**mesh, "origin": [0, 0, -1]}}},
        "materials": {"steel": {key: STEEL[key] for key in ("young", "poisson", "magnitudes", "hardening")}},
        "contacts": {"face": {"between": ["workpiece", "lower"], "contact": "frictionless", "heat": PASSES}},
        "stages": [{"name": "press"}],
    }
    with pytest.raises(CaseError) as error:
        build_model(SpaceCase.model_validate(case))
    keys = {p.key for p in error.value.problems if "without [heat]" in p.expected}
    assert keys == {"contacts.face.heat", "workpiece.initial_temperature"}
