# SPDX-License-Identifier: Apache-2.0
"""Data of LS-DYNA decks that were lost once: offsets, ties, forces after motions, thickness, rows of nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import CaseError
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.stamping import make_stamping
from presswork.deck.titles import is_holder, is_punch
from presswork.deck.units import SYSTEMS
from tests.problems.plate_decks import write_dyna


def import_it(folder: Path, *changes: tuple[str, str]):
    text = write_dyna()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path = folder / "plates.k"
    path.write_text(text)
    notes = Notes(path)
    deck = DynaDeck(path, notes).read()
    notes.check()
    found = make_stamping(deck, SYSTEMS["mm-t-s"], notes)
    notes.check()
    return found, [str(note) for note in notes.in_order()]


def heights(found) -> dict[str, float]:
    return {name: float(each.points[:, 2].mean()) for name, each in found.meshes.items()}


SECTION = "         1         2         1         5\n         1         1         1         1\n"


@pytest.mark.parametrize(("place", "middle"), [(1, -0.5), (0.5, -0.25)])
def test_the_place_of_nodes_in_a_section_moves_the_sheet(tmp_path, place, middle) -> None:
    found, _ = import_it(tmp_path, (SECTION, f"{SECTION[:-1]}{place:10}\n"))
    assert heights(found) == pytest.approx({"blank.vtk": 0.0, "punch.stl": 0.5 - middle, "die.stl": -0.5 - middle})


AUTOMATIC = ("*CONTACT_FORMING_ONE_WAY", "*CONTACT_AUTOMATIC_ONE_WAY")
THIRD = "         3         3\n       0.1\n"


@pytest.mark.parametrize(("row", "half"), [("", 0.5), ("       0.0       0.0       0.0       0.4", 0.2)])
def test_rigid_shells_touch_with_their_thickness_in_automatic_contacts(tmp_path, row, half) -> None:
    """The punch is at 0.5 and the die at -0.5: their faces lie half their thickness nearer to the sheet."""
    found, listed = import_it(tmp_path, AUTOMATIC, (THIRD, f"{THIRD}{row}"))
    assert heights(found) == pytest.approx({"blank.vtk": 0.0, "punch.stl": 0.5 - half, "die.stl": -0.5 + half})
    assert sum("its face lies half its shells' thickness" in line for line in listed) == 2


def test_a_triangle_has_the_mean_of_three_thicknesses(tmp_path) -> None:
    text = write_dyna()
    begin = text.index("*ELEMENT_SHELL\n") + len("*ELEMENT_SHELL\n")
    rows = text[begin : text.index("*PART", begin)].splitlines()
    triangle = rows[0][:40] + rows[0][32:40]
    new = [
        triangle,
        f"{1.2:16}{1.2:16}{1.2:16}{0.0:16}",
        *(f"{row}\n{1.2:16}{1.2:16}{1.2:16}{1.2:16}" for row in rows[1:]),
    ]
    change = ("*ELEMENT_SHELL\n" + "\n".join(rows), "*ELEMENT_SHELL_THICKNESS\n" + "\n".join(new))
    found, _ = import_it(tmp_path, change)
    assert found.formed is None
    assert found.case["blank"]["thickness"] == pytest.approx(1.2)


PUSH = "*LOAD_RIGID_BODY\n         2         3         3      -1.0\n*DEFINE_CURVE\n         3\n0.0,0.0\n0.01,0.0\n"
PUSH += "0.0101,500.0\n1.0,500.0\n*END"
MOTION = "         2         3         2         1      -1.0"


def test_a_tool_that_closes_by_a_motion_and_is_pushed_then_does_both(tmp_path) -> None:
    found, _ = import_it(tmp_path, (MOTION, f"{MOTION}                0.01"), ("*END", PUSH))
    assert [stage["tools"] for stage in found.case["stages"]] == [
        {"punch": {"stroke": pytest.approx(2.0)}},
        {"punch": {"force": 500.0}},
    ]


def test_a_tool_whose_motion_ends_before_the_run_is_listed_as_standing_still_then(tmp_path) -> None:
    found, listed = import_it(tmp_path, (MOTION, f"{MOTION}                0.01"))
    assert found.case["stages"][0]["tools"] == {"punch": {"stroke": pytest.approx(2.0)}}
    assert (
        sum("after 0.01, when its motion ends and the deck frees it, it stands still" in line for line in listed) == 1
    )
    _, whole = import_it(tmp_path)
    assert not any("frees it" in line for line in whole)


def test_a_motion_rules_while_it_lasts_and_forces_add_up(tmp_path) -> None:
    found, listed = import_it(tmp_path, ("*END", PUSH))
    assert [stage["tools"] for stage in found.case["stages"]] == [{"punch": {"stroke": pytest.approx(4.0)}}]
    assert any("LOAD_RIGID_BODY: punch: a motion moves it all the time" in line for line in listed)
    two = PUSH.replace("      -1.0\n", "      -1.0\n         2         3         3      -0.5\n")
    found, listed = import_it(tmp_path, (f"*BOUNDARY_PRESCRIBED_MOTION_RIGID\n{MOTION}\n", ""), ("*END", two))
    (stage,) = found.case["stages"]
    assert stage["tools"]["punch"]["force"] == pytest.approx(750.0)
    assert any("force, the sum of 2" in line for line in listed)


def test_what_the_rows_of_nodes_hold_is_a_symmetry_plane(tmp_path) -> None:
    """TC = 1 and RC = 5 hold x, and turns about y and z, of the sheet's nodes at its left end."""
    text = write_dyna().splitlines()
    first = text.index("*NODE") + 1
    rows = text[first : first + 9]
    held = [row + (f"{1:8d}{5:8d}" if float(row[8:24]) < -9.0 else "") for row in rows]
    found, _ = import_it(tmp_path, ("\n".join(rows), "\n".join(held)))
    assert found.case["blank"]["symmetry"] == ["x"]
    assert np.ptp(found.meshes["blank.vtk"].points[:, 0]) == pytest.approx(20.0)


