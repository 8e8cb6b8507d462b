# SPDX-License-Identifier: Apache-2.0
"""import.txt has every line of a keyword of a deck, with what became of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from presswork.cli import app
from tests.problems import abaqus_deck, dyna_deck, rad_deck

_LISTED = re.compile(r"^(\S+):(\d+)  (kept|changed|dropped) +([*/#][^:]*): (.+)$")
Fates = dict[tuple[str, int], dict[str, str]]
"""By file and line: the text of each fate."""


def list_fates(deck: Path) -> tuple[Fates, dict[tuple[str, int], str]]:
    """Import a deck; return what import.txt says, and the keywords that it has by file and line."""
    folder = deck.parent / "case"
    run = CliRunner().invoke(app, ["import", str(deck), "--output", str(folder)])
    assert run.exit_code == 0, run.output
    fates: Fates = {}
    keywords: dict[tuple[str, int], str] = {}
    for row in (folder / "import.txt").read_text().splitlines()[2:]:
        file, line, fate, keyword, text = _LISTED.match(row).groups()  # type: ignore[union-attr]
        fates.setdefault((file, int(line)), {})[fate] = text
        keywords[file, int(line)] = keyword
    return fates, keywords


def check_all(deck: Path, files: list[Path], pattern: str) -> Fates:
    """Compare the list with all lines that look like keywords, found by a pattern of its own; return the fates."""
    fates, keywords = list_fates(deck)
    found = {
        (file.name, number): match.group(1).strip().upper()
        for file in files
        for number, row in enumerate(file.read_text().splitlines(), 1)
        if (match := re.match(pattern, row))
    }
    assert len(found) > 20
    assert sorted(fates) == sorted(found)
    for place, keyword in keywords.items():
        assert found[place].startswith(keyword.upper()), (place, keyword, found[place])
    return fates


def fate_of(fates: Fates, file: Path, row: str) -> dict[str, str]:
    """Return what became of the first line that begins so."""
    lines = file.read_text().splitlines()
    return fates[file.name, next(i for i, text in enumerate(lines, 1) if text.upper().startswith(row.upper()))]


def test_every_keyword_of_a_dyna_deck_is_listed(tmp_path) -> None:
    (tmp_path / "curves.k").write_text("*DEFINE_CURVE\n        77\n                 0.0                 1.0\n*END\n")
    spare = "*MAT_RIGID\n        99   7.8E-9   207E+3      0.30\n\n\n*SECTION_SHELL\n        98         2\n      1.00\n"
    more = f"*INCLUDE\ncurves.k\n*PARAMETER\nR     one       1.0\n*CONTROL_TIMESTEP\n\n*COMMENT\nnothing\n{spare}"
    deck = tmp_path / "cup.k"
    text = dyna_deck.write_deck().replace("*CONTROL_TERMINATION", f"{more}*CONTROL_TERMINATION")
    deck.write_text(text + "*TITLE\nnever read\n")
    fates = check_all(deck, [deck, tmp_path / "curves.k"], r"(\*[A-Za-z0-9_-]+)")
    assert "the last stage ends at 0.0073" in fate_of(fates, deck, "*CONTROL_TERMINATION")["kept"]
    assert re.search(r"\d+ nodes", " ".join(fate_of(fates, deck, "*NODE").values()))
    assert "rigid" in fate_of(fates, deck, "*MAT_RIGID")["kept"]
    assert "BOUNDARY_PRESCRIBED_MOTION_RIGID" in fate_of(fates, deck, "*DEFINE_CURVE_TITLE")["kept"]
    assert "nothing that is imported" in fate_of(fates, tmp_path / "curves.k", "*DEFINE_CURVE")["dropped"]
    assert "rigid tools" in fates[deck.name, text[: text.index("        98 ")].count("\n")]["dropped"]
    last = len(text.splitlines()) + 1
    assert fates[deck.name, last] == {"dropped": "comes after *END"}


def test_every_keyword_of_an_abaqus_deck_is_listed(tmp_path) -> None:
    deck = tmp_path / "cup.inp"
    spare = "*Material, name=Spare\n*Density\n7.85e-9,\n*Elastic\n207e3, 0.3\n*Amplitude, name=Unused\n0., 0., 1., 1.\n"
    deck.write_text(abaqus_deck.write_deck().replace("*Surface Interaction", f"{spare}*Surface Interaction", 1))
    fates = check_all(deck, [deck], r"(\*[A-Za-z][A-Za-z ]*)")
    assert "the sheet's material" in fate_of(fates, deck, "*Material, name=Steel")["kept"]
    assert fate_of(fates, deck, "*Density").keys() == {"kept"}
    assert fate_of(fates, deck, "*Material, name=Spare").keys() == {"dropped"}
    at = deck.read_text().splitlines().index("*Material, name=Spare") + 2
    assert fates[deck.name, at].keys() == {"dropped"}
    assert fate_of(fates, deck, "*Amplitude, name=Unused").keys() == {"dropped"}
    assert fate_of(fates, deck, "*Amplitude, name=Speed").keys() == {"changed"}  # as the motion that it drives
    assert "dropped" not in fate_of(fates, deck, "*Amplitude, name=Force")


def test_every_keyword_of_a_radioss_deck_and_its_engine_is_listed(tmp_path) -> None:
    deck, engine = tmp_path / "cup_0000.rad", tmp_path / "cup_0001.rad"
    spare = "/FUNCT/9\nspare\n                 0.0                 1.0\n                 1.0                 1.0\n"
    deck.write_text(rad_deck.write_deck().replace("/END", f"{spare}/END") + "/TITLE\nnever read\n")
    engine.write_text(rad_deck.ENGINE.format(end="0.0073"))
    fates = check_all(deck, [deck, engine], r"(/[A-Za-z0-9_/-]+|#include)")
    assert "the run ends at 0.0073" in fate_of(fates, engine, "/RUN")["kept"]
    assert "makes its parts rigid" in fate_of(fates, deck, "/RBODY")["kept"]
    assert "IMPVEL" in " ".join(fate_of(fates, deck, "/FUNCT/2").values()) + " ".join(
        fate_of(fates, deck, "/FUNCT/1").values()
    )
    assert fate_of(fates, deck, "/FUNCT/9").keys() == {"dropped"}
    assert fates[deck.name, len(deck.read_text().splitlines()) - 1] == {"dropped": "comes after the end"}


@pytest.mark.parametrize("count", [3])
def test_a_list_has_each_line_once_for_each_thing_that_became_of_it(tmp_path, count) -> None:
    """Three tools have contacts, motions or forces of their own lines: none is told twice in the same words."""
    deck = tmp_path / "cup.k"
    deck.write_text(dyna_deck.write_deck())
    list_fates(deck)
    rows = (tmp_path / "case" / "import.txt").read_text().splitlines()[2:]
    assert len(rows) == len(set(rows))
    assert sum("is the tool" in row for row in rows) == count
    checked = CliRunner().invoke(app, ["check", str(tmp_path / "case" / "case.toml")])
    assert checked.exit_code == 0
    assert "open rim" not in checked.output + str(checked.stderr)  # of tools that the import has written itself
