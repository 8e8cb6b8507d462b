# SPDX-License-Identifier: Apache-2.0
"""Cases of shells: what they build, and what they refuse."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, ShellCase, build_model, describe, read_case
from presswork.procedure.implicit import ImplicitProcedure
from presswork.procedure.supports import NotHeldError


def case(**changes: Any) -> dict[str, Any]:
    return {
        "title": "strip",
        "analysis": "shell",
        "workpiece": {
            "material": "steel", "element": "shell4_mitc", "section": {"thickness": "1 mm"},
            "mesh": {"size": [10, 2], "cells": [4, 1]},
        },
        "materials": {"steel": {"young": "200 GPa", "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 200,
                                                                                    "modulus": 1000}}},
        "boundary": {"end": {"set": "left", "hold": "clamped"}},
        "stages": [{"name": "bend", "force": [{"set": "right", "value": [0, 0, "1 N"], "moment": [0, "2 N*mm", 0]}]}],
        **changes,
    }  # fmt: skip


def test_model_holds_what_the_case_says() -> None:
    data = case(boundary={"a": {"set": "left", "hold": "symmetry_x"}, "b": {"set": "right", "fix": ["z", "ry"]}})
    data["workpiece"]["section"] = {"thickness": 0.8, "points": 7, "rule": "lobatto"}
    data["stages"][0] |= {
        "pressure": [{"set": "all", "value": 0.2}], "body_force": [{"value": [0, 0, "-77 kN/m^3"]}],
        "edge_force": [{"set": "top", "value": [1, 0, 0]}], "rotation": [{"set": "right", "axis": "y", "angle": 90}],
        "displacement": [{"set": "right", "component": "z", "value": 3}],
    }  # fmt: skip
    model = build_model(ShellCase.model_validate(data))
    section = model.mesh.blocks[0].section
    assert section is not None
    assert (section.thickness, section.points, section.rule) == (0.8, 7, "lobatto")
    assert model.supports[0].fix == (True, False, False, False, True, True)
    assert model.supports[1].fix == (False, False, True, False, True, False)
    stage = model.stages[0]
    assert stage.forces[0].force == (0, 0, 1, 0, 2, 0)
    assert stage.body_forces[0].force[2] == pytest.approx(-77e-6)
    assert [(p.component, pytest.approx(p.value)) for p in stage.prescribed] == [(2, 3.0), (4, np.pi / 2)]
    assert not model.solver.line_search, "shells iterate with full steps unless told otherwise"
    words = describe(model)
    for fragment in ("0.8 mm thick, 7 Lobatto points", "turns by 90 degrees about y", "pressure 0.2 MPa", "memory:"):
        assert fragment in words


def test_a_material_has_its_yield_function() -> None:
    data = case()
    data["materials"]["steel"]["yield_function"] = {"law": "hill1948", "r00": 1.79, "r45": 1.51, "r90": 2.27}
    model = build_model(ShellCase.model_validate(data))
    chosen = model.materials[0].yield_function
    assert chosen is not None
    assert chosen.law == "hill1948"
    assert chosen.parameters[1] + chosen.parameters[2] == pytest.approx(1.0), "G + H of Hill's function"
    assert "hill1948" in describe(model)
    assert build_model(ShellCase.model_validate(case())).materials[0].yield_function is None


def test_a_rolled_rectangle_lies_on_its_cylinder() -> None:
    data = case()
    data["workpiece"]["mesh"] = {"size": [10, 6], "cells": [4, 6], "roll_radius": 5}
    mesh = build_model(ShellCase.model_validate(data)).mesh
    np.testing.assert_allclose(np.hypot(mesh.points[:, 1], mesh.points[:, 2] + 5), 5.0)
    assert mesh.points[mesh.node_sets["bottom"], 2] == pytest.approx(0.0)


def changed(path: str, value: object) -> dict[str, Any]:
    data = case()
    *keys, last = path.split(".")
    here: Any = data
    for key in keys:
        here = here[int(key)] if key.isdigit() else here[key]
    here[last] = value
    return data


@pytest.mark.parametrize(("path", "value", "fragments"), [
    ("workpiece.section.thickness", 0, ["workpiece.section.thickness", "> 0"]),
    ("workpiece.section.thickness", -1.0, ["workpiece.section.thickness", "-1"]),
    ("workpiece.section.points", 1, ["workpiece.section.points", "2"]),
    ("workpiece.section", {"thickness": 1, "points": 4, "rule": "simpson"}, ["section.points", "odd", "take 5"]),
    ("workpiece.element", "quad4", ["workpiece.element", "shell4_mitc"]),
    ("workpiece.material", "stel", ["workpiece.material", "did you mean", "steel"]),
    ("boundary.end.set", "lft", ["boundary.end.set", "left"]),
    ("boundary.end.hold", "clampd", ["boundary.end.hold", "clamped"]),
    ("boundary.end.fix", ["z"], ["boundary.end.hold", "either hold or fix"]),
    ("stages.0.force", [{"set": "right", "value": [0, 1]}], ["stages.0.force.0.value", "three values"]),
    ("stages.0.force", [{"set": "nowhere", "value": [0, 0, 1]}], ["stages.0.force.0.set", "no such node set"]),
    ("stages.0.edge_force", [{"set": "all", "value": [0, 0, 1]}], ["stages.0.edge_force.0.set", "no such edge set"]),
    ("stages.0.rotation", [{"set": "right", "axis": "w", "angle": 3}], ["stages.0.rotation.0.axis", "x"]),
    ("stages.0.force", [], ["stages.0", "changes nothing"]),
    ("tools", {"punch": {}}, ["tools", "cannot touch a shell yet"]),
])  # fmt: skip
def test_bad_input_is_named(path, value, fragments) -> None:
    with pytest.raises(CaseError) as error:
        build_model(ShellCase.model_validate(changed(path, value)))
    for fragment in fragments:
        assert fragment in str(error.value)


@pytest.mark.parametrize(("held", "free"), [
    ({}, "6 rigid motions"),
    ({"end": {"set": "left", "hold": "hinged"}}, "1 rigid motion .*rotation about y"),
])  # fmt: skip
def test_a_shell_that_nothing_holds_is_refused(held, free) -> None:
    with pytest.raises(NotHeldError, match=free):
        ImplicitProcedure(build_model(ShellCase.model_validate(case(boundary=held))))


def write_mesh(path: Path, points: list[list[float]], cells: list[list[int]]) -> None:
    rows = "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(points))
    lines = "\n".join(f"{i + 1}, " + ", ".join(str(n + 1) for n in cell) for i, cell in enumerate(cells))
    path.write_text(f"*NODE, NSET=all_nodes\n{rows}\n*ELEMENT, TYPE=S4\n{lines}\n")


def with_mesh(tmp_path: Path, points: list[list[float]], cells: list[list[int]]):
    write_mesh(tmp_path / "sheet.inp", points, cells)
    data = case()
    data["workpiece"]["mesh"] = {"path": str(tmp_path / "sheet.inp")}
    return build_model(ShellCase.model_validate(data))


def test_a_mesh_file_gives_a_folded_sheet(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 1, 0], [1, 1, 0], [1, 1, 1]]
    model = with_mesh(tmp_path, points, [[0, 1, 4, 3], [1, 2, 5, 4]])
    assert model.mesh.points.shape == (6, 3)
    assert set(model.mesh.node_sets) >= {"left", "right", "all"}


@pytest.mark.parametrize(("points", "fault"), [
    ([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]], "no area at a corner"),
    ([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]], "folded or warped"),
    ([[0, 0, 0], [1, 0, 3], [1, 1, 0], [0, 1, 3]], "folded or warped"),
])  # fmt: skip
def test_useless_cells_of_a_mesh_file_are_refused(tmp_path: Path, points, fault) -> None:
    with pytest.raises(CaseError, match=fault):
        with_mesh(tmp_path, points, [[0, 1, 2, 3]])


def test_the_kind_of_case_follows_from_its_analysis(tmp_path: Path) -> None:
    path = tmp_path / "strip.toml"
    path.write_text('title = "x"\nanalysis = "shell"\n')
    with pytest.raises(CaseError) as error:
        read_case(path)
    assert "workpiece" in str(error.value)
    assert "strip.toml" in str(error.value)
