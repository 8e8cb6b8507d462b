# SPDX-License-Identifier: Apache-2.0
"""Decks of OpenRadioss: groups, rigid bodies, units, laws of sheets and their versions, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import CaseError, build_model, read_case
from presswork.cli import app
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.rad.read import RadDeck
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS, name_units
from tests.problems import dyna_deck
from tests.problems.rad_deck import ENGINE, MATERIAL, PROPERTY, TAIL, write_deck


def import_it(folder: Path, text: str, *accepted: str, end: str = "0.0073"):
    path = folder / "cup_0000.rad"
    path.write_text(text)
    (folder / "cup_0001.rad").write_text(ENGINE.format(end=end))
    notes = Notes(path, frozenset(accepted))
    deck = RadDeck(path, notes).read()
    notes.check()
    assert deck.units is not None
    return make_stamping(deck, deck.units, notes), notes


def test_the_same_job_in_two_programs_decks_is_one_case(tmp_path) -> None:
    found, _ = import_it(tmp_path, write_deck())
    path = tmp_path / "cup.k"
    path.write_text(dyna_deck.write_deck())
    notes = Notes(path)
    other = make_stamping(DynaDeck(path, notes).read(), SYSTEMS["mm-t-s"], notes)
    for key in ("title", "blank", "tools"):
        assert found.case[key] == other.case[key]
    (stage,), (same,) = found.case["stages"], other.case["stages"]
    assert stage["tools"]["punch"]["stroke"] == pytest.approx(12.0, rel=1e-4)
    assert stage["tools"]["holder"] == same["tools"]["holder"]
    sheet = found.case["materials"]["sheet"]
    assert sheet["hardening"]["points"] == [[0.0, 200.0], [0.1, 300.0], [0.5, 400.0]]
    assert sheet["yield_function"] == other.case["materials"]["sheet"]["yield_function"]
    for name, surface in found.meshes.items():
        np.testing.assert_allclose(surface.points, other.meshes[name].points, atol=1e-6)
        np.testing.assert_array_equal(surface.cells, other.meshes[name].cells)


def test_units_are_those_of_the_deck() -> None:
    assert name_units("Mg", "mm", "s") is SYSTEMS["mm-t-s"]
    assert name_units("kg", "mm", "ms") is SYSTEMS["mm-kg-ms"]
    assert name_units("", "", "") is SYSTEMS["m-kg-s"]
    assert name_units("0.001", "0.001", "0.001") is SYSTEMS["mm-g-ms"]
    assert name_units("g", "cm", "mus") is SYSTEMS["cm-g-us"]
    assert name_units("kg", "dm", "s").length == 100.0
    with pytest.raises(ValueError, match="furlong"):
        name_units("kg", "furlong", "s")


ELASTIC = "            7.85E-09\n            207000.0                 0.3\n"
WIDE = "{:>20}" * 5 + "\n"
LAWS = {
    "Johnson and Cook": (
        "/MAT/LAW2/1\nsteel\n" + ELASTIC + WIDE.format(250.0, 500.0, 0.4, 0, 0) + WIDE.format(0.02, 1.0, "", "", ""),
        {
            "hardening": {"law": "ludwik", "yield_stress": 250.0, "K": 500.0, "n": 0.4},
            "rate": {"law": "johnson_cook", "C": 0.02, "reference_rate": 1.0},
        },
    ),
    "Hill along the rolling direction": (
        "/MAT/HILL/1\nsteel\n" + ELASTIC + WIDE.format(565.0, 0.00712, 0.26, 0, 0) + "\n"
        f"{1.79:20}{1.51:20}{2.27:20}{'':20}{1:10}\n",
        {
            "hardening": {"law": "swift", "K": 565.0, "e0": 0.00712, "n": 0.26},
            "yield_function": {"law": "hill1948", "r00": 1.79, "r45": 1.51, "r90": 2.27},
        },
    ),
    "a table, and a modulus that falls": (
        "/MAT/PLAS_TAB/1\nsteel\n"
        + ELASTIC
        + f"{1:10}{0:10}\n{0:10}{'':20}{0:10}{170e3:20}{30.0:20}\n{1:10}\n{2.0:20}\n",
        {
            "hardening": {"law": "table", "points": [[0.0, 400.0], [0.1, 600.0], [0.5, 800.0]]},
            "young_decrease": {"saturated": 170e3, "rate": 30.0},
        },
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_laws_of_sheets_have_the_words_of_a_case(tmp_path, name) -> None:
    text, expected = LAWS[name]
    sheet = import_it(tmp_path, write_deck(text))[0].case["materials"]["sheet"]
    assert {key: sheet[key] for key in expected} == expected


@pytest.mark.parametrize("version", [110, 130, 2022])
def test_a_mean_yield_stress_is_taken_to_the_rolling_direction(tmp_path, version) -> None:
    """Hill's function of r = 1.9, 1.4, 2.1 has A1 = H (1 + 1/r00) with H = r/(1 + r) of the mean r = 1.7."""
    text = MATERIAL.replace("BARLAT3", "LAW43")
    for old, new in (("1.79", " 1.9"), ("1.51", " 1.4"), ("2.27", " 2.1")):
        text = text.replace(old, new)
    lines = text.split("\n")
    lines[9] = lines[9][:80]
    if version < 120:
        del lines[6:8]
    found, notes = import_it(tmp_path, write_deck("\n".join(lines), version=version))
    points = np.array(found.case["materials"]["sheet"]["hardening"]["points"])
    np.testing.assert_allclose(points[:, 1], np.array([200.0, 300.0, 400.0]) / np.sqrt(1.7 / 2.7 * (1 + 1 / 1.9)))
    assert any("mean yield stress" in note.text for note in notes.notes)
    (line,) = (i for i, text in enumerate(lines) if "r00" in text)
    lines[line + 1] += f"{1:10}"
    first = import_it(tmp_path, write_deck("\n".join(lines), version=version))[0].case["materials"]["sheet"]
    assert (first["hardening"]["points"][0][1] == 200.0) == (version >= 140)


