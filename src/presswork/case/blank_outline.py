# SPDX-License-Identifier: Apache-2.0
"""A blank's outline from a file: the points of a CSV file, or the closed chain of a DXF drawing."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.case.chain import ProfileFileError, join_pieces
from presswork.case.dxf import read_drawing
from presswork.case.profile import MEETING
from presswork.case.profile_file import is_drawing, read_points
from presswork.model import FloatArray

_ARC_STEP = np.radians(3.0)
"""Of the chords that replace an arc: they lie within 0.04 % of its radius."""


def read_blank_outline(path: Path, factor: float | None = None) -> FloatArray:
    """Return the outline in a file as a polygon (n, 2) [mm], the first point not repeated.

    factor: mm in a unit of the file; without it a drawing's own unit, or mm. CSV: columns x_mm and y_mm by
    name, of which the first `loop` is taken, or two columns. Raises ProfileFileError.
    """
    if not path.is_file():
        raise ProfileFileError(f"no such file ({path})", "check the path, which is relative to the case file")
    points = _read_drawn(path, factor) if is_drawing(path) else _read_listed(path, factor or 1.0)
    if len(points) > 1 and np.linalg.norm(points[0] - points[-1]) <= 1e-9 * np.ptp(points, axis=0).max():
        points = points[:-1]
    if len(points) < 3:
        raise ProfileFileError(f"{len(points)} points, where an outline needs at least 3", "give more points")
    return points


def _read_drawn(path: Path, factor: float | None) -> FloatArray:
    chain = join_pieces(*read_drawing(path, None, factor, None))
    start, end = chain.segments[0, 0:2], chain.segments[-1, 2:4]
    extent = float(np.linalg.norm(np.ptp(chain.segments[:, 0:4].reshape(-1, 2), axis=0)))
    if np.linalg.norm(end - start) > MEETING * extent:
        raise ProfileFileError(
            f"the drawing's chain is open, from ({start[0]:.6g}, {start[1]:.6g}) to ({end[0]:.6g}, {end[1]:.6g})",
            "close it in the drawing",
        )
    return np.concatenate([_chords(segment) for segment in chain.segments])


def _chords(segment: FloatArray) -> FloatArray:
    """Return the points of a line or an arc without its end."""
    start, end, centre, turn = segment[0:2], segment[2:4], segment[4:6], segment[6]
    if turn == 0.0:
        return start[None]
    first, last = start - centre, end - centre
    angle = turn * np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
    angle = angle if angle > 0.0 else angle + 2.0 * np.pi
    at = turn * angle * np.arange(n := int(np.ceil(angle / _ARC_STEP))) / n
    turned = np.stack([np.cos(at), -np.sin(at), np.sin(at), np.cos(at)], axis=1).reshape(-1, 2, 2)
    return np.asarray(centre + turned @ first)


def _read_listed(path: Path, factor: float) -> FloatArray:
    try:
        head, *rows = [line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
    except (OSError, UnicodeDecodeError, ValueError):
        raise ProfileFileError("no text file with points", "give a CSV file, or a DXF drawing") from None
    names = [name.strip() for name in head.split(",")]
    if not {"x_mm", "y_mm"} <= set(names):
        return np.array(read_points(path, factor)[0], dtype=float).reshape(-1, 2)
    try:
        table = np.array([[float(cell) for cell in row.split(",")] for row in rows]).reshape(-1, len(names))
    except ValueError:
        raise ProfileFileError(
            f"not every row has a number for each of {', '.join(names)}", "mend the file, or write it again"
        ) from None
    if "loop" in names and len(table):
        table = table[table[:, names.index("loop")] == table[0, names.index("loop")]]
    return factor * table[:, [names.index("x_mm"), names.index("y_mm")]]
