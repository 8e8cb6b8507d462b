# SPDX-License-Identifier: Apache-2.0
"""Drawbeads: lines in the plan that hold the sheet back, in the words of every kind of case. Units as in schema.py."""

from __future__ import annotations

import math
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from presswork.case.part import Part
from presswork.case.plane.tool import ProfilePoint
from presswork.case.tools.profile import ProfileError, draw_outline
from presswork.case.units import Length, LineForce, Point, fault
from presswork.geometry.segments import TURN
from presswork.model import FloatArray

CHORD = math.radians(2.0)
"""Turn of an arc between two points of the polyline that stands for it; its length is short by 5e-5 then."""


class Bead(Part):
    """A drawbead."""

    points: tuple[Point, ...] = Field(
        min_length=2, description="its corners [x, y] seen from above [mm], e.g. [[-40, 30], [40, 30]]"
    )
    force: LineForce = Field(ge=0, description='restraining force per length [N/mm], e.g. "50 N/mm"')
    radius: Length = Field(default=0.0, ge=0, description="radius that rounds its corners [mm]; 0: sharp")
    closed: bool = Field(
        default=False, strict=True, description="whether it goes on from the last point to the first, round the part"
    )

    @model_validator(mode="after")
    def _check_line(self) -> Self:
        if self.closed and len(self.points) < 3:
            raise fault("a closed line needs three points", "give more, or leave closed out", key="points")
        if self.radius > 0 and len(self.points) < 3:
            raise fault("a line of two points has no corner to round", "leave radius out", key="radius")
        try:
            self.polyline()
        except ProfileError as error:
            key = "radius" if self.radius > 0 else "points"
            raise fault(f"point {error.point}: {error.fault}", error.remedy, key=key) from None
        return self

    def polyline(self) -> FloatArray:
        """Return the line with its arcs in chords (n, 2) [mm]; a closed one ends where it begins."""
        points, closed = self.points, self.closed
        if len(points) > 3 and points[0] == points[-1]:
            points, closed = points[:-1], True
        inner = range(len(points)) if closed else range(1, len(points) - 1)
        corners = [
            ProfilePoint(to=to, radius=self.radius if index in inner else 0.0) for index, to in enumerate(points)
        ]
        rows = []
        segments = draw_outline(corners, closed).segments
        for segment in segments:
            rows.append(segment[:2][None])
            if segment[TURN] != 0:
                rows.append(_arc(segment))
        return np.concatenate([*rows, segments[-1:, 2:4]])


def _arc(segment: FloatArray) -> FloatArray:
    """Return the points inside an arc (n, 2)."""
    centre, turn = segment[4:6], float(segment[TURN])
    first, last = (segment[i : i + 2] - centre for i in (0, 2))
    begin, end = (math.atan2(v[1], v[0]) for v in (first, last))
    sweep = (end - begin) % (2 * math.pi) if turn > 0 else -((begin - end) % (2 * math.pi))
    angle = begin + np.linspace(0.0, sweep, max(2, math.ceil(abs(sweep) / CHORD) + 1))[1:-1]
    return np.asarray(centre + float(np.linalg.norm(first)) * np.column_stack([np.cos(angle), np.sin(angle)]))