def test_layers_of_one_material_are_a_sheet_and_an_angle_turns_the_rolling_direction(tmp_path) -> None:
    layers = "".join(f"{30.0:20}{0.2:20}{0.0:20}{1:10}\n" for _ in range(5))
    text = PROPERTY.replace("SH_ORTH", "TYPE11").replace("        24", "        12").rstrip("\n") + "\n" + layers
    case = import_it(tmp_path, write_deck(sheet=text.replace("{thickness:>20}", f"{'':20}")))[0].case
    assert case["blank"]["thickness"] == pytest.approx(1.0)
    assert case["blank"]["rolling_direction"] == pytest.approx(30.0)
    assert case["explicit"] == {"element": "shell4_mitc_plus"}


def test_parts_of_one_rigid_body_are_one_tool_and_groups_may_name_groups(tmp_path) -> None:
    text = write_deck()
    text = text.replace("/GRNOD/PART/1003\nholder\n         3\n", "/GRNOD/GRNOD/1003\nboth\n      1102      1103\n")
    text = text.replace("/END", "/GRNOD/SURF/1102\npunch\n       102\n/GRNOD/PART/1103\nholder\n         3\n/END")
    text = text[: text.index("/RBODY/2")] + text[text.index("/SURF/PART/102") :]
    text = text.replace("2002\n                 1.0", "2003\n                 1.0")
    text = text[: text.index("/CLOAD")] + text[text.index("/BCS/1\n") :]
    found, notes = import_it(tmp_path, text)
    assert sorted(found.case["tools"]) == ["die", "punch"]
    assert any("parts 2, 3 move together: one tool" in note.text for note in notes.notes)
    assert found.case["stages"][0]["tools"]["punch"]["stroke"] == pytest.approx(12.0, rel=1e-4)


