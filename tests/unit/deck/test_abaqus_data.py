# SPDX-License-Identifier: Apache-2.0
"""Data of Abaqus decks that were lost once: systems, offsets, friction, tables, freedoms, several tools and steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import CaseError
from presswork.deck.abaqus.read import AbaqusDeck
from presswork.deck.notes import Notes
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS
from tests.problems.plate_decks import write_abaqus


def import_it(folder: Path, *changes: tuple[str, str], tools: str = "R3D4", drop: tuple[str, ...] = ()):
    text = write_abaqus(tools=tools)
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path = folder / "plates.inp"
    path.write_text(text)
    notes = Notes(path, frozenset(drop))
    deck = AbaqusDeck(path, notes).read()
    notes.check()
    found = make_stamping(deck, SYSTEMS["mm-t-s"], notes)
    notes.check()
    return found, [str(note) for note in notes.in_order()]


def heights(found) -> dict[str, float]:
    return {name: float(each.points[:, 2].mean()) for name, each in found.meshes.items()}


@pytest.mark.parametrize("tools", ["R3D4", "S4R"])
def test_rigid_shells_with_sections_are_a_tool_each(tmp_path, tools) -> None:
    found, _ = import_it(tmp_path, tools=tools)
    assert heights(found) == pytest.approx({"blank.vtk": 0.0, "epunch.stl": 0.5, "edie.stl": -0.5})
    assert {name: tool["kind"] for name, tool in found.case["tools"].items()} == {"epunch": "punch", "edie": "die"}
    assert [stage["tools"] for stage in found.case["stages"]] == [{"epunch": {"stroke": 5.0}}]


SYSTEMS_OF_NODES = {
    "moved": ("*System\n0., 0., 50., 1., 0., 50., 0., 1., 50.\n*Node\n", (-4.0, -4.0, 50.5)),
    "moved, on two lines": ("*System\n0., 0., 50., 1., 0., 50.\n0., 1., 50.\n*Node\n", (-4.0, -4.0, 50.5)),
    "turned about z": ("*System\n0., 0., 50., 0., 1., 50.\n*Node\n", (4.0, -4.0, 50.5)),
    "back to the global one": ("*System\n0., 0., 50.\n*System\n*Node\n", (-4.0, -4.0, 0.5)),
    "cylindrical": ("*Node, system=C\n", (-4 * np.cos(np.radians(4)), 4 * np.sin(np.radians(4)), 0.5)),
}


@pytest.mark.parametrize("name", SYSTEMS_OF_NODES)
def test_nodes_lie_in_the_system_that_the_deck_names(tmp_path, name) -> None:
    text, corner = SYSTEMS_OF_NODES[name]
    found, _ = import_it(tmp_path, ("*Part, name=punch\n*Node\n", f"*Part, name=punch\n{text}"))
    np.testing.assert_allclose(found.meshes["epunch.stl"].points[0], corner, atol=1e-9)


@pytest.mark.parametrize(("word", "middle"), [("SPOS", -0.5), ("-0.2", 0.2), ("0.25", -0.25), ("MIDDLE", 0.0)])
def test_an_offset_of_the_sheet_moves_its_middle(tmp_path, word, middle) -> None:
    """The case has the middle at z = 0, so that the tools are moved the other way."""
    found, _ = import_it(tmp_path, ("elset=All, material=m", f"elset=All, material=m, offset={word}"))
    assert heights(found) == pytest.approx({"blank.vtk": 0.0, "epunch.stl": 0.5 - middle, "edie.stl": -0.5 - middle})


def test_a_table_that_ends_is_flat_beyond_its_last_row(tmp_path) -> None:
    found, _ = import_it(tmp_path)
    rows = found.case["materials"]["sheet"]["hardening"]["points"]
    assert rows[:2] == [[0.0, 200.0], [0.1, 300.0]]
    assert rows[2][1] == 300.0


FRICTION = {
    "*Friction, rough\n": "surfaces that never slip",
    "*Friction, user\n0.1,\n": "friction by a subroutine",
    "*Friction, anisotropic\n0.1, 0.2\n": "friction that depends on direction",
    "*Friction\n1.2,\n": "a coefficient of 1.2",
    "*Friction, dependencies=1\n0.1,\n": "depends on fields",
}


@pytest.mark.parametrize("new", FRICTION)
def test_friction_that_no_coefficient_is_is_refused(tmp_path, new) -> None:
    with pytest.raises(CaseError, match=rf"plates\.inp:\d+ \*FRICTION: .*{FRICTION[new]}.*; give a constant"):
        import_it(tmp_path, ("*Friction\n0.1,\n", new))


LEFT = {
    "*Friction, exponential decay\n0.15, 0.05, 2.\n": (0.15, "kinetic value and decay left out: 0.05, 2."),
    "*Friction, taumax=80.\n0.12,\n": (0.12, "TAUMAX = 80. is left out"),
    "*Friction\n0.12, , 10.\n0.11, , 20.\n": (0.12, "depends on slip or pressure: , 10.; 0.11, , 20."),
    "*Friction, elastic slip=0.01\n0.12,\n": (0.12, "ELASTIC SLIP = 0.01 is left out"),
}


@pytest.mark.parametrize("new", LEFT)
def test_friction_that_changes_is_listed_with_its_data(tmp_path, new) -> None:
    mu, text = LEFT[new]
    found, listed = import_it(tmp_path, ("*Friction\n0.1,\n", new))
    assert {tool["mu"] for tool in found.case["tools"].values()} == {mu}
    assert any(text in line for line in listed)


GENERAL = """*Surface Interaction, name=Dry
*Friction
0.3,
*Contact
*Contact Inclusions, ALL EXTERIOR
*Contact Property Assignment
 , , I
