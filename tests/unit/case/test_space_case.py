# SPDX-License-Identifier: Apache-2.0
"""Cases of solids in space: what is built, and what is refused before anything is computed."""

import copy

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case import describe
from presswork.case.space.mesh import Box, Cylinder, Ring
from presswork.case.space.schema import SpaceCase
from presswork.mesh.faces import face_areas
from tests.problems.sectors import upsetting

CASE = {
    "title": "a block",
    "analysis": "solid",
    "workpiece": {"material": "steel", "mesh": {"size": [4, 2, 3], "cells": [2, 1, 3]}},
    "materials": {
        "steel": {
            "young": 200e3,
            "poisson": 0.3,
            "hardening": {"law": "linear", "yield_stress": 300, "modulus": 1000},
        }
    },
    "boundary": {"wall": {"set": "left", "fix": ["x", "y", "z"]}},
    "stages": [{"name": "load", "pressure": [{"set": "right", "value": 10}]}],
}


def change(**changes) -> dict:
    """Return the case with values replaced, their keys joined by two underscores."""
    case = copy.deepcopy(CASE)
    for key, value in changes.items():
        *path, last = key.split("__")
        table = case
        for name in path:
            table = table.setdefault(name, {})
        table[last] = value
    return case


def problems(case: dict) -> list[str]:
    with pytest.raises(CaseError) as error:
        build_model(SpaceCase(**case))
    return [f"{p.key}: {p.expected}" for p in error.value.problems]


def test_a_box_has_its_cells_sides_and_faces() -> None:
    model = build_model(SpaceCase(**CASE))
    mesh = model.mesh
    assert mesh.blocks[0].element == "hex8_fbar"
    assert mesh.blocks[0].connectivity.shape == (6, 8)
    assert mesh.points.shape == (24, 3)
    counts = {name: len(faces) for name, faces in mesh.face_sets.items()}
    assert counts == {"left": 3, "right": 3, "bottom": 6, "top": 6, "back": 2, "front": 2, "boundary": 22}
    areas = {name: face_areas(mesh.points, faces).sum() for name, faces in mesh.face_sets.items()}
    assert areas["right"] == pytest.approx(6.0)
    assert areas["front"] == pytest.approx(8.0)
    x = mesh.points[mesh.face_sets["right"]]
    assert (np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 1])[:, 0] > 0).all()


def test_a_total_force_is_spread_by_area() -> None:
    stage = {"name": "load", "face_force": [{"set": "right", "total": [60, 0, -30]}]}
    model = build_model(SpaceCase(**change(stages=[stage])))
    assert model.stages[0].face_forces[0].force == pytest.approx((10.0, 0.0, -5.0))


def test_the_model_is_described() -> None:
    text = describe(build_model(SpaceCase(**CASE)))
    assert "6 hex8_fbar (8-node hexahedra, F-bar) of steel" in text
    assert "freedoms: 72" in text
    assert "pressure on the faces of right: 0 to 10 MPa" in text


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"workpiece__material": "stele"}, "workpiece.material: no such material"),
        ({"boundary__wall__set": "lft"}, "boundary.wall.set: no such node set"),
        (
            {"stages": [{"name": "a", "pressure": [{"set": "all", "value": 1}]}]},
            "stages.0.pressure.0.set: no such",
        ),
        ({"stages": [{"name": "a"}]}, 'stages.0: the stage "a" changes nothing'),
        ({"solver": {"strain_measure": "small"}}, "solver.strain_measure: the small strain changes with a rotation"),
        ({"solver": {"control": "arc_length"}}, "solver.control: arc length is for shells"),
        ({"output": {"rows": 3}}, "output.rows: is for the explicit procedure"),
        ({"workpiece__mesh__cells": [9000, 9000, 900]}, "workpiece.mesh.cells: about"),
        ({"solver": {"inertia": 1.0}}, "materials.steel.density: missing key"),
        (
            {"materials__steel__yield_function": {"law": "barlat1989", "r00": 1, "r45": 1, "r90": 1, "exponent": 6}},
            "materials.steel.yield_function.law: barlat1989 is a yield function of plane stress alone",
        ),
    ],
)
def test_bad_input_is_named(changes, expected) -> None:
    assert any(problem.startswith(expected) for problem in problems(change(**changes)))


