# SPDX-License-Identifier: Apache-2.0
"""Cases of shells: what they build, and what they refuse."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from presswork.case import CaseError, ShellCase, build_model, describe, read_case
from presswork.case.material.library import FOLDER
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.supports import NotHeldError
from presswork.model import Kinematic, Rate


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
    for fragment in (
        "0.8 mm thick, 7 Lobatto points",
        "turns by 90 degrees about y",
        "pressure on all: 0 to 0.2 MPa",
        "memory:",
    ):
        assert fragment in words


def test_the_nodes_of_all_edges_are_a_set() -> None:
    model = build_model(ShellCase.model_validate(case(boundary={"rim": {"set": "boundary", "hold": "clamped"}})))
    np.testing.assert_array_equal(model.mesh.node_sets["boundary"], np.unique(model.mesh.boundary_edges))


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


KINEMATIC: dict[str, Any] = {
    "rate": {"law": "cowper_symonds", "D": 40, "q": 5},
    "kinematic": {"law": "chaboche", "C": [2000, 500], "gamma": [20, 0]},
    "young_decrease": {"saturated": "160 GPa", "rate": 60},
}
YOSHIDA = {"law": "yoshida_uemori", "B": 300, "C": 200, "m": 12, "b": 40, "Rsat": 190, "h": 0.4}


def test_a_material_has_back_stresses_rate_and_falling_modulus() -> None:
    data = case()
    data["materials"]["steel"] |= KINEMATIC
    data["stages"][0]["duration"] = 1.0
    model = build_model(ShellCase.model_validate(data))
    steel = model.materials[0]
    assert steel.kinematic == Kinematic("chaboche", {"C": (2000, 500), "gamma": (20, 0)})
    assert steel.rate == Rate("cowper_symonds", {"D": 40, "q": 5})
    assert steel.young_decrease == (160e3, 60)
    words = describe(model)
    for fragment in ("C = 2000 MPa, gamma = 20", "cowper_symonds rate: D = 40, q = 5", "falling to 160000 MPa"):
        assert fragment in words
    data["materials"]["steel"]["hardening"].pop("modulus")
    data["materials"]["steel"]["kinematic"] = YOSHIDA
    assert "Yoshida-Uemori B = 300, C = 200" in describe(build_model(ShellCase.model_validate(data)))


def test_a_material_of_the_library_goes_by_its_name() -> None:
    data = case(materials={})
    data["workpiece"]["material"] = "numisheet93_mild_steel"
    by_name = build_model(ShellCase.model_validate(data)).materials[0]
    assert (by_name.name, by_name.young) == ("numisheet93_mild_steel", 206e3)
    assert by_name.yield_function is not None
    named = case(materials={"steel": {"library": "numisheet93_mild_steel"}})
    assert repr(build_model(ShellCase.model_validate(named)).materials[0]) == repr(replace(by_name, name="steel"))


def test_keys_beside_a_library_material_replace_its_own() -> None:
    table = {"library": "numisheet93_mild_steel", "young": "190 GPa", "kinematic": KINEMATIC["kinematic"]}
    model = build_model(ShellCase.model_validate(case(materials={"steel": table})))
    steel = model.materials[0]
    assert (steel.young, steel.hardening.law) == (190e3, "swift")
    assert steel.kinematic is not None


def test_a_users_material_file_lies_beside_the_case(tmp_path: Path) -> None:
    text = (FOLDER / "numisheet93_mild_steel.toml").read_text("utf-8").replace("206 GPa", "201 GPa")
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    path = tmp_path / "strip.toml"
    path.write_text(tomli_w.dumps(case(materials={"steel": {"library": "mine.toml"}})), encoding="utf-8")
    read = read_case(path)
    assert build_model(read).materials[0].young == 201e3
    assert str(tmp_path / "mine.toml") in read.text, "the case that is kept with the results runs from anywhere"


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
    ("workpiece.material", "stel", ["workpiece.material", "did you mean `steel`", "presswork materials"]),
    ("workpiece.material", "aa6016", ["workpiece.material", "did you mean `aa6016_t4`"]),
    ("materials", {"steel": {"library": "aa6016"}}, ["materials.steel.library", "did you mean `aa6016_t4`", ".toml"]),
    ("materials", {"steel": {"library": "no.toml"}}, ["materials.steel.library", "there is no", "relative to"]),
    ("materials", {"steel": {"library": "aa6016_t4", "yung": 3}}, ["materials.steel.yung", "did you mean `young`"]),
    ("materials", {"steel": {}}, ["materials.steel.young: missing key", "materials.steel.poisson: missing key"]),
    ("materials.steel.kinematic", {"law": "chaboche", "C": [1] * 11, "gamma": [0] * 11},
     ["materials.steel.kinematic.C", "at most 10"]),
    ("materials.steel.kinematic", {"law": "chaboche", "C": [1], "gamma": [0, 1]},
     ["materials.steel.kinematic.gamma", "as many as C"]),
    ("materials.steel.kinematic", YOSHIDA, ["materials.steel.hardening", "without a modulus"]),
    ("boundary.end.set", "lft", ["boundary.end.set", "left"]),
    ("boundary.end.hold", "clampd", ["boundary.end.hold", "clamped"]),
    ("boundary.end.fix", ["z"], ["boundary.end.hold", "either hold or fix"]),
    ("stages.0.force", [{"set": "right", "value": [0, 1]}], ["stages.0.force.0.value", "three values"]),
    ("stages.0.force", [{"set": "nowhere", "value": [0, 0, 1]}], ["stages.0.force.0.set", "no such node set"]),
    ("stages.0.edge_force", [{"set": "all", "value": [0, 0, 1]}], ["stages.0.edge_force.0.set", "no such edge set"]),
    ("stages.0.rotation", [{"set": "right", "axis": "w", "angle": 3}], ["stages.0.rotation.0.axis", "x"]),
    ("stages.0.force", [], ["stages.0", "changes nothing"]),
    ("workpiece.section", {"points": 5}, ["workpiece.section.thickness: missing key", "[mm]"]),
    ("workpiece", {k: v for k, v in case()["workpiece"].items() if k != "section"},
     ["workpiece.section: missing key", "thickness"]),
    ("workpiece", {k: v for k, v in case()["workpiece"].items() if k != "material"},
     ["workpiece.material: missing key", "[materials]"]),
    ("stages.0.displacement", [{"set": "right", "component": "rx", "value": 1}],
     ["stages.0.displacement.0.component = \"rx\"", "choices: x, y, z"]),
    ("stages.0.force", [{"set": "right", "value": [0, 0, 1, 0, 0, 2]}], ["stages.0.force.0.value", "three values"]),
    ("stages.0.force", [{"set": "right", "moment": [0, 0, "5 N*mm"]}],
     ["stages.0.force.0.moment = [0.0, 0.0, 5.0]", "about the normal of the sheet", "in its plane"]),
    ("stages.0.rotation", [{"set": "right", "axis": "z", "angle": 3}],
     ["stages.0.rotation.0.axis = \"z\"", "about the normal of the sheet"]),
    ("stages.0.pressure", [{"set": "left", "value": 1}],
     ["stages.0.pressure.0.set = \"left\"", "no cell has all its nodes", "all"]),
    ("boundary.end", {"set": "left", "fix": ["w"]}, ["boundary.end.fix.0 = \"w\"", "choices: rx, ry, rz, x, y, z"]),
    ("workpiece.mesh.roll_radius", 1e-30, ["workpiece.mesh.roll_radius = 1e-30", "more than once", "at least"]),
    ("workpiece.mesh.roll_radius", 0.31, ["workpiece.mesh.roll_radius = 0.31", "2 mm along y go round", "0.3183 mm"]),
    ("workpiece.mesh", {"size": [10, 1e-7], "cells": [4, 1]},
     ["workpiece.mesh: ", "cells have no area at a corner", "less long and thin"]),
    ("workpiece.mesh", {"size": [10, 2], "cells": [4, 2], "roll_radius": 0.3184},
     ["workpiece.mesh.roll_radius = 0.3184", "spans more than 120 degrees", "at least 0.4775 mm, or more cells"]),
    ("output", {"steps": 10**400}, ["output.steps", "1329 bits"]),
    ("tools", {"punch": {}}, ["tools", "cannot touch a shell yet"]),
])  # fmt: skip
def test_bad_input_is_named(tmp_path, path, value, fragments) -> None:
    """Through the case file, whose name is in the message too."""
    (tmp_path / "strip.toml").write_text(tomli_w.dumps(changed(path, value)), encoding="utf-8")
    with pytest.raises(CaseError) as error:
        build_model(read_case(tmp_path / "strip.toml"))
    for fragment in ["strip.toml", *fragments]:
        assert fragment in str(error.value)


def test_arc_length_refuses_a_law_with_a_rate() -> None:
    data = case(solver={"control": "arc_length"})
    data["materials"]["steel"] |= {"rate": KINEMATIC["rate"]}
    with pytest.raises(
        CaseError, match=r"solver.control = \"arc_length\": .*no time passes, which materials.steel.rate"
    ):
        build_model(ShellCase.model_validate(data))


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


def test_sheets_that_meet_at_an_edge_have_a_director_each(tmp_path: Path) -> None:
    """A T: flange and web meet along x = 1; a moment along the flange's normal then bends the web."""
    points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [1, 0, 1], [1, 1, 1]]
    model = with_mesh(tmp_path, points, [[0, 1, 4, 3], [1, 2, 5, 4], [1, 6, 7, 4]])
    procedure = ImplicitProcedure(model, threads=1)
    assert len(procedure.mechanics.directors.vectors) == 8 + 2
    for _ in procedure.advance():
        pass
    assert np.abs(procedure.state.nodes.displacement[6:, :3]).max() > 0.0


def test_a_spike_is_refused_by_its_place(tmp_path: Path) -> None:
    angle = np.arange(24) * np.pi / 12
    radius = np.where(np.arange(24) % 2, 1.4, 1.0)
    points = [[0, 0, 0], *np.column_stack([radius * np.cos(angle), radius * np.sin(angle), -5 * radius]).tolist()]
    with pytest.raises(CaseError, match=r"workpiece.mesh.path.*no director can be defined at 1 nodes.*cut the tip off"):
        with_mesh(tmp_path, points, [[0, 2 * i + 1, 2 * i + 2, (2 * i + 2) % 24 + 1] for i in range(12)])


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


def test_rows_of_history_are_for_the_explicit_procedure() -> None:
    with pytest.raises(CaseError, match=r"output.rows = 5: shells are implicit: a row an increment; remove it"):
        build_model(ShellCase.model_validate(case(output={"rows": 5})))
