# SPDX-License-Identifier: Apache-2.0
"""No datum of a deck is lost without a word: changed, it changes the case or the list, or the deck is refused."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from presswork import CaseError
from presswork.deck.abaqus.read import AbaqusDeck
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.rad.read import RadDeck
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS
from tests.problems.plate_decks import DYNA_TAIL, RAD_HEAD, RAD_TAIL, write_abaqus, write_dyna, write_rad

_BULK = 2
"""Rows of nodes, shells and labels in a block that are tried: the others are alike."""


@dataclass(frozen=True)
class Program:
    """How a program's decks are read, and what its fields look like."""

    suffix: str
    reader: type[AbaqusDeck | DynaDeck | RadDeck]
    sign: str
    comments: tuple[str, ...]
    text: str


PROGRAMS = {
    "abaqus": Program(".inp", AbaqusDeck, "*", ("**",), write_abaqus()),
    "dyna": Program(".k", DynaDeck, "*", ("$",), write_dyna()),
    "rad": Program(".rad", RadDeck, "/", ("#", "$"), write_rad()),
}


def read(program: Program, folder: Path, lines: list[str]):
    """Return what an import makes of a deck: the case, its meshes, the list, and lines that are dropped as a whole."""
    path = folder / f"deck{program.suffix}"
    path.write_text("\n".join(lines) + "\n")
    notes = Notes(path)
    deck = program.reader(path, notes).read()
    notes.check()
    found = make_stamping(deck, SYSTEMS["mm-t-s"], notes)
    notes.check()
    listed = notes.in_order()
    meshes = {name: (each.points.tolist(), each.cells.tolist()) for name, each in found.meshes.items()}
    kept = {note.place.line for note in listed if note.fate != "dropped"}
    dropped = {note.place.line for note in listed if not note.is_datum} - kept
    return (found.case, meshes, [str(note) for note in listed]), dropped


BLANKS = ("7", "0.007")
"""What blank fields are tried with: a number, or a part of the time; a datum is lost if neither matters."""


def other(text: str) -> str:
    """Return another value of the same kind."""
    if re.fullmatch(r"[+-]?\d+", text):
        return str(int(text) + 1)
    try:
        return f"{float(text) * 1.25 + 0.125:g}"
    except ValueError:
        return f"{text}x"


Changes = Iterator[list[str]]
"""Rows with one datum changed, each in one or two ways."""


def change_commas(line: str) -> Changes:
    """Yield rows of Abaqus in which one field is another one, or one field more."""
    words = [word.strip() for word in line.rstrip(",").split(",")]
    for i, word in enumerate([*words, ""]):
        news = [other(word)] if word else BLANKS
        yield [", ".join([*words[:i], new, *words[i + 1 :]]) for new in news]


def change_fields(line: str, width: int, n: int) -> Changes:
    """Yield rows of fields of one width in which one of the first n is another one."""
    line = line.ljust(width * n)
    for begin in range(0, width * n, width):
        text = line[begin : begin + width].strip()
        news = [other(text)] if text else BLANKS
        yield [line[:begin] + new.rjust(width)[:width] + line[begin + width :] for new in news]


def change_words(line: str) -> Changes:
    """Yield rows in which one word is another one at the same end, or a number stands in a gap or at the end."""
    for word in re.finditer(r"\S+", line):
        news = BLANKS if word.group() == "0.0" else [other(word.group())]
        yield [line[: max(0, word.end() - len(new))] + new + line[word.end() :] for new in news]
    end = len(line.rstrip()) + 20
    for begin in range(0, min(100, end - end % 10), 10):
        if not line[begin : begin + 20].strip():
            yield [line.ljust(begin)[:begin] + new.rjust(10) + line[begin + 10 :] for new in BLANKS]


