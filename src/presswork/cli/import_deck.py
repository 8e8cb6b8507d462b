# SPDX-License-Identifier: Apache-2.0
"""The command `import`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from presswork.case.errors import CaseError, Problem, suggest
from presswork.cli.terminal import exit_on
from presswork.deck.abaqus.read import AbaqusDeck
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.rad.read import RadDeck
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS, find_units
from presswork.deck.write import write_case
from presswork.results import OutputError

app = typer.Typer(add_completion=False)
_READERS: dict[str, type[DynaDeck | AbaqusDeck | RadDeck]] = {
    **dict.fromkeys((".k", ".key", ".dyn", ".dyna"), DynaDeck),
    ".inp": AbaqusDeck,
    ".rad": RadDeck,
}


@app.command("import")
def import_deck(
    deck: Annotated[
        Path,
        typer.Argument(
            help="A deck of LS-DYNA (.k, .key, .dyn), Abaqus (.inp) or OpenRadioss (_0000.rad) of a stamping."
        ),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder of the case; without it: named as the deck.")
    ] = None,
    units: Annotated[
        str,
        typer.Option(
            help=f"Units of the deck: {', '.join(SYSTEMS)}; without it: named in it, or by density and stiffness."
        ),
    ] = "",
    drop: Annotated[list[str] | None, typer.Option(help="A keyword that carries physics, to leave out anyway.")] = None,
) -> None:
    """Make a case of another program's deck, and report line by line what was kept, changed and dropped."""
    with exit_on(CaseError, OSError, OutputError):
        _import(deck, output or deck.with_name(deck.stem.removesuffix("_0000")), units, drop or [])


@contextmanager
def _explain_misfits(deck: Path) -> Iterator[None]:
    """Raise CaseError for data of a deck that fit together nowhere, and that no reader has named."""
    try:
        yield
    except (ArithmeticError, AssertionError, LookupError, ValueError) as error:
        fault = f"data that do not fit together ({type(error).__name__}: {error})"
        raise CaseError(
            [Problem("", fault, "check the deck in its own program; if it runs there, report it")], deck
        ) from error


def _import(deck: Path, folder: Path, units: str, drop: list[str]) -> None:
    """Read a deck, write the case, and print what became of the lines. Raises CaseError."""
    sign = "/" if deck.suffix.lower() == ".rad" else "*"
    notes = Notes(deck, frozenset(f"{sign}{each.lstrip('*/').upper()}" for each in drop))
    if deck.suffix.lower() not in _READERS:
        problem = Problem(
            "", f"no deck that is read: {deck.suffix or 'no ending'}", f"give one of {', '.join(_READERS)}"
        )
        raise CaseError([problem], deck)
    if (folder / "case.toml").exists():
        raise CaseError([Problem("--output", "a case is there already", "give another folder", str(folder))], deck)
    with _explain_misfits(deck):
        read = _READERS[deck.suffix.lower()](deck, notes).read()
    notes.check()
    if units and units not in SYSTEMS:
        raise CaseError([Problem("--units", "unknown units", suggest(units, SYSTEMS, "units"), units)], deck)
    sheets = [material for material in read.materials.values() if not material.is_rigid]
    found = SYSTEMS[units] if units else read.units or find_units(sheets)
    if found is None:
        fault = "density and stiffness of the sheet fit a metal in no system of units, or in several"
        fault = fault if sheets else "no material of a sheet shows the units"
        raise CaseError([Problem("--units", fault, f"give one of {', '.join(SYSTEMS)}")], deck)
    with _explain_misfits(deck):
        imported = make_stamping(read, found, notes)
    notes.check()
    case = write_case(imported, notes, folder)
    for note in sorted(notes.notes, key=lambda note: note.place):
        if note.fate != "dropped" or note.is_datum:
            typer.echo(str(note))
    counts = Counter(note.fate for note in notes.in_order())
    typer.echo(
        f"units: {found.name}; {', '.join(f'{n} {fate}' for fate, n in counts.items())} ({folder / 'import.txt'})"
    )
    typer.echo(f"{case}\npresswork check {case}")