def test_a_curve_that_ends_before_the_run_holds_its_last_value(tmp_path) -> None:
    found, listed = import_it(
        tmp_path, ("                0.02                 4.0", "                0.01                 4.0")
    )
    assert sum(stage["tools"].get("punch", {}).get("stroke", 0.0) for stage in found.case["stages"]) == 4.0
    assert any("its curve ends at 0.01, before 0.02: its last value holds on" in line for line in listed)


LEFT = {
    "friction that decays": (
        (THIRD, "         3         3\n       0.1      0.05       2.0\n"),
        "FD = 0.05 with DC = 2",
    ),
    "dynamic friction without decay": (
        (THIRD, "         3         3\n       0.1      0.05\n"),
        "FD = 0.05 is left out",
    ),
    "viscous friction": (
        (THIRD, f"         3         3\n       0.1{'80.0':>30}\n"),
        "VC = 80.0 is left",
    ),
    "a rate formulation": (
        ("200.      500.\n\n", "200.      500.\n                                         1.0\n"),
        "VP = 1.0",
    ),
    "gravity of a part": (
        (
            "*PART\nsheet\n         1         1         1",
            "*PART\nsheet\n         1         1         1         0         0         9",
        ),
        "GRAV = 9",
    ),
}


@pytest.mark.parametrize("name", LEFT)
def test_data_that_are_left_out_are_listed_with_their_values(tmp_path, name) -> None:
    change, text = LEFT[name]
    _, listed = import_it(tmp_path, change)
    assert any(text in line for line in listed)


def test_a_factor_of_friction_is_kept(tmp_path) -> None:
    row = f"{THIRD}{'0.5':>70}\n*C"
    found, _ = import_it(tmp_path, (f"{THIRD}\n*C", row))
    assert {name: tool["mu"] for name, tool in found.case["tools"].items()} == {"punch": 0.05, "die": 0.1}


REFUSED = {
    "two motions at a time": ((f"{MOTION}\n", f"{MOTION}\n{MOTION}\n"), "a second motion of part 2 at the same time"),
    "tied surfaces": (("*CONTACT_FORMING_ONE_WAY", "*CONTACT_TIED"), "surfaces that are tied to each other"),
    "a breaking tie": (("ONE_WAY_SURFACE_TO_SURFACE", "SURFACE_TO_SURFACE_TIEBREAK"), "tied to each other"),
    "heat": (("*CONTROL_TERM", "*CONTROL_THERMAL_SOLVER\n         1\n*CONTROL_TERM"), "heat, or contacts"),
    "friction by tables": ((THIRD, "         3         3\n      -2.0\n"), "friction by FS = -2"),
    "contact for a time": ((THIRD, f"         3         3\n       0.1{'0.01':>60}\n"), "for a part of the time"),
    "a part twice": (("*PART\ndie\n         3", "*PART\ndie\n         2"), "a second part 2"),
    "a material twice": (("*MAT_RIGID\n         2", "*MAT_RIGID\n         1"), "a second material 1"),
    "a section twice": (("*SECTION_SHELL\n         2", "*SECTION_SHELL\n         1"), "a second section 1"),
    "a curve of relaxation": (("*DEFINE_CURVE\n         1", "*DEFINE_CURVE\n         1         1"), "SIDR = 1"),
    "a contact of no part": (
        ("         1         3         3         3", "         1         7         3         3"),
        "no part 7",
    ),
    "a node twice": (("*MAT_024", "*NODE\n       1             9.0\n*MAT_024"), "a second node 1, at another place"),
    "a shell twice": (
        ("*MAT_024", "*ELEMENT_SHELL\n       1       1       1       2       3\n*MAT_024"),
        "a second shell 1",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_counterpart_is_refused(tmp_path, name) -> None:
    change, text = REFUSED[name]
    with pytest.raises(CaseError, match=text):
        import_it(tmp_path, change)


@pytest.mark.parametrize(
    ("title", "kind"),
    [
        ("punch", "punch"),
        ("Upper_Punch-2", "punch"),
        ("UPPERPUNCH", "punch"),
        ("drawPost", "punch"),
        ("postform die", ""),
        ("stamping die", ""),
        ("blankholder", "holder"),
        ("binder ring 1", "holder"),
        ("SpringPad", "holder"),
        ("spring", ""),
        ("padding", ""),
        ("threshold plate", ""),
        ("punch holder", "holder"),
    ],
)
def test_tools_are_named_by_words_and_not_by_letters_inside_words(title, kind) -> None:
    assert (is_punch(title), is_holder(title)) == (kind == "punch", kind == "holder")