BAD = {
    "physics": (
        ("/TH/NODE/1\noutput\nDEF\n", "/GRAV/1\n"),
        r"cup_0000\.rad:\d+ /GRAV: carries physics.*--drop '/GRAV'",
    ),
    "a frame of its own": (
        ("2         Z         0         0      2002", "2         Z         7         0      2002"),
        r"/IMPVEL: a motion in a frame of its own",
    ),
    "a node that is free": (
        ("2         Z         0         0      2002", "2         Z         0         0         1"),
        "not a rigid body",
    ),
    "a group that is not there": (("0      2003     ", "0      2009     "), r"/CLOAD: there is no group 2009 of GRNOD"),
    "no number": (("              0.0012 ", "              0.00x2 "), r"/FUNCT: `0\.00x2` is not a number"),
    "cut short": (
        ("/BCS/1\nthe die\n   111 111         0      2004\n", "/BCS/1\nthe die\n"),
        "/BCS: the rows below it are cut",
    ),
    "no curve": (("/FUNCT/3", "/FUNCT/9"), r"/CLOAD: there is no curve 3 of two points"),
    "a curve without points": (
        (
            "                 0.0               200.0\n                 0.1               300.0\n"
            "                 0.5               400.0\n",
            "",
        ),
        "there is no curve 1 with points",
    ),
    "a part that is not there": (("/PART/2\npunch\n", "/PART/22\npunch\n"), "there is no part or body 2"),
    "units of its own": (
        ("/BCS/1\n", "/UNIT/5\nother\n                  kg                   m                   s\n/BCS/1/5\n"),
        "units of their own",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_said_in_a_case_is_named_with_its_line(tmp_path, name) -> None:
    (old, new), message = BAD[name]
    assert old in write_deck()
    with pytest.raises(CaseError, match=message):
        import_it(tmp_path, write_deck().replace(old, new))


HEADS = {
    "an old version": (
        lambda text: text.replace("      2022 ", "        44 "),
        "version 44, whose fields are 8 and 16 wide",
    ),
    "an engine's file": (lambda text: ENGINE.format(end="1.0"), "no /BEGIN in it; give the starter's file"),
    "another law": (lambda text: text.replace("/MAT/BARLAT3", "/MAT/LAW78"), "/MAT/LAW78: no such law of sheets here"),
    "no units": (
        lambda text: text.replace("Mg                  mm", "lb                  mm"),
        "units that are not known: lb mm s",
    ),
    "self-contact": (
        lambda text: text.replace("1001       104", "1001       101"),
        "/INTER/TYPE7: a sheet that touches itself",
    ),
}


@pytest.mark.parametrize("name", HEADS)
def test_other_decks_are_refused_with_a_remedy(tmp_path, name) -> None:
    change, message = HEADS[name]
    with pytest.raises(CaseError, match=message):
        import_it(tmp_path, change(write_deck()))


def test_a_bad_number_in_an_engine_file_names_file_line_and_remedy(tmp_path) -> None:
    with pytest.raises(CaseError, match=r"cup_0001\.rad:1.*/RUN.*`x` is not a number; check"):
        import_it(tmp_path, write_deck(), end="x")


def test_what_the_engine_changes_is_refused_and_it_tells_the_end(tmp_path) -> None:
    text = write_deck(tail=TAIL)
    found, _ = import_it(tmp_path, text, end="3.65E-3")
    assert sum(stage["duration"] for stage in found.case["stages"]) == pytest.approx(3.65e-3)
    path = tmp_path / "cup_0000.rad"
    (tmp_path / "cup_0001.rad").write_text("/RUN/cup/1\n0.0073\n/RBODY/ON\n         2\n")
    notes = Notes(path)
    RadDeck(path, notes).read()
    with pytest.raises(CaseError, match=r"cup_0001\.rad:3 /RBODY/ON: changes the model while it runs"):
        notes.check()
    (tmp_path / "cup_0001.rad").unlink()
    deck = RadDeck(path, notes := Notes(path)).read()
    with pytest.raises(CaseError, match=r"the deck has no end time; add \*CONTROL_TERMINATION or /RUN"):
        make_stamping(deck, SYSTEMS["mm-t-s"], notes)


def test_files_are_included_where_they_stand(tmp_path) -> None:
    text = write_deck()
    begin, end = text.index("/FUNCT/1"), text.index("/FUNCT/2")
    (tmp_path / "curve.inc").write_text(text[begin:end])
    found, _ = import_it(tmp_path, text[:begin] + "#include curve.inc\n" + text[end:])
    assert len(found.case["materials"]["sheet"]["hardening"]["points"]) == 3
    with pytest.raises(CaseError, match="rows that go on after an included file"):
        import_it(tmp_path, text[:begin] + "#include curve.inc\n        1.0\n" + text[end:])


def test_the_command_leaves_a_case_and_what_became_of_every_line(tmp_path) -> None:
    deck = tmp_path / "cup_0000.rad"
    deck.write_text(write_deck().replace("/TH/NODE/1", "/GRAV/1\nweight\n/TH/NODE/1"))
    (tmp_path / "cup_0001.rad").write_text(ENGINE.format(end="0.0073"))
    assert CliRunner().invoke(app, ["import", str(deck)]).exit_code == 2
    done = CliRunner().invoke(app, ["import", str(deck), "--drop", "/GRAV"])
    assert done.exit_code == 0, done.output
    listed = (tmp_path / "cup" / "import.txt").read_text()
    assert "dropped /GRAV: carries physics that has no counterpart here; left out as asked for" in listed
    assert "dropped /ANIM/DT" in listed
    assert "units mm-t-s" in listed
    assert len(build_model(read_case(tmp_path / "cup" / "case.toml")).tools) == 3
