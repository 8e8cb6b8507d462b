# SPDX-License-Identifier: Apache-2.0
"""Analytical rigid surfaces of Abaqus: profiles of lines, arcs and parabolas, swept along a line or turned.

They become shells whose chords lie within a tolerance of the arcs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.mesh.files.abaqus_blocks import Block, DataError
from presswork.mesh.files.abaqus_places import to_float
from presswork.model import FloatArray, IndexArray

KINDS = ("CYLINDER", "REVOLUTION", "SEGMENTS")
_PARABOLA = 16
"""Chords of a parabola."""


@dataclass(frozen=True)
class DrawnSurface:
    """A profile in its plane, and how it becomes a surface."""

    kind: str
    origin: FloatArray
    """(3,)."""
    axes: FloatArray
    """Rows: x and y of the profile, and what it is swept along; of one that turns, r, the axis, r x axis (3, 3)."""
    rows: list[list[str]]
    """START, and the lines, arcs and parabolas from there."""

    def profile(self, tolerance: float) -> FloatArray:
        """Return points (n, 2) of the profile; chords lie within a tolerance of arcs. Raises DataError."""
        points = [np.array([float(word) for word in self.rows[0][1:3]])]
        for word, *values in self.rows[1:]:
            start, numbers = points[-1], _numbers(values)
            match word.upper(), len(numbers):
                case "LINE", 2:
                    points.append(numbers)
                case "CIRCL", 4:
                    points += list(_arc(start, numbers[:2], numbers[2:], tolerance))
                case "PARAB", 4:
                    t = np.linspace(0.0, 1.0, _PARABOLA + 1)[1:, None]
                    middle, end = numbers[:2], numbers[2:]
                    points += list((1 - t) * (1 - 2 * t) * start + 4 * t * (1 - t) * middle + t * (2 * t - 1) * end)
                case _:
                    raise DataError(f"`{word}` with {len(numbers)} numbers is not a piece of a profile")
        return np.array(points)

    def mesh(self, sheet: FloatArray, tolerance: float) -> tuple[FloatArray, IndexArray]:
        """Return points (n, 3) and shells (m, 4), triangles with their last node twice. Raises DataError.

        sheet: points of what is formed in the frame of the surface (k, 3), past which a surface is swept.
        """
        profile = self.profile(tolerance)
        if self.kind == "REVOLUTION":
            return self._turn(profile, tolerance)
        along = (sheet - self.origin) @ self.axes[2]
        margin = 0.1 * float(np.ptp(along)) or 1.0
        ends = np.array([along.min() - margin, along.max() + margin])
        local = np.concatenate([np.column_stack([profile, np.full(len(profile), end)]) for end in ends])
        i, n = np.arange(len(profile) - 1), len(profile)
        return self.origin + local @ self.axes, np.column_stack([i, i + 1, n + i + 1, n + i])

    def _turn(self, profile: FloatArray, tolerance: float) -> tuple[FloatArray, IndexArray]:
        r = profile[:, 0]
        if (r < -1e-9 * r.max()).any():
            raise DataError("a profile of revolution goes beyond its axis")
        n = max(36, _count_chords(2.0 * np.pi, float(r.max()), tolerance))
        angle = 2.0 * np.pi * np.arange(n) / n
        local = np.stack(
            [np.outer(r, np.cos(angle)), np.repeat(profile[:, 1:], n, axis=1), np.outer(r, np.sin(angle))], axis=-1
        )
        number = np.arange(len(profile) * n).reshape(len(profile), n)
        on_axis = r <= 1e-9 * r.max()
        number[on_axis] = number[on_axis][:, :1]
        after = np.roll(number, -1, axis=1)
        cells = np.stack([number[:-1], number[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
        begins = cells[:, 0] == cells[:, 3]
        cells[begins, 3] = cells[begins, 2]
        ends = cells[:, 1] == cells[:, 2]
        cells[ends] = cells[ends][:, [0, 1, 3, 3]]
        return self.origin + local.reshape(-1, 3) @ self.axes, cells[cells[:, 0] != cells[:, 1]]


def read_drawn(block: Block) -> DrawnSurface:
    """Return the surface of a *SURFACE of a type in KINDS. Raises DataError.

    A part's own axes hold where none are given: x and y of the profile are its X and Y, it turns about Y.
    """
    if float(block.parameters.get("FILLET RADIUS") or 0.0):
        raise DataError("corners rounded by FILLET RADIUS: give their arcs by CIRCL")
    rows = block.rows()
    starts = [number for number, row in enumerate(rows) if row[0].upper() == "START"]
    if not starts or len(rows) < starts[0] + 2:
        raise DataError("a profile has START and at least one piece")
    frame = [_numbers(row) for row in rows[: starts[0]]]
    kind, origin, axes = block.name_of("TYPE"), np.zeros(3), np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0]])
    if frame:
        if len(frame[0]) != 6 or (kind == "CYLINDER" and (len(frame) < 2 or len(frame[1]) != 3)):
            raise DataError("the rows above START are not points a, b and c")
        origin, along = frame[0][:3], frame[0][3:] - frame[0][:3]
        along = along / np.linalg.norm(along)
        if kind == "CYLINDER":
            sweep = frame[1] - origin
            y = np.cross(along, sweep)
            axes = np.array([along, y / np.linalg.norm(y), sweep / np.linalg.norm(sweep)])
        else:
            x = np.cross(along, np.eye(3)[int(np.abs(along).argmin())])
            x /= np.linalg.norm(x)
            axes = np.array([x, along, np.cross(x, along)])
    return DrawnSurface(kind, origin, axes, rows[starts[0] :])


def _numbers(words: list[str]) -> FloatArray:
    """Return the numbers of a row without blanks at its end; others are 0. Raises DataError."""
    n = max((i for i, word in enumerate(words, 1) if word), default=0)
    return np.array([to_float(word) for word in words[:n]])


def _arc(start: FloatArray, end: FloatArray, centre: FloatArray, tolerance: float) -> FloatArray:
    """Return points after the start of an arc of less than half a circle (n, 2). Raises DataError."""
    radii = [float(np.linalg.norm(point - centre)) for point in (start, end)]
    if abs(radii[0] - radii[1]) > 1e-3 * max(radii):
        raise DataError(f"an arc whose ends are {radii[0]:.6g} and {radii[1]:.6g} from its centre")
    first, last = (np.arctan2(*(point - centre)[::-1]) for point in (start, end))
    angle = (last - first + np.pi) % (2.0 * np.pi) - np.pi
    n = _count_chords(abs(angle), radii[0], tolerance)
    along = first + angle * np.arange(1, n) / n
    inner = centre + radii[0] * np.column_stack([np.cos(along), np.sin(along)])
    return np.vstack([inner, end])


def _count_chords(angle: float, radius: float, tolerance: float) -> int:
    """Return how many chords of an arc lie within a tolerance of it; none is longer than 10 degrees."""
    step = min(np.radians(10.0), 2.0 * np.arccos(max(0.0, 1.0 - tolerance / radius)) if radius else np.pi)
    return max(1, int(np.ceil(angle / step - 1e-9)))
