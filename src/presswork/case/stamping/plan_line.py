# SPDX-License-Identifier: Apache-2.0
"""Closed lines in the plan of a blank or a part: drawn by dimensions, or from a file. Units as in schema.py."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork.case.errors import Problem
from presswork.case.names import FileName
from presswork.case.part import Part
from presswork.case.plane.tool import ProfilePoint
from presswork.case.tools.dxf import read_drawing
from presswork.case.tools.profile import ProfileError, draw_outline
from presswork.case.tools.profile_file import is_drawing, read_points
from presswork.case.units import LENGTH, Length, Point, fault, unit_factor
from presswork.geometry.chain import ProfileFileError, join_pieces
from presswork.geometry.crossing import find_crossing
from presswork.geometry.segments import sample_arc
from presswork.model import FloatArray

SMALLEST = 1e-3
"""Extent below which a line encloses nothing [mm]."""
FINE = 1e-5
"""How far the chords of its arcs may be off, over a line's extent."""
MEETING = 1e-5
"""How far apart its ends may be, over a line's extent."""


class RectangularLine(Part):
    """A rectangle with sides along x and y."""

    shape: Literal["rectangle"] = Field(description="a rectangle along x and y")
    size: Point = Field(description="length along x and y [mm], e.g. [60, 40]")
    corner_radius: Length = Field(default=0.0, ge=0, description="radius of its corners [mm]; 0: sharp")
    centre: Point = Field(default=(0.0, 0.0), description="middle [x, y] [mm]")

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if min(self.size) <= 0:
            raise fault("expected two values > 0", "give [x, y], both positive", key="size")
        if self.corner_radius > 0.5 * min(self.size):
            raise fault("larger than half a side", f"at most {0.5 * min(self.size):g} fits", key="corner_radius")
        return self

    def draw(self, folder: Path) -> FloatArray:
        """Return the line's segments."""
        (a, b), (x, y) = (0.5 * np.array(self.size)).tolist(), self.centre
        corners = [(x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b)]
        return _draw(corners, self.corner_radius)


class CircularLine(Part):
    """A circle."""

    shape: Literal["circle"] = Field(description="a circle")
    diameter: Length = Field(gt=0, description="diameter of the circle [mm]")
    centre: Point = Field(default=(0.0, 0.0), description="middle [x, y] [mm]")

    def draw(self, folder: Path) -> FloatArray:
        """Return the line's segments: two half circles."""
        (x, y), r = self.centre, 0.5 * self.diameter
        return np.array([[x + r, y, x - r, y, x, y, 1.0], [x - r, y, x + r, y, x, y, 1.0]])


class PolygonLine(Part):
    """A polygon, whose corners may be rounded."""

    shape: Literal["polygon"] = Field(description="a polygon")
    points: tuple[Point, ...] = Field(min_length=3, description="its corners in turn [mm]; the last meets the first")
    corner_radius: Length = Field(default=0.0, ge=0, description="radius of its corners [mm]; 0: sharp")

    def draw(self, folder: Path) -> FloatArray:
        """Return the line's segments."""
        return _draw(list(self.points), self.corner_radius)


class LineFile(Part):
    """A drawing, or the corners of a polygon in a text file."""

    shape: Literal["file"] = Field(description="a DXF drawing, or a text file with the corners of a polygon")
    path: FileName = Field(description="the file, relative to the case file")
    unit: str | None = Field(
        default=None, description="length unit of its coordinates; without it a drawing's own, or mm"
    )
    layer: str | None = Field(default=None, description="of a drawing: the layer that it is on; without it: all layers")

    def draw(self, folder: Path) -> FloatArray:
        """Return the line's segments."""
        path = folder / self.path
        if not path.is_file():
            raise ProfileFileError("no such file", "check the path, which is relative to the case file")
        if is_drawing(path):
            factor = None if self.unit is None else unit_factor(self.unit, LENGTH)
            return join_pieces(*read_drawing(path, self.layer, factor, None)).segments
        points, _ = read_points(path, unit_factor(self.unit or "mm", LENGTH))
        if len(points) < 3:
            raise ProfileFileError(f"{len(points)} points, where a polygon has 3 or more", "give x and y of each")
        return _draw(points, 0.0)


