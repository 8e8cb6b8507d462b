# SPDX-License-Identifier: Apache-2.0
"""The grid lines of a rectangle of a case."""

from __future__ import annotations

from presswork.case.plane.workpiece import Rectangle
from presswork.mesh import grade_line
from presswork.model import FloatArray


def grid_lines(rectangle: Rectangle) -> tuple[FloatArray, FloatArray]:
    """Return the grid lines [mm] of a rectangle along x and y."""
    lines = []
    for axis, zones in enumerate((rectangle.zones_x, rectangle.zones_y)):
        if zones is not None:
            sizes = [(zone.length, zone.cells, zone.ratio) for zone in zones]
        else:
            assert rectangle.size is not None
            assert rectangle.cells is not None
            sizes = [(rectangle.size[axis], rectangle.cells[axis], rectangle.grading[axis])]
        lines.append(grade_line(rectangle.origin[axis], sizes))
    return lines[0], lines[1]
