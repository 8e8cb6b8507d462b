# SPDX-License-Identifier: Apache-2.0
"""Tool profiles from files: points in a text file, a drawing in DXF, or the section of a model in STEP."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from presswork.case.plane.tool import ProfilePoint, Tool
from presswork.case.tools.dxf import read_drawing
from presswork.case.tools.profile import MEETING, Outline, ProfileError, draw_outline
from presswork.case.tools.step_section import read_section
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.chain import ProfileFileError, join_pieces
from presswork.mesh.files.cad import is_cad
from presswork.text_file import UnreadableError, read_text


def is_drawing(path: str | Path) -> bool:
    """Return whether a file is a DXF drawing; all others are text."""
    return Path(path).suffix.lower() == ".dxf"


def read_outline(path: Path, tool: Tool, *, is_half: bool = False) -> Outline:
    """Return the profile in a file, in mm; is_half: that of a section at x >= 0. Raises ProfileFileError.

    A text's points are joined by a smooth curve unless the tool has another setting. In a drawing lines and arcs stay
    what they are; splines and ellipses become arcs.
    """
    if not path.is_file():
        raise ProfileFileError("no such file", "check the path, which is relative to the case file")
    if is_cad(path):
        chain = join_pieces(*read_section(path, tool.section or "xy", tool.tolerance, is_half=is_half))
    elif is_drawing(path):
        factor = None if tool.unit is None else unit_factor(tool.unit, LENGTH)
        chain = join_pieces(*read_drawing(path, tool.layer, factor, tool.tolerance))
    else:
        return _outline_of_text(path, tool)
    start, end = chain.segments[0, 0:2], chain.segments[-1, 2:4]
    extent = float(np.linalg.norm(np.ptp(chain.segments[:, 0:4].reshape(-1, 2), axis=0)))
    if tool.closed and np.linalg.norm(end - start) > MEETING * extent:
        raise ProfileFileError(
            f"closed = true, but the drawing's chain is open, from ({start[0]:.6g}, {start[1]:.6g}) to "
            f"({end[0]:.6g}, {end[1]:.6g})",
            "close it in the drawing, or leave closed out",
        )
    unset = np.full(len(chain.segments), np.nan)
    return Outline(chain.segments, chain.pieces, unset, unset)


def _outline_of_text(path: Path, tool: Tool) -> Outline:
    points, lines = read_points(path, unit_factor(tool.unit or "mm", LENGTH))
    ends_meet = len(points) > 2 and points[0] == points[-1]
    least = 3 if tool.closed or ends_meet else 2
    if len(points) - ends_meet < least:
        raise ProfileFileError(
            f"{len(points)} points, where a profile needs at least {least}", "give a line with x and y for each point"
        )
    try:
        return draw_outline(
            [ProfilePoint(to=point) for point in points],
            tool.closed,
            spline=tool.curve != "polyline",
            corner_angle=tool.corner_angle,
            tolerance=tool.tolerance,
            names=[f"line {line}" for line in lines],
        )
    except ProfileError as error:
        raise ProfileFileError(f"line {lines[error.point]}: {error.fault}", error.remedy) from error


def read_points(path: Path, factor: float = 1.0) -> tuple[list[tuple[float, float]], list[int]]:
    """Read the points (x, y) of a text file, each multiplied by `factor`, and the numbers of their lines.

    Two columns, separated by commas, semicolons, tabs or blanks; beside semicolons or tabs a comma is a decimal one.
    What follows `#` is a comment; the first line may name the columns. Where it names `x_mm` and `y_mm`, as the
    outlines that the program writes do, the file may have other columns, and from a column `loop` the first loop is
    taken. A point that repeats the one before is left out. Raises ProfileFileError with the number of the line at
    fault.
    """
    try:
        text = read_text(path)
    except (OSError, UnreadableError):
        raise ProfileFileError("not a text file in UTF-8", "save it as text with two columns, x and y") from None
    points: list[tuple[float, float]] = []
    lines: list[int] = []
    may_be_header = True
    n_columns, x_column, y_column, loop_column, first_loop = 2, 0, 1, -1, None
    for number, line in enumerate(text.splitlines(), 1):
        content = line.partition("#")[0].strip()
        if not content:
            continue
        fields = _split_fields(content)
        numbers = [_read_number(field) for field in fields]
        if may_be_header and all(value is None for value in numbers):
            may_be_header = False
            if {"x_mm", "y_mm"} <= set(fields):
                n_columns, x_column, y_column = len(fields), fields.index("x_mm"), fields.index("y_mm")
                loop_column = fields.index("loop") if "loop" in fields else -1
            continue
        may_be_header = False
        x, y = (numbers[x_column], numbers[y_column]) if len(numbers) == n_columns else (None, None)
        if x is None or y is None:
            expected = "two numbers, x and y" if n_columns == 2 else f"{n_columns} numbers, as the first line names"
            raise ProfileFileError(
                f"line {number}: expected {expected}, but found `{content[:40]}`",
                "separate them by a comma, a semicolon or blanks; write comments behind #",
            )
        if loop_column >= 0:
            first_loop = numbers[loop_column] if first_loop is None else first_loop
            if numbers[loop_column] != first_loop:
                break
        if max(abs(x), abs(y)) * factor > LENGTH.largest:
            fault = (
                f"line {number}: a coordinate of {max(abs(x), abs(y)) * factor:.4g} mm, beyond {LENGTH.largest:g} mm"
            )
            raise ProfileFileError(fault, "check the file and its unit")
        if not points or points[-1] != (x * factor, y * factor):
            points.append((x * factor, y * factor))
            lines.append(number)
    return points, lines


def _split_fields(content: str) -> list[str]:
    for separator in (";", "\t"):
        if separator in content:
            return [field.strip().rstrip(",").replace(",", ".") for field in content.rstrip(separator).split(separator)]
    return [field.strip() for field in content.rstrip(",").split(",")] if "," in content else content.split()


def _read_number(field: str) -> float | None:
    """Return a finite number, or None."""
    try:
        value = float(field)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