PlanLine = RectangularLine | CircularLine | PolygonLine | LineFile


class _Trim(Part):
    """A line that the formed part, or the surface of a tool, is cut along, seen along z."""

    keep: Literal["inside", "outside"] = Field(
        default="inside", description="which side of the line stays: inside; or outside, which cuts a hole"
    )


class RectangularTrim(_Trim, RectangularLine):
    """A rectangle with sides along x and y."""


class CircularTrim(_Trim, CircularLine):
    """A circle."""


class PolygonTrim(_Trim, PolygonLine):
    """A polygon, whose corners may be rounded."""


class TrimFile(_Trim, LineFile):
    """A line from a file."""


Trim = Annotated[RectangularTrim | CircularTrim | PolygonTrim | TrimFile, Field(discriminator="shape")]


def _draw(corners: list[tuple[float, float]], radius: float) -> FloatArray:
    """Return the segments of a closed polygon with rounded corners. Raises ProfileError."""
    if len(corners) > 3 and np.allclose(corners[0], corners[-1], rtol=0.0, atol=1e-9 * float(np.ptp(corners))):
        corners = corners[:-1]
    _check_radius(np.array(corners), radius)
    return draw_outline([ProfilePoint(to=corner, radius=radius) for corner in corners], closed=True).segments


def _check_radius(corners: FloatArray, radius: float) -> None:
    """Raise ProfileError where the radius leaves nothing of a side (n, 2)."""
    side = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(side, axis=1)
    before = np.roll(side, 1, axis=0)
    cross = before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0]
    taken = np.tan(0.5 * np.abs(np.arctan2(cross, (before * side).sum(axis=1))))  # of a side by a radius of 1
    largest = length / np.maximum(taken + np.roll(taken, -1), 1e-12)
    worst = int(np.argmin(largest))
    if length.all() and radius > largest[worst] * (1 + 1e-9):
        text = f"a radius of {radius:g} mm does not fit the side from here"
        raise ProfileError(worst, text, f"at most {largest[worst]:.4g} mm fits")


def draw_line(line: PlanLine, key: str, folder: Path, chord: float = FINE) -> FloatArray | Problem:
    """Return a line as a polygon (m, 2) [mm]; or what is wrong with it.

    key: of the line's table in the case; folder: of the case file; chord: of the line's extent, how far the chords of
    its arcs may be off.
    """
    at = f"{key}.path" if isinstance(line, LineFile) else key
    value = (line.path,) if isinstance(line, LineFile) else ()
    try:
        segments = line.draw(folder)
    except ProfileFileError as error:
        return Problem(at, error.fault, error.remedy, *value)
    except ProfileError as error:
        where = f"{key}.points.{error.point}" if isinstance(line, PolygonLine) else key
        return Problem(where, error.fault, error.remedy)
    extent = float(np.linalg.norm(np.ptp(segments[:, :4].reshape(-1, 2), axis=0)))
    if extent < SMALLEST:
        return Problem(at, f"the line is only {extent:.3g} mm across", "give its dimensions in mm", *value)
    start, end = segments[0, :2], segments[-1, 2:4]
    if np.linalg.norm(end - start) > MEETING * extent:
        text = f"the line is open, from ({start[0]:.6g}, {start[1]:.6g}) to ({end[0]:.6g}, {end[1]:.6g})"
        return Problem(at, text, "close it in the drawing", *value)
    crossing = find_crossing(segments)
    if crossing is not None:
        x, y = crossing.point
        return Problem(at, f"the line crosses or touches itself at ({x:.6g}, {y:.6g})", "draw it without", *value)
    return np.concatenate([sample_arc(segment, chord * extent)[:-1] for segment in segments])