Sheet, Die, Dry
*Boundary
die-1"""
PAIRS = "*Contact Pair, interaction=I\nSheet, Punch\nSheet, Die\n"


def test_general_contact_has_the_property_of_each_pair(tmp_path) -> None:
    found, _ = import_it(tmp_path, (PAIRS, ""), ("*Boundary\ndie-1", GENERAL))
    assert {name: tool["mu"] for name, tool in found.case["tools"].items()} == {"epunch": 0.1, "edie": 0.3}
    included = GENERAL.replace(", ALL EXTERIOR", "\nSheet, Punch")
    found, _ = import_it(tmp_path, (PAIRS, ""), ("*Boundary\ndie-1", included))
    assert found.case["tools"].keys() == {"epunch"}


STEP = "*Boundary\npunch-1.Ref, 1, 2\npunch-1.Ref, 3, 3, -5.\npunch-1.Ref, 4, 6\n"
PUSHED = "*Cload\npunch-1.Ref, 3, -100.\n"


def test_a_force_rises_over_a_static_step_and_follows_a_motion_that_ends(tmp_path) -> None:
    found, _ = import_it(tmp_path, (STEP, PUSHED), ("*Step, name=press", "*Step, amplitude=STEP"))
    assert [stage["tools"] for stage in found.case["stages"]] == [{"epunch": {"force": 100.0}}]
    second = f"{STEP}*End Step\n*Step\n*Static\n0.1, 2.\n*Boundary, op=NEW\ndie-1.Ref, 1, 6\n{PUSHED}"
    found, _ = import_it(tmp_path, (STEP, second))
    assert [stage["tools"] for stage in found.case["stages"]] == [
        {"epunch": {"stroke": 5.0}},
        {"epunch": {"force": 100.0}},
    ]


REFUSED = {
    "a temperature of nodes": (("die-1.Ref, ENCASTRE", "die-1.Ref, ENCASTRE\nsheet-1.All, 11, 11"), "freedom 11"),
    "a force along a freedom above 6": ((STEP, "*Cload\npunch-1.Ref, 8, 1.\n"), "freedom 8 is no displacement"),
    "a force that pulls": ((STEP, "*Cload\npunch-1.Ref, 3, 1.\n"), "pulls the holder epunch off the sheet"),
    "several motions of a tool": ((STEP, STEP + STEP.replace("-5.", "-4.")), "several displacements along freedom 3"),
    "a force that turns": ((STEP, PUSHED.replace("*Cload", "*Cload, follower")), "FOLLOWER"),
    "tied surfaces": (("*Contact Pair, interaction=I", "*Contact Pair, interaction=I, tied"), "tied to each other"),
    "contact that holds": (("*Contact Pair", "*Surface Behavior, no separation\n*Contact Pair"), "NO SEPARATION"),
    "an unknown interaction": (("interaction=I", "interaction=J"), "there is no interaction J"),
    "several temperatures": (("200000., 0.3", "200000., 0.3, 20.\n180000., 0.3, 400."), "of several temperatures"),
    "thickness by nodes": (("elset=All, material=m", "elset=All, material=m, nodal thickness"), "NODAL THICKNESS"),
    "two materials of one name": (("*Material, name=m", "*Material, name=m\n*Material, name=M"), "a second material M"),
    "two parts of one name": (("*Part, name=die", "*Part, name=punch"), "a second part PUNCH"),
    "a rotation cut short": (("part=punch\n", "part=punch\n0., 0., 1.\n0., 0., 0.\n"), "a rotation has two points"),
    "a perturbation": (("nlgeom=YES", "perturbation"), "a linear perturbation"),
    "supports that end": (
        (STEP, STEP.replace("*Boundary", "*Boundary, op=NEW")),
        "OP=NEW releases SHEET-1.3, which is no tool",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_counterpart_is_refused_with_its_line(tmp_path, name) -> None:
    change, text = REFUSED[name]
    more = (("die-1.Ref, ENCASTRE", "die-1.Ref, ENCASTRE\nsheet-1.3, 1, 1"),) if name == "supports that end" else ()
    if "temperature of nodes" in name:
        more = (("*Element, type=S4R, elset=All", "*Nset, nset=All\n1, 2\n*Element, type=S4R, elset=All"),)
    with pytest.raises(CaseError, match=rf"plates\.inp:\d+.*{text}"):
        import_it(tmp_path, change, *more)


def test_data_of_a_keyword_that_are_not_read_are_listed(tmp_path) -> None:
    _, listed = import_it(
        tmp_path,
        ("elset=All, material=m", "elset=All, material=m, controls=EC-1"),
        ("200., 0.\n300., 0.1\n", "200., 0., 20.\n300., 0.1, 20.\n"),
        ("0.01, 1.\n", "0.01, 1., 1e-5\n"),
    )
    for text in (
        "SHELL SECTION: CONTROLS = EC-1 is left out",
        "further columns: 20. is left out",
        "0.01, 1e-5 is left",
    ):
        assert any(text in line and "dropped" in line for line in listed), text


def test_two_instances_of_a_rigid_part_are_two_tools(tmp_path) -> None:
    """The punch's part, rigid in itself, lies above the sheet and, 1 mm lower, below it, too."""
    rigid = "*Rigid Body, ref node=Ref, elset=All\n*End Part\n*Part, name=die"
    found, _ = import_it(
        tmp_path,
        ("*End Part\n*Part, name=die", rigid),
        ("*Instance, name=die-1, part=die\n", "*Instance, name=die-1, part=punch\n0., 0., -1.\n"),
        ("*Rigid Body, ref node=die-1.Ref, elset=Edie\n", ""),
        ("*Rigid Body, ref node=punch-1.Ref, elset=Epunch\n", ""),
    )
    assert heights(found) == pytest.approx({"blank.vtk": 0.0, "punch_1.stl": 0.5, "die_1.stl": -0.5})
    assert [stage["tools"] for stage in found.case["stages"]] == [{"punch_1": {"stroke": 5.0}}]