def list_changes(program: Program, only: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the place of a line from 0, and what it is changed to: data, and parameters of keywords.

    only: the begin of keywords that are tried. Titles and the labels of shells say nothing, and are left.
    """
    name = {".inp": "abaqus", ".k": "dyna", ".rad": "rad"}[program.suffix]
    keyword, data = "", 0
    for at, line in enumerate(program.text.splitlines()):
        if line.startswith(program.comments) or line.startswith("#"):
            continue
        if line.startswith(program.sign):
            keyword, data = line.upper(), 0
            if name == "abaqus" and keyword.startswith(only):
                words = line.split(",")
                for i, word in enumerate(words[1:], 1):
                    yield at, [",".join([*words[:i], f"{word}x", *words[i + 1 :]])]
                yield at, [f"{line}, further=1"]
            continue
        data += 1
        if not keyword.startswith(only):
            continue
        is_title = name == "rad" and data == 1 and not keyword.startswith(("/NODE", "/SHELL", "/RUN"))
        if is_title or (data > _BULK and keyword.startswith(("*NODE", "*ELEMENT", "/NODE", "/SHELL"))):
            continue
        if keyword.startswith(("*PART", "*TITLE", "*HEADING")) and not re.match(r"[\d., ]+$", line):
            continue  # titles
        if name == "abaqus":
            changed = change_commas(line)
        elif name == "rad" or keyword.startswith("*NODE"):
            changed = change_words(line)
        else:
            width = 8 if keyword.startswith("*ELEMENT") else 20 if "CURVE" in keyword and data > 1 else 10
            changed = change_fields(line, width, {8: 6, 20: 2, 10: 8}[width])
        skipped = 1 if keyword.startswith(("*ELEMENT", "/SHELL")) else 0
        yield from ((at, each) for each in itertools.islice(changed, skipped, None))


def find_lost(program: Program, folder: Path, only: str = "", every: int = 1) -> tuple[int, list[str]]:
    """Return how many data were changed, and the changes that made no difference; every: of so many one is tried."""
    lines = program.text.splitlines()
    base, dropped = read(program, folder, lines)
    lost, count = [], 0
    for at, news in itertools.islice(list_changes(program, only), 0, None, every):
        news = [new for new in news if new.strip() != lines[at].strip()]
        count += bool(news)
        keyword = max((i for i in range(at + 1) if lines[i].startswith(program.sign)), default=0)
        if news and keyword + 1 not in dropped and not any(matters(program, folder, lines, at, n, base) for n in news):
            lost.append(f"{lines[keyword]} | {lines[at]} -> {news[0]}")
    return count, lost


def matters(program: Program, folder: Path, lines: list[str], at: int, new: str, base: tuple) -> bool:
    """Say whether another line changes what an import makes of a deck, or is refused."""
    try:
        return read(program, folder, [*lines[:at], new, *lines[at + 1 :]])[0] != base
    except CaseError:
        return True


@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.validation)])
@pytest.mark.parametrize("name", PROGRAMS)
def test_no_datum_is_lost_without_a_word(tmp_path, name, every) -> None:
    count, lost = find_lost(PROGRAMS[name], tmp_path, every=every)
    assert count > 150 / every
    assert not lost, "\n".join(lost)


@pytest.mark.parametrize("name", PROGRAMS)
def test_no_row_more_is_lost_without_a_word(tmp_path, name) -> None:
    """A row of three numbers below each keyword is read, listed, or refused; the lines of those below it move."""
    program = PROGRAMS[name]
    lines = program.text.splitlines()
    starts = [i for i, line in enumerate(lines) if line.startswith(program.sign)]
    row = "7, 8, 9" if name == "abaqus" else f"{7:10}{8:10}{9:10}"

    def read_without_lines(changed: list[str]):
        case, meshes, listed = read(program, tmp_path, changed)[0]
        return case, meshes, [re.sub(r"(deck\.\w+:|line )\d+", "", each) for each in listed]

    base, dropped = read_without_lines(lines), read(program, tmp_path, lines)[1]
    lost = []
    for start, end in itertools.pairwise(starts):
        if start + 1 in dropped or lines[start].startswith("*KEYWORD"):
            continue
        try:
            if read_without_lines([*lines[:end], row, *lines[end:]]) == base:
                lost.append(lines[start])
        except CaseError:
            continue
    assert not lost


HEAD = "         1   7.85E-9  207000.       0.3"
ELASTIC = DYNA_TAIL[: DYNA_TAIL.index("*MAT_RIGID")]
RAD_ELASTIC = RAD_HEAD[RAD_HEAD.index("/MAT/") : RAD_HEAD.index("/PROP/")]
RAD_E = "            7.85E-09\n            207000.0                 0.3\n"
WIDE = "{:>20}" * 5 + "\n"
MOVED = DYNA_TAIL[DYNA_TAIL.index("         2         3         2         1") : DYNA_TAIL.index("*DEFINE_CURVE")]
PUSHED = "*LOAD_RIGID_BODY\n         2         3         1      -1.0\n*DEFINE_CURVE"
IMPOSED = RAD_TAIL[: RAD_TAIL.index("/BCS")]
VARIANTS = {
    "power law": ("dyna", "*MAT_018", ELASTIC, f"*MAT_018\n{HEAD}      500.      0.25\n\n"),
    "eight points": (
        "dyna",
        "*MAT_024",
        ELASTIC,
        f"*MAT_024\n{HEAD}\n      40.0       5.0\n       0.0       0.1\n     200.0     300.0\n",
    ),
    "Barlat's law": (
        "dyna",
        "*MAT_036",
        ELASTIC,
        f"*MAT_036\n{HEAD}         2     565.0      0.26\n"
        "         6      1.79      1.51      2.27         0     0.007\n"
        "       2.0\n       0.0       0.0       0.0       1.0       1.0\n\n",
    ),
    "one r-value": ("dyna", "*MAT_037", ELASTIC, f"*MAT_037\n{HEAD}     200.0     500.0       1.5\n\n"),
    "a force": ("dyna", "*LOAD", f"*BOUNDARY_PRESCRIBED_MOTION_RIGID\n{MOVED}*DEFINE_CURVE", PUSHED),
    "thick tools": ("dyna", "*CONTACT_AUTOMATIC", "CONTACT_FORMING", "CONTACT_AUTOMATIC"),
    "splits": (
        "dyna",
        "*CONTROL_ADAPTIVE",
        "*END",
        "*CONTROL_ADAPTIVE\n      0.01       5.0         2         3\n*END",
    ),
    "Johnson and Cook": (
        "rad",
        "/MAT",
        RAD_ELASTIC,
        f"/MAT/LAW2/1\nsteel\n{RAD_E}" + WIDE.format(250.0, 500.0, 0.4, "", "") + WIDE.format(0.02, 1.0, "", "", ""),
    ),
    "Hill's law": (
        "rad",
        "/MAT",
        RAD_ELASTIC,
        f"/MAT/HILL/1\nsteel\n{RAD_E}" + WIDE.format(565.0, 0.007, 0.26, "", "") + f"\n{1.8:20}{1.5:20}{2.2:20}\n",
    ),
    "a force of a main node": (
        "rad",
        "/CLOAD",
        IMPOSED,
        "/CLOAD/1\nforce\n         2         Z         0         0      2002" + f"{'':10}{1.0:20}{-9.0:20}\n",
    ),
    "rates": ("abaqus", "*RATE", "*Surface Inter", "*Rate Dependent, type=POWER LAW\n40., 5.\n*Surface Inter"),
    "ratios": ("abaqus", "*POTENTIAL", "*Surface Inter", "*Potential\n1., 1.04, 1.2, 1.02, 1., 1.\n*Surface Inter"),
    "a load of a reference node": (
        "abaqus",
        "*CLOAD",
        "*Boundary\npunch-1.Ref, 1, 2\npunch-1.Ref, 3, 3, -5.\n",
        "*Cload\npunch-1.Ref, 3, -5.\n*Boundary\n",
    ),
    "general contact": (
        "abaqus",
        "*CONTACT",
        "*Contact Pair, interaction=I\nSheet, Punch\nSheet, Die\n",
        "*Contact\n*Contact Inclusions\nSheet, Punch\nSheet, Die\n*Contact Property Assignment\nSheet, Die, I\n",
    ),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_no_datum_of_other_keywords_is_lost(tmp_path, name) -> None:
    """Each keyword stands in the deck in place of another one, and its own data alone are tried."""
    program, only, old, new = VARIANTS[name]
    text = PROGRAMS[program].text
    assert old in text
    count, lost = find_lost(replace(PROGRAMS[program], text=text.replace(old, new)), tmp_path, only)
    assert count > 2
    assert not lost, "\n".join(lost)