def test_a_tool_without_a_shape_is_refused() -> None:
    with pytest.raises(CaseError, match=r"tools\.punch\.shape: missing key"):
        SpaceCase(**change(tools={"punch": {}}))


def test_a_box_without_extent_is_refused() -> None:
    with pytest.raises(CaseError, match="expected three values > 0"):
        SpaceCase(**change(workpiece__mesh__size=[4, 0, 3]))


def sector(**changes) -> dict:
    """Return a sector of a cylinder between its two planes."""
    case = copy.deepcopy(CASE)
    case["workpiece"]["mesh"] = {"kind": "cylinder", "radius": 5, "height": 5, "angle": 30, "cells": [4, 4, 2]}
    case["boundary"] = {
        "first": {"set": "first_plane", "fix": ["y"]},
        "last": {"set": "last_plane", "fix": ["normal"]},
        "end": {"set": "back", "fix": ["z"]},
    }
    case["tools"] = {"die": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 5], "contact": "frictionless"}}
    case["stages"] = [{"name": "press", "tools": {"die": {"stroke": 1, "direction": [0, 0, -1]}}}]
    return {**case, **changes}


def test_the_planes_of_a_sector_are_held_along_their_normals_and_its_tools_are_whole() -> None:
    model = build_model(SpaceCase(**sector()))
    normal = np.array(model.supports[1].normal)
    assert np.abs(normal @ [np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0]) < 1e-12
    assert model.tools[0].sectors == pytest.approx(12.0)
    assert not any(model.tools[0].mirrored_across)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            {"boundary": {"rim": {"set": "rim", "fix": ["normal"]}}},
            "boundary.rim.fix: the nodes of `rim` lie in no plane",
        ),
        ({"procedure": "explicit"}, "materials.steel.density: missing key"),
    ],
)
def test_bad_sectors_are_named(changes, expected) -> None:
    assert any(problem.startswith(expected) for problem in problems(sector(**changes)))


def test_the_press_of_a_sector_forges_all_sectors() -> None:
    _, case = upsetting(30.0, (2, 2, 2), {"contact": "frictionless"})
    case["presses"] = {"hammer": {"kind": "hammer", "energy": 2, "mass": "400 kg", "efficiency": 1}}
    case["stages"][0]["press"] = "hammer"
    drive = build_model(SpaceCase(**case)).stages[0].drive
    assert drive is not None
    assert drive.whole == pytest.approx(2 * 12)


@pytest.mark.parametrize(
    ("kind", "sizes"),
    [
        (Cylinder, {"kind": "cylinder", "radius": 1e-30, "height": 5.0, "cells": [2, 8, 2]}),
        (Ring, {"kind": "ring", "inner_radius": 5.0, "outer_radius": 6.0, "height": 1e-30, "cells": [2, 8, 2]}),
        (Box, {"size": [1e-30, 8.0, 3.0], "cells": [2, 2, 2]}),
    ],
)
def test_a_body_without_thickness_is_refused(kind: type, sizes: dict) -> None:
    with pytest.raises(ValueError, match="1e-30 mm thin beside"):
        kind.model_validate(sizes)


def test_a_plane_that_faces_away_from_the_workpiece_is_named_with_the_normal_that_fits() -> None:
    """The block is 3 mm high: a plane on it looks down, as its metal lies below; the remedy is accepted."""
    case = change(tools__top={"shape": "plane", "normal": [0, 0, 1], "position": [0, 0, 3], "contact": "frictionless"})
    with pytest.raises(CaseError, match=r"tools\.top\.normal = .*; write normal = \[0, 0, -1\]"):
        build_model(SpaceCase.model_validate(case))
    case["tools"]["top"]["normal"] = [0, 0, -1]
    assert build_model(SpaceCase.model_validate(case)).tools[0].name == "top"
    case["tools"]["top"]["position"] = [0, 0, 2]
    with pytest.raises(CaseError, match=r"move the tool by \(0, 0, 1\) mm"):
        build_model(SpaceCase.model_validate(case))
