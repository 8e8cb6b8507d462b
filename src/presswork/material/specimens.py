# SPDX-License-Identifier: Apache-2.0
"""Specimens of tensile tests in a file that a test machine wrote: which columns, over which lengths, at which angle."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.material.measured_file import Block, MeasuredFile, read_measured_file
from presswork.material.quantities import Quantity, find_unit, plain, read_column
from presswork.material.specimen_facts import Sizes, read_angle, read_facts
from presswork.model import FloatArray

STRESS, STRAIN = ("stress", "force"), ("extensometer", "strain", "path")
"""Kinds of columns for stress and for strain, the better ones first."""
TRUE_NAMES = ("strain", "strain_percent", "stress")
"""Names that, written exactly so, mean true values; other names mean engineering values unless they contain "true"."""
SHOWN = 3
"""Faults of a kind that are named; the others are counted."""
LARGEST = 1e6
"""Above any angle, strain or stress of a test."""
REMEDY = (
    "name them in a head line, for instance strain,stress (true) or engineering_strain,engineering_stress, or as "
    "machines do, displacement [mm];force [N]"
)


@dataclass(frozen=True)
class Specimen:
    """A specimen's columns as fractions and MPa; shapes (n,), in the order of the file."""

    angle: float
    """Degrees from the rolling direction."""
    strain: FloatArray
    stress: FloatArray
    width_strain: FloatArray | None
    true_strain: bool
    true_stress: bool
    of_machine: bool
    """Whether the strain is that of the crosshead, in which the machine's own give has its part."""
    how: str
    """What was read, in one line."""


def read_specimens(path: Path, given: Sizes) -> list[Specimen]:
    """Read every specimen of a file; given: facts that replace those of the file.

    Raises CaseError with every fault.
    """
    file = read_measured_file(path)
    if not file.blocks:
        raise CaseError([_explain_no_rows(file)], path)
    found: list[Specimen] = []
    problems: list[Problem] = []
    sizes, columns = Sizes(), None
    for block in file.blocks:
        sizes = read_facts(block.head, sizes, file.decimal)
        columns = _find_columns(block, file) or columns
        if columns is None:
            names = next((line.cells for line in reversed(block.head) if len(line.cells) > 1), ())
            listed = f"; columns: {', '.join(sorted(name for name in names if name))}" if names else ""
            problems.append(Problem("", "no columns of strain and stress", f"{REMEDY}{listed}"))
            break
        known = replace(sizes, **{key: value for key, value in vars(given).items() if value is not None})
        for group in _split_groups(columns):
            found += _read_group(block, group, known, file, problems)
    if problems:
        raise CaseError(list(dict.fromkeys(problems)), path)
    return found


def _explain_no_rows(file: MeasuredFile) -> Problem:
    """Return the problem of a file without rows of numbers: the first cell under a head that is none, if there is."""
    for above, below in zip(file.lines, file.lines[1:], strict=False):
        kinds = {read_column(cell).kind for cell in above.cells}
        if not (kinds & set(STRESS) and kinds & set(STRAIN)):
            continue
        for name, cell in zip(above.cells, below.cells, strict=False):
            if file.number(cell) is None and find_unit(cell) is None:
                return Problem(f"line {below.number}, {name}", "expected a number", "give a line for each point", cell)
    names = file.lines[0].cells
    listed = f"; columns: {', '.join(sorted(names))}" if len(names) > 1 else ""
    return Problem("", "no columns of strain and stress with numbers below them", f"{REMEDY}{listed}")


def _find_columns(block: Block, file: MeasuredFile) -> tuple[Quantity, ...] | None:
    """Return what the columns of a block are, by the head line nearest above it; None without one."""
    for comment, of_units in ((False, False), (False, True), (True, False)):  # names before a row of units alone
        for i in range(len(block.head) - 1, -1, -1):
            line = block.head[i]
            units_alone = all(find_unit(cell) for cell in line.cells if cell)
            if line.comment != comment or len(line.cells) < 2 or units_alone != of_units:
                continue
            below = block.head[i + 1].cells if i + 1 < len(block.head) else ()
            units = below if any(find_unit(cell) for cell in below) else ()
            padded = (*units, *[""] * len(line.cells))
            columns = tuple(read_column(cell, padded[k]) for k, cell in enumerate(line.cells))
            kinds = {column.kind for column in columns}
            if kinds & set(STRESS) and kinds & set(STRAIN):
                return columns
    return None


def _split_groups(columns: Sequence[Quantity]) -> list[dict[int, Quantity]]:
    """Return the columns of each specimen, where a file has several side by side."""
    groups: list[dict[int, Quantity]] = [{}]
    for i, column in enumerate(columns):
        if column.kind in ("", "angle", "specimen"):
            continue
        names = [_bare(other) for other in groups[-1].values()]
        if _bare(column) in names:
            groups.append({})
        groups[-1][i] = column
    whole = all(
        {c.kind for c in g.values()} & set(STRESS) and {c.kind for c in g.values()} & set(STRAIN) for g in groups
    )
    if whole:
        shared = {i: c for i, c in enumerate(columns) if c.kind in ("angle", "specimen")}
        return [{**shared, **group} for group in groups]
    first: dict[int, Quantity] = {}
    for i, column in enumerate(columns):
        if _bare(column) not in [_bare(other) for other in first.values()]:
            first[i] = column
    return [first]


def _bare(column: Quantity) -> str:
    """Return a column's name without a number at its end, with its unit, as two specimens have it alike."""
    return f"{re.sub(r'[ _]*[0-9]+$', '', plain(column.title))} {column.unit}"


