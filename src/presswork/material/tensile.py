# SPDX-License-Identifier: Apache-2.0
"""Measured tensile tests: from a CSV file to true stress against plastic strain up to the uniform elongation.

Columns: `strain` and `stress` [MPa] (true), or `engineering_strain` and `engineering_stress`; strains are fractions, or
per cent with the ending `_percent`. Optional: the strain's column with `width_` before it, of the same kind and
negative in tension, for r-values; `angle` of the specimen from the rolling direction [degrees], 0 without it. Lines
that start with # are left out; other columns are ignored.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.table_file import read_table_lines
from presswork.model import FloatArray

_KINDS = {
    ("strain", "stress"): (False, 1.0),
    ("strain_percent", "stress"): (False, 0.01),
    ("engineering_strain", "engineering_stress"): (True, 1.0),
    ("engineering_strain_percent", "engineering_stress"): (True, 0.01),
}
"""Columns: whether they are engineering values, and the factor of the strain."""


LARGEST = 1e6
"""Above any angle, strain or stress of a test."""


@dataclass(frozen=True)
class TensileTest:
    """One direction's test, true values, up to the uniform elongation; shapes (n,)."""

    angle: float
    """Degrees from the rolling direction."""
    strain: FloatArray
    """True strain along the specimen."""
    stress: FloatArray
    """True stress [MPa]."""
    width_strain: FloatArray | None
    """True strain across, if it was measured."""

    def plastic_strain(self, young: float) -> FloatArray:
        """Return the plastic strain along the specimen."""
        return self.strain - self.stress / young


def read_tensile(path: Path) -> list[TensileTest]:
    """Read tensile tests by direction. Raises CaseError with every fault, by line."""
    lines = read_table_lines(path, least=2)
    head = [name.strip() for name in lines[0][1]]
    problems: list[Problem] = []
    found = [pair for pair in _KINDS if set(pair) <= set(head)]
    if len(found) != 1:
        text = "strain and stress are given twice" if found else "no columns of strain and stress"
        remedy = "name them strain, stress or engineering_strain, engineering_stress (or ..._percent)"
        near = suggest("stress", head, "columns")
        raise CaseError([Problem("", text, f"{remedy}; {near}")], path)
    (strain_name, stress_name), (engineering, factor) = found[0], _KINDS[found[0]]
    optional = (f"width_{strain_name}", "angle")
    wanted = [strain_name, stress_name, *(name for name in optional if name in head)]
    rows = []
    for number, cells in lines[1:]:
        row = []
        for name in wanted:
            text = cells[head.index(name)].strip() if head.index(name) < len(cells) else ""
            value = _read_number(text)
            row.append(value)
            if not abs(value) < LARGEST:
                remedy = "decimals with a point, no larger than a metal's"
                problems.append(Problem(f"line {number}, {name}", "expected a number", remedy, text))
        rows.append(row)
    if not rows:
        problems.append(Problem("", "no points", "give a line for each point"))
    if problems:
        raise CaseError(problems, path)
    table = {name: np.array(column) for name, column in zip(wanted, zip(*rows, strict=True), strict=False)}
    strain, stress = factor * table[strain_name], table[stress_name]
    width = factor * table[optional[0]] if optional[0] in table else None
    if min(strain.min(), 0.0 if width is None else width.min()) <= -1.0:
        raise CaseError([Problem("", "strains of -1 and below: nothing would be left", "mend their signs")], path)
    angles = table.get("angle", np.zeros(len(strain)))
    tests = [
        _make_test(float(angle), strain, stress, width, angles == angle, engineering) for angle in np.unique(angles)
    ]
    for test in tests:
        _check(test, problems)
    if problems:
        raise CaseError(problems, path)
    return tests


def _read_number(text: str) -> float:
    """Return a number; nan for what is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def _make_test(
    angle: float,
    strain: FloatArray,
    stress: FloatArray,
    width: FloatArray | None,
    mine: FloatArray,
    engineering: bool,
) -> TensileTest:
    """Sort a direction's points by strain, make them true and cut them at the highest force."""
    order = np.argsort(strain[mine], kind="stable")
    strain, stress = strain[mine][order], stress[mine][order]
    width = None if width is None else width[mine][order]
    force = stress if engineering else stress * np.exp(-strain)
    last = int(np.argmax(force)) + 1
    if engineering:
        stress, strain = stress * (1 + strain), np.log1p(strain)
        width = None if width is None else np.log1p(width)
    return TensileTest(angle, strain[:last], stress[:last], None if width is None else width[:last])


def _check(test: TensileTest, problems: list[Problem]) -> None:
    """Say what makes a test useless."""
    where = f"the test at {test.angle:g} degrees"
    if len(test.strain) < 5:
        problems.append(Problem(where, f"{len(test.strain)} points up to the highest force", "give at least five"))
    elif test.strain[-1] > 2.0:
        problems.append(Problem(where, f"strain to {test.strain[-1]:g}", "per cent go into a column ..._percent"))
    elif test.stress.max() < 10.0:
        text = f"the highest stress is {test.stress.max():g} MPa, that of no metal"
        problems.append(Problem(where, text, "give stresses in MPa"))
