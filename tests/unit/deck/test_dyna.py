# SPDX-License-Identifier: Apache-2.0
"""Decks of LS-DYNA as people and programs write them: widths, commas, parameters, includes, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import CaseError, build_model, read_case
from presswork.cli import app
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.stages import find_breaks, find_displacement
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS, find_units
from tests.problems.dyna_deck import TAIL, write_deck


def read(folder: Path, text: str, *accepted: str):
    path = folder / "deck.k"
    path.write_text(text)
    notes = Notes(path, frozenset(accepted))
    return DynaDeck(path, notes).read(), notes


def import_it(folder: Path, text: str, *accepted: str):
    deck, notes = read(folder, text, *accepted)
    notes.check()
    return make_stamping(deck, SYSTEMS["mm-t-s"], notes)


ROWS = {
    "fixed width": f"{3:8d}{1.0:16.4E}{-2.5:16.1f}{0.0:16.1f}",
    "commas": "3, 1.0, -2.5, 0.0",
    "trailing fields": f"{3:8d}{1.0:16.4E}{-2.5:16.1f}{0.0:16.1f}{0:8d}{0:8d}      \r",
    "exponents without a letter, blanks": f"{3:8d}{'1.0+0':>16}{'-2.5D0':>16}",
    "a parameter": f"{3:8d}{'&one':>16}{-2.5:16.1f}{0.0:16.1f}",
}


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_nodes_are_read_in_every_way_of_writing_them(tmp_path, row) -> None:
    parameter = "*PARAMETER\n" + "R     one       1.0"
    text = f"*KEYWORD\n{parameter}\n*NODE\n$ a comment\n{row}\n$\n*END\n"
    deck, _ = read(tmp_path, text)
    assert deck.labels.tolist() == [3]
    np.testing.assert_allclose(deck.points, [[1.0, -2.5, 0.0]])


@pytest.mark.parametrize(
    ("head", "name", "width"), [("", "NODE+", 20), (" LONG=Y", "NODE", 20), (" I10=Y", "NODE", 10)]
)
def test_labels_of_large_models_have_wider_fields(tmp_path, head, name, width) -> None:
    wide = 20 if width == 20 else 16
    text = f"*KEYWORD{head}\n*{name}\n{123456789:{width}d}" + "".join(f"{x:{wide}.8E}" for x in (1.0, 2.0, 3.0)) + "\n"
    deck, _ = read(tmp_path, text)
    assert deck.labels.tolist() == [123456789]
    np.testing.assert_allclose(deck.points, [[1.0, 2.0, 3.0]])


def test_files_are_included_where_they_stand_and_end_ends_a_deck(tmp_path) -> None:
    (tmp_path / "mesh.k").write_text("*NODE\n       1             1.0             2.0             3.0\n*END\n")
    deck, _ = read(tmp_path, "*KEYWORD\n*INCLUDE\nmesh.k\n*TITLE\nafter it\n*END\n*NODE\n rubbish\n")
    assert deck.labels.tolist() == [1]
    assert deck.title == "after it"
    with pytest.raises(CaseError, match=r"none\.k: no such file; check the path"):
        read(tmp_path, "*KEYWORD\n*INCLUDE\nnone.k\n")
    (tmp_path / "round.k").write_text("*INCLUDE\nround.k\n")
    with pytest.raises(CaseError, match="include each other"):
        read(tmp_path, "*KEYWORD\n*INCLUDE\nround.k\n")
    with pytest.raises(CaseError, match="a binary file; give the deck of LS-DYNA as text"):
        read(tmp_path, "*KEYWORD\n*NODE\n\0\1\2\n")


def test_the_case_says_what_the_deck_says(tmp_path) -> None:
    found = import_it(tmp_path, write_deck())
    case = found.case
    assert case["blank"]["thickness"] == 1.0
    assert case["blank"]["points"] == 5
    assert case["blank"]["symmetry"] == ["x", "y"]
    assert {name: tool["kind"] for name, tool in case["tools"].items()} == {
        "punch": "punch",
        "holder": "holder",
        "die": "die",
    }
    assert {tool["mu"] for tool in case["tools"].values()} == {0.1}
    sheet = case["materials"]["sheet"]
    assert sheet["hardening"] == {"law": "swift", "K": 565.0, "e0": 0.00712, "n": 0.26}
    assert sheet["yield_function"] == {"law": "barlat1989", "r00": 1.79, "r45": 1.51, "r90": 2.27, "exponent": 6}
    (stage,) = case["stages"]
    assert stage["tools"]["punch"]["stroke"] == pytest.approx(12.0, rel=1e-4)
    assert stage["tools"]["holder"]["force"] == pytest.approx(20e3)
    assert stage["duration"] == pytest.approx(7.3e-3)


QUARTERS = {
    "along x": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    "upside down": np.diag([1.0, -1.0, -1.0]),
    "along -y": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]),
    "another quarter of the part": np.diag([-1.0, -1.0, 1.0]),
}


@pytest.mark.parametrize("turn", QUARTERS.values(), ids=QUARTERS)
def test_a_press_that_works_in_any_direction_is_turned(tmp_path, turn) -> None:
    upright, turned = import_it(tmp_path, write_deck()), import_it(tmp_path, write_deck(turn))
    assert turned.case == upright.case
    for name, surface in upright.meshes.items():
        np.testing.assert_allclose(turned.meshes[name].points, surface.points, atol=1e-6)


@pytest.mark.parametrize("name", ["mm-kg-ms", "mm-g-ms", "m-kg-s", "cm-g-us", "in-lbf-s"])
def test_units_are_found_by_the_sheet(tmp_path, name) -> None:
    deck, _ = read(tmp_path, write_deck())
    (sheet,) = (m for m in deck.materials.values() if not m.is_rigid)
    units = SYSTEMS[name]
    own = type(sheet)(sheet.keyword, sheet.density / units.density, sheet.young / units.stress, 0.3, sheet.place)
    assert find_units([own]) is units
    assert SYSTEMS["m-kg-s"].force == pytest.approx(1.0)
    assert SYSTEMS["mm-kg-ms"].stress == pytest.approx(1e3)
    assert SYSTEMS["in-lbf-s"].stress == pytest.approx(6.894757e-3, rel=1e-6)  # psi
    assert find_units([type(sheet)("", 1.0, 1.0, 0.3, sheet.place)]) is None


def test_strokes_are_what_velocities_come_to() -> None:
    times = np.linspace(0.0, 2.0, 2001)
    curve = np.array([[0.0, 0.0], [1.0, 10.0], [2.0, 0.0]])
    assert find_displacement("velocity", curve, 2.0, 0.0, 9.0, times)[-1] == pytest.approx(20.0)
    assert find_displacement("displacement", curve, 1.0, 0.0, 1.0, times)[-1] == pytest.approx(10.0)
    constant = np.array([[0.0, 3.0], [2.0, 3.0]])
    assert find_displacement("acceleration", constant, 1.0, 0.0, 9.0, times)[-1] == pytest.approx(6.0, rel=1e-5)
    to_and_fro = find_displacement("displacement", curve, 1.0, 0.0, 9.0, times)
    later = find_displacement(
        "displacement", np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 4.0], [2.0, 4.0]]), 1.0, 0.0, 9.0, times
    )
    np.testing.assert_allclose(find_breaks(times, [to_and_fro, later]), [0.0, 0.5, 1.0, 2.0], atol=2e-3)


LAWS = {
    "*MAT_PIECEWISE_LINEAR_PLASTICITY\n{0}     250.0    2000.0\n      40.0       5.0\n": (
        {"law": "linear", "yield_stress": 250.0, "modulus": pytest.approx(207e3 * 2000 / 205e3)},
        None,
    ),
    "*MAT_024\n{0}     250.0\n       0.0       0.0         9\n": (
        {"law": "table", "points": [[0.0, 200.0], [0.1, 300.0], [1.0, 300.0]]},
        None,
    ),
    "*MAT_TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC\n{0}     201.3       0.0    -1.593         9\n": (
        {"law": "table", "points": [[0.0, 200.0], [0.1, 300.0], [1.0, 300.0]]},
        {"law": "hill1948", "r00": 1.593, "r45": 1.593, "r90": 1.593},
    ),
    "*MAT_037\n{0}     201.3    2000.0       1.5\n": (  # ETAN: "plastic hardening modulus"
        {"law": "linear", "yield_stress": 201.3, "modulus": 2000.0},
        {"law": "hill1948", "r00": 1.5, "r45": 1.5, "r90": 1.5},
    ),
    "*MAT_BARLAT_YLD2000\n{0}\n     570.0     0.005      0.25       0.0       0.0       1.0       8.0\n"
    "      0.94      1.08      0.97      1.00      1.01      1.04      0.95      1.11\n"
    "       2.0\n\n       0.0       0.0       0.0\n": None,
}


@pytest.mark.parametrize("text", LAWS, ids=lambda text: text.split("\n")[0])
def test_laws_of_sheets_have_the_words_of_a_case(tmp_path, text) -> None:
    head = "         17.85000E-9  207000.0       0.3"
    points = "".join(f"{strain:20}{stress:20}\n" for strain, stress in ((0.0, 200.0), (0.1, 300.0), (1.0, 290.0)))
    material = text.format(head) + f"*DEFINE_CURVE\n{9:10}\n{points}"
    expected = LAWS[text]
    if expected is None:
        with pytest.raises(CaseError, match="axes of the material by AOPT = 2; take AOPT = 0, or 2 with A1, A2, A3"):
            import_it(tmp_path, write_deck(material=material))
        return
    sheet = import_it(tmp_path, write_deck(material=material)).case["materials"]["sheet"]
    assert sheet["hardening"] == expected[0]
    assert sheet.get("yield_function") == expected[1]
    if "PIECEWISE" in text:
        assert sheet["rate"] == {"law": "cowper_symonds", "D": 40.0, "q": 5.0}


BAD = {
    "physics without a counterpart": (
        ("*END", "*LOAD_BODY_Z\n         3\n*END"),
        r"deck\.k:\d+ \*LOAD_BODY_Z: carries physics that has no counterpart here; .* --drop '\*LOAD_BODY_Z'",
    ),
    "a tool that turns": (
        ("         2         3         0         3", "         2         7         0         3"),
        r"\*BOUNDARY_PRESCRIBED_MOTION_RIGID: part 2 is driven along a turn about z, the press works along z",
    ),
    "no time to end": (("*CONTROL_TERMINATION\n    7.3E-3\n", ""), r"the deck has no end time; add \*CONTROL_TERM"),
    "no curve": (("*DEFINE_CURVE\n         4\n", "*DEFINE_CURVE\n         5\n"), "there is no curve 4 of two points"),
    "cut short": (("*CONTROL_TERMINATION\n    7.3E-3\n", "*CONTROL_TERMINATION\n"), "the rows below it are cut short"),
    "no number": (("    7.3E-3\n", "    7.x\n"), r"\*CONTROL_TERMINATION: `7\.x` is not a number"),
    "tools that are placed by the program": (
        ("*END", "*CONTROL_FORMING_AUTOPOSITION_PARAMETER\n         2         0         3        -1\n*END"),
        r"\*CONTROL_FORMING_AUTOPOSITION_PARAMETER: places or drives tools",
    ),
    "a motion along the axes of the body": (
        ("*BOUNDARY_PRESCRIBED_MOTION_RIGID\n", "*BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL\n"),
        r"\*BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL: a motion along the axes of the body",
    ),
    "a force in its own frame": (
        ("         3         3         4      -1.0", "         3         3         4      -1.0         7"),
        r"\*LOAD_RIGID_BODY: a force in a frame of its own \(CID = 7\)",
    ),
    "layers with angles": (
        (
            "         1         2     0.833         5         1",
            "         1         2     0.833         5         1         0         1",
        ),
        r"\*SECTION_SHELL: layers with angles of their own",
    ),
    "a set by coordinates": (
        ("*SET_NODE_LIST\n", "*SET_NODE_GENERAL\n"),
        r"\*SET_NODE_GENERAL: a set by GENERAL; list its members by \*SET_NODE_LIST",
    ),
    "a number without end": (("    7.3E-3\n", "     1e400\n"), "`1e400` is not a finite number"),
    "a node nowhere": (
        ("*NODE\n       1", "*NODE\n       7             nan\n       1"),
        "`nan` is not a finite number",
    ),
    "an end before the beginning": (("    7.3E-3\n", "   -7.3E-3\n"), "the deck has no end time"),
    "a part that is not there": (
        ("*PART\npunch\n         2         2         2\n", ""),
        "shells of part 2, which the deck does not have",
    ),
    "a parameter that is not there": (("    7.3E-3\n", "      &end\n"), "the parameter &end is not defined"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_said_in_a_case_is_named_with_its_line(tmp_path, name) -> None:
    (old, new), message = BAD[name]
    text = write_deck()
    assert old in text
    with pytest.raises(CaseError, match=message):
        import_it(tmp_path, text.replace(old, new))


def test_sets_of_sets_and_contacts_of_ranks_are_read(tmp_path) -> None:
    text = write_deck()
    contact = "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE_ID\n         4blank with a tool\n"
    assert contact in text
    more = contact.replace("_ID", "_MPP_ID") + "         0       200\n&        0\n"
    by_sets = (more + "         1         7         3         2", contact + "         1         4         3         3")
    sets = "*SET_PART_LIST\n         5\n         4\n*SET_PART_ADD\n         7\n         5\n*END"
    changed = text.replace(by_sets[1], by_sets[0]).replace("*END", sets)
    assert changed != text
    assert import_it(tmp_path, changed).case == import_it(tmp_path, text).case


def test_two_sheets_or_a_bent_one_are_refused(tmp_path) -> None:
    text = write_deck()
    rigid = text[text.index("*MAT_RIGID") :].split("\n", 1)[1][:10]
    assert int(rigid) == 2
    soft = text.replace("*MAT_RIGID\n         2", "*MAT_024\n         2", 1)
    with pytest.raises(CaseError, match=r"expected one part of shells that deforms, the blank; found: 1 \(blank\), 2"):
        import_it(tmp_path, soft)
    lines = text.split("\n")
    first = lines.index("*NODE") + 1
    lines[first] = lines[first][:40] + f"{3.0:16.8E}"
    with pytest.raises(CaseError, match="the blank is not flat"):
        import_it(tmp_path, "\n".join(lines))


def test_the_command_leaves_a_case_its_meshes_and_what_became_of_every_line(tmp_path) -> None:
    deck = tmp_path / "cup.k"
    deck.write_text(write_deck(tail=TAIL.replace("*END", "*LOAD_BODY_Z\n         3\n*END")))
    refused = CliRunner().invoke(app, ["import", str(deck)])
    assert refused.exit_code == 2
    assert not (tmp_path / "cup").exists()
    done = CliRunner().invoke(app, ["import", str(deck), "--drop", "LOAD_BODY_Z"])
    assert done.exit_code == 0, done.output
    listed = (tmp_path / "cup" / "import.txt").read_text()
    assert "dropped *LOAD_BODY_Z: carries physics that has no counterpart here; left out as asked for" in listed
    assert "dropped *DATABASE_BINARY_D3PLOT" in listed
    assert "kept    *LOAD_RIGID_BODY: holder: force, of the whole part (4 times the deck's)" in listed
    model = build_model(read_case(tmp_path / "cup" / "case.toml"))
    assert len(model.tools) == 3
    again = CliRunner().invoke(app, ["import", str(deck), "--drop", "LOAD_BODY_Z"])
    assert again.exit_code == 2
    other = CliRunner().invoke(app, ["import", str(tmp_path / "cup" / "case.toml")])
    assert other.exit_code == 2