def _read_group(
    block: Block, group: dict[int, Quantity], sizes: Sizes, file: MeasuredFile, problems: list[Problem]
) -> list[Specimen]:
    """Return the specimens in some columns of a block, one for each angle and name in its lines."""
    try:
        stress_at, strain_at = _choose(group, STRESS), _choose(group, STRAIN)
    except ValueError as error:
        problems.append(Problem("", f"{error} are given twice", "leave one of them out"))
        return []
    width_at = next((i for i, column in group.items() if column.kind == "width"), None)
    wanted = [i for i in (strain_at, stress_at, width_at) if i is not None]
    named = [i for i, column in group.items() if column.kind in ("angle", "specimen")]
    rows = [line for line in block.rows if any(i < len(line.cells) and line.cells[i] for i in wanted)]
    while rows and any(i >= len(rows[-1].cells) or not rows[-1].cells[i] for i in wanted):
        rows.pop()  # an extensometer that was taken off
    faults: list[Problem] = []
    parts: dict[tuple[str, ...], list[list[float]]] = {}
    for line in rows:
        values = []
        for i in wanted:
            text = line.cells[i] if i < len(line.cells) else ""
            value = file.number(text)
            if value is None or not abs(value) < LARGEST * 1e3:
                title = group[i].title
                faults.append(Problem(f"line {line.number}, {title}", "expected a number", "mend the line", text))
            values.append(math.nan if value is None else value)
        parts.setdefault(tuple(line.cells[i] if i < len(line.cells) else "" for i in named), []).append(values)
    if faults:
        problems += faults[:SHOWN]
        if len(faults) > SHOWN:
            problems.append(Problem("", f"{len(faults) - SHOWN} more cells that are not numbers", "mend the file"))
        return []
    found = []
    for key, points in parts.items():
        one = sizes
        for i, text in zip(named, key, strict=True):
            angle = read_angle(text, "angle" if group[i].kind == "angle" else "", file.decimal)
            one = one if angle is None else replace(one, angle=angle)
        table = dict(zip(wanted, np.array(points).T, strict=True))
        specimen = _make_specimen(group, table, (stress_at, strain_at, width_at), one, problems)
        found += [specimen] if specimen else []
    return found


def _choose(group: dict[int, Quantity], kinds: Sequence[str]) -> int:
    """Return the column of the best of some kinds. Raises ValueError with the names where there are two."""
    for kind in kinds:
        found = [i for i, column in group.items() if column.kind == kind]
        true = [i for i in found if group[i].true]
        if len(found) > 1 and len(true) == 1 and all(group[i].true is not None for i in found):
            return true[0]  # engineering values are beside them
        if len(found) > 1:
            raise ValueError(" and ".join(group[i].title for i in found))
        if found:
            return found[0]
    raise ValueError("no columns")  # not reached: a group has both


def _make_specimen(
    group: dict[int, Quantity],
    table: dict[int, FloatArray],
    places: tuple[int, int, int | None],
    sizes: Sizes,
    problems: list[Problem],
) -> Specimen | None:
    """Turn the columns of a specimen into strains and stresses; None where a size is missing."""
    force, stretch = group[places[0]], group[places[1]]
    sources = [f"stress from {force.title}", f"strain from {stretch.title}"]
    stress, strain = force.factor * table[places[0]], stretch.factor * table[places[1]]
    missing: list[Problem] = []
    if force.kind == "force":
        area = sizes.find_area()
        if area is None:
            text = "forces need the cross section of the specimen"
            missing.append(Problem(force.title, text, "give --thickness and --width [mm]"))
        else:
            stress = stress / area
            sources[0] += f" over {area:g} mm2"
    if stretch.kind == "path" or (stretch.kind == "extensometer" and stretch.dimension != "strain"):
        length = sizes.extensometer_length if stretch.kind == "extensometer" else None
        length = length or sizes.gauge_length
        if length is None:
            text = "a change of length needs the gauge length"
            missing.append(Problem(stretch.title, text, "give --gauge-length [mm]"))
        else:
            strain = strain / length
            sources[1] += f" over {length:g} mm"
    across = None
    if places[2] is not None:
        across = _read_width(group[places[2]], table[places[2]], sizes, missing)
        sources.append(f"width from {group[places[2]].title}")
    problems += missing
    if missing:
        return None
    if min(strain.min(), 0.0 if across is None else across.min()) <= -1.0:
        problems.append(Problem("", "strains of -1 and below: nothing would be left", "mend their signs"))
        return None
    true_strain, true_stress = (
        column.title in TRUE_NAMES if column.true is None else column.true for column in (stretch, force)
    )
    kinds = ["true" if true else "engineering" for true in (true_strain, true_stress)]
    sources = [f"{kind} {text}" for kind, text in zip(kinds, sources[:2], strict=True)] + sources[2:]
    angle = sizes.angle or 0.0
    how = f"{angle:g} degrees: {', '.join(sources)}"
    return Specimen(angle, strain, stress, across, true_strain, true_stress, stretch.kind == "path", how)


def _read_width(column: Quantity, values: FloatArray, sizes: Sizes, missing: list[Problem]) -> FloatArray:
    """Return the strain across of a column of strains, of changes of width, or of widths."""
    name = plain(column.title)
    narrowing = re.search(r"reduction|abnahme|contraction|narrow|verringerung", name) is not None
    sign = -1.0 if narrowing and np.median(values) > 0.0 else 1.0
    of_length = re.search(r"anderung|change|variation|delta", name) is not None
    if column.dimension == "strain" or (not column.unit and not of_length and re.search(r"strain|dehnung|def", name)):
        return sign * column.factor * values
    values = sign * column.factor * values
    if sizes.width is None and not values[0] > 0.0:
        missing.append(Problem(column.title, "a change of width needs the width", "give --width [mm]"))
        return values
    width = sizes.width or float(values[0])
    return values / width - 1.0 if values[0] > 0.5 * width else values / width
