# SPDX-License-Identifier: Apache-2.0
"""Measured ring tests from a CSV file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.table_file import read_table_lines
from presswork.model import FloatArray

REDUCTION = {"height_reduction": 1.0, "height_reduction_percent": 0.01}
"""Column: the factor that makes it a fraction of the first height."""
BORE = ("bore_ratio", "bore_diameter_mm")


@dataclass(frozen=True)
class MeasuredRings:
    """One point for each ring pressed, or each stop of one; shape (n,)."""

    height_reduction: FloatArray
    """Fraction of the first height."""
    bore_ratio: FloatArray
    """Bore over its first diameter."""


def read_measured(path: Path | str, initial_bore: float) -> MeasuredRings:
    """Read a CSV with a head line, `#` lines apart; other columns than the two needed are ignored.

    The height reduction is `height_reduction` (a fraction) or `height_reduction_percent`; the bore is `bore_ratio` or
    `bore_diameter_mm`, which is divided by initial_bore [mm]. Raises CaseError with every fault, by line.
    """
    path = Path(path)
    lines = read_table_lines(path, least=1)
    head = [name.strip() for name in lines[0][1]]
    problems: list[Problem] = []
    reduction, bore = (_find_column(head, names, problems) for names in (tuple(REDUCTION), BORE))
    if problems:
        raise CaseError(problems, path)
    values = []
    for number, cells in lines[1:]:
        pair = []
        for name in (reduction, bore):
            text = cells[head.index(name)].strip() if head.index(name) < len(cells) else ""
            fault = _find_fault(name, text)
            if fault:
                problems.append(Problem(f"line {number}, {name}", *fault, value=text))
            else:
                pair.append(float(text))
        values.append(pair)
    if problems:
        raise CaseError(problems, path)
    if not values:
        raise CaseError([Problem("", "no measured point", "give one line for each")], path)
    table = np.array(values)
    return MeasuredRings(
        table[:, 0] * REDUCTION[reduction], table[:, 1] / (initial_bore if bore == "bore_diameter_mm" else 1.0)
    )


def _find_column(head: list[str], names: tuple[str, ...], problems: list[Problem]) -> str:
    """Return the one of the names that the head has; note a problem if it is not one."""
    there = [name for name in names if name in head]
    if len(there) == 1:
        return there[0]
    if there:
        problems.append(Problem(" and ".join(there), "the same quantity twice", "leave one column out"))
    else:
        problems.append(Problem("", f"no column {' or '.join(names)}", suggest(names[0], head, "columns")))
    return ""


def _find_fault(name: str, text: str) -> tuple[str, str] | None:
    """Return what is wrong with a value and the remedy; None if nothing is."""
    try:
        value = float(text)
    except ValueError:
        return "expected a number", "decimals with a point"
    largest = {"height_reduction": 1.0, "height_reduction_percent": 100.0, "bore_ratio": 5.0}.get(name, np.inf)
    if 0.0 < value < largest:
        return None
    hints = {
        "height_reduction": "per cent go into a column height_reduction_percent",
        "bore_ratio": "diameters go into a column bore_diameter_mm",
    }
    return f"expected a value between 0 and {largest:g}", hints.get(name, "correct it, or leave the point out")
