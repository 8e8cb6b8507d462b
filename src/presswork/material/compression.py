# SPDX-License-Identifier: Apache-2.0
"""Measured hot compression tests: from a CSV file to flow stress, without friction, at the temperature of the metal.

Columns: `strain` and `stress` [MPa], true and positive in compression; `rate` [1/s] and `temperature` [degrees C] of
the test. Optional: `height` and `diameter` [mm] of the specimen at the start, and `m`, the friction factor; or,
instead of m, `final_height` and `barrel_diameter` [mm] after the test, and `top_diameter`, from which m follows.
Points of the same rate and temperature are a test; columns of the specimen are the same in all its lines.

Friction (Siebel 1923; Rowe 1977): p / sigma = 1 + 2 m r / (3 sqrt(3) h). m of a barrelled specimen (Ebrahimi &
Najafizadeh 2004, J. Mater. Process. Technol. 152, 136): m = (R/H) b / (4/sqrt(3) - 2 b / (3 sqrt(3))) with
b = 4 (dR/R) (H/dH), R and H mean radius and height after the test, dR the difference of the radii of barrel and top,
dH = H0 - H; without a measured top its radius is sqrt(3 R^2 - 2 R_barrel^2).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem, suggest
from presswork.material.measured_file import MeasuredFile, read_measured_file
from presswork.material.quantities import find_unit, read_title
from presswork.model import FloatArray

NEEDED = ("strain", "stress", "rate", "temperature")
SPECIMEN = ("height", "diameter", "m", "final_height", "barrel_diameter", "top_diameter")
SHOWN = 3
"""Cells that are no numbers which are named; the others are counted."""
FEWEST = 2
"""Points of a test, which make its curve."""
ADIABATIC = ((1e-3, 0.0), (1.0, 1.0))
"""Rates [1/s] up to which a test keeps its temperature, and from which its heat stays in it; Goetz & Semiatin 2001."""


@dataclass(frozen=True)
class CompressionTest:
    """One hot compression test at a constant rate; shapes (n,)."""

    rate: float
    """[1/s]"""
    start: float
    """Temperature when the test begins [degrees C]."""
    strain: FloatArray
    """True, increasing, positive in compression."""
    stress: FloatArray
    """True stress [MPa]: force over area as read, flow stress once friction is taken off."""
    temperature: FloatArray
    """Temperature of the metal [degrees C]: as the test begins, or with the heat of its plastic work."""
    slenderness: float | None = None
    """Radius over height of the specimen at the start; None: not given, nothing is corrected for friction."""
    m: float = 0.0
    """Friction factor."""

    def without_friction(self) -> CompressionTest:
        """Return the test with flow stress instead of force over area."""
        if self.slenderness is None or self.m == 0.0:
            return self
        ratio = self.slenderness * np.exp(1.5 * self.strain)  # r/h of a cylinder that stays one
        return replace(self, stress=self.stress / (1.0 + 2.0 * self.m * ratio / (3.0 * math.sqrt(3.0))))

    def with_heat(self, capacity: float, fraction: float = 0.9) -> CompressionTest:
        """Return the test with the temperature of its metal.

        capacity: heat capacity per volume [MPa/K]; fraction: of the plastic work that becomes heat.
        """
        kept = find_adiabatic_part(self.rate)
        steps = 0.5 * (self.stress[1:] + self.stress[:-1]) * np.diff(self.strain)
        work = np.concatenate([[0.0], np.cumsum(steps)]) + self.stress[0] * self.strain[0]
        return replace(self, temperature=self.start + kept * fraction * work / capacity)


def find_adiabatic_part(rate: float) -> float:
    """Return the part of the heat that stays in the specimen at a rate [1/s]: linear in its logarithm."""
    (slow, least), (fast, most) = ADIABATIC
    return float(np.interp(math.log(rate), [math.log(slow), math.log(fast)], [least, most]))


def find_friction_factor(
    height: float, diameter: float, final_height: float, barrel_diameter: float, top_diameter: float | None = None
) -> float:
    """Return the friction factor m of a specimen by its barrel; lengths in mm. Raises ValueError where it has none."""
    radius = 0.5 * diameter * math.sqrt(height / final_height)
    barrel = 0.5 * barrel_diameter
    square = 3.0 * radius**2 - 2.0 * barrel**2
    if top_diameter is None and square <= 0.0:
        raise ValueError(f"a barrel of {barrel_diameter:g} mm is more than the volume allows")
    top = 0.5 * top_diameter if top_diameter is not None else math.sqrt(square)
    if barrel < top:
        raise ValueError(f"the barrel, {barrel_diameter:g} mm, is not wider than the top, {2 * top:.4g} mm")
    b = 4.0 * (barrel - top) / radius * final_height / (height - final_height)
    below = 4.0 / math.sqrt(3.0) - 2.0 * b / (3.0 * math.sqrt(3.0))
    m = radius / final_height * b / below if below > 0.0 else math.inf
    if not m <= 1.0:
        raise ValueError(f"the barrel gives m = {m:.3g}, more than sticking")
    return m


def find_hot_head(file: MeasuredFile) -> int | None:
    """Return which line names columns of rate and temperature; None: the file has no hot compression tests."""
    for i, line in enumerate(file.lines):
        if {"rate", "temperature"} <= {read_title(cell)[0] for cell in line.cells}:
            return i
    return None


def read_compression(path: Path) -> list[CompressionTest]:
    """Read the tests by temperature and rate, as measured. Raises CaseError with every fault, by line."""
    file = read_measured_file(path)
    top = find_hot_head(file) or 0
    below = file.lines[top + 1 :]
    units = below[0].cells if below and all(find_unit(cell) for cell in below[0].cells if cell) else ()
    titles = [read_title(title, units[i] if i < len(units) else "") for i, title in enumerate(file.lines[top].cells)]
    head = [name for name, _ in titles]
    problems = [
        Problem("", f"no column {name}", f"name it so in the head line; {suggest(name, head, 'columns')}")
        for name in NEEDED
        if name not in head
    ]
    if problems:
        raise CaseError(problems, path)
    columns = [name for name in (*NEEDED, *SPECIMEN) if name in head]
    rows = []
    for line in (line for line in below[1 if units else 0 :] if not line.comment):
        row = []
        for name in columns:
            i = head.index(name)
            text = line.cells[i] if i < len(line.cells) else ""
            value = file.number(text)
            row.append(math.nan if value is None else titles[i][1] * value)
            at_rest = name == "stress" and row[-1] == 0.0 and row[0] == 0.0  # where curves often begin, and unused
            may_be_any = name in ("temperature", "m", "strain") or at_rest
            if not math.isfinite(row[-1]) or (not may_be_any and row[-1] <= 0.0):
                expected = "expected a number" if name in ("temperature", "m", "strain") else "expected a number > 0"
                problems.append(Problem(f"line {line.number}, {name}", expected, "mend the line", text))
        rows.append(row)
    if not rows:
        problems.append(Problem("", "no points", "give a line for each point"))
    if problems:
        more = [Problem("", f"{len(problems) - SHOWN} more cells that are no such numbers", "mend the file")]
        raise CaseError(problems[:SHOWN] + (more if len(problems) > SHOWN else []), path)
    table = dict(zip(columns, np.array(rows).T, strict=True))
    tests = []
    for start, rate in sorted(set(zip(table["temperature"].tolist(), table["rate"].tolist(), strict=True))):
        chosen = (table["temperature"] == start) & (table["rate"] == rate)
        tests.append(_make_test(start, rate, {name: v[chosen] for name, v in table.items()}, problems))
    if problems:
        raise CaseError(problems, path)
    return tests


def _make_test(start: float, rate: float, columns: dict[str, FloatArray], problems: list[Problem]) -> CompressionTest:
    """Sort the points of a test by strain, and note what makes it useless."""
    where = f"the test at {start:g} degrees C and {rate:g} 1/s"
    order = np.argsort(columns["strain"], kind="stable")
    strain, stress = columns["strain"][order], columns["stress"][order]
    keep = strain > 0.0
    test = CompressionTest(rate, start, strain[keep], stress[keep], np.full(int(keep.sum()), start))
    if len(test.strain) < FEWEST:
        problems.append(Problem(where, f"points with a strain > 0: {len(test.strain)}", f"give at least {FEWEST}"))
        return test
    if (np.diff(test.strain) <= 0.0).any():
        problems.append(Problem(where, "two points of the same strain", "leave one out"))
    elif test.strain[-1] > 3.0:
        problems.append(Problem(where, f"strain to {test.strain[-1]:g}", "give true strains, not per cent"))
    specimen = {}
    for name in SPECIMEN:
        if name in columns:
            if np.ptp(columns[name]) != 0.0:
                problems.append(Problem(where, f"{name} is not the same in all its lines", "give one value a test"))
            specimen[name] = float(columns[name][0])
    return _add_specimen(test, specimen, where, problems)


def _add_specimen(
    test: CompressionTest, given: dict[str, float], where: str, problems: list[Problem]
) -> CompressionTest:
    """Return the test with its specimen and friction factor."""
    if not given:
        return test
    if "height" not in given or "diameter" not in given:
        problems.append(Problem(where, "friction needs the specimen", "add the columns height and diameter [mm]"))
        return test
    m = given.get("m", 0.0)
    if "barrel_diameter" in given:
        if "m" in given or "final_height" not in given:
            problems.append(Problem(where, "a barrel needs final_height, and no m beside it", "mend the columns"))
            return test
        try:
            m = find_friction_factor(
                given["height"], given["diameter"], given["final_height"], given["barrel_diameter"],
                given.get("top_diameter"),
            )  # fmt: skip
        except ValueError as error:
            problems.append(Problem(where, str(error), "check the lengths [mm]"))
    if not 0.0 <= m <= 1.0:
        problems.append(Problem(where, f"m = {m:g}", "a friction factor lies between 0 and 1"))
    return replace(test, slenderness=0.5 * given["diameter"] / given["height"], m=m)


def correct(tests: Sequence[CompressionTest], capacity: float | None) -> list[CompressionTest]:
    """Return flow stress and temperature of the metal; capacity: per volume [MPa/K], None: no heating."""
    free = [test.without_friction() for test in tests]
    return free if capacity is None else [test.with_heat(capacity) for test in free]
