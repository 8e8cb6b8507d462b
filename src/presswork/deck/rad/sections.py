# SPDX-License-Identifier: Apache-2.0
"""Properties of shells of OpenRadioss: /PROP/SHELL (1), SH_ORTH (9) and SH_SANDW (11)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.deck.contents import SectionCard
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_row
from presswork.deck.rad.cards import leave_fields, leave_rows
from presswork.model import FloatArray

_KINDS = {"SHELL": 1, "TYPE1": 1, "SH_ORTH": 9, "TYPE9": 9, "SH_SANDW": 11, "TYPE11": 11}
_FULL = 12
"""Ishell of shells with several points in their plane."""
_USUAL_POINTS = 5


@dataclass(frozen=True)
class Property:
    """A section, its material where it names one, and the axis of the material."""

    card: SectionCard
    material: int
    axis: FloatArray | None
    """Direction (3,), to be laid into the shells; None: it does not matter."""
    angle: float
    """Angle from the axis to the rolling direction, about the shells' normal [degree]."""

    def rolling(self, normal: FloatArray) -> tuple[float, float, float] | None:
        """Return the rolling direction in shells of a normal (3,)."""
        if self.axis is None:
            return None
        axis = self.axis - (self.axis @ normal) * normal
        axis /= np.linalg.norm(axis)
        turn = np.radians(self.angle)
        x, y, z = np.cos(turn) * axis + np.sin(turn) * np.cross(normal, axis)
        return float(x), float(y), float(z)


def read_property(block: Block, notes: Notes) -> Property | None:
    """Return a property; None where it has no counterpart, which is noted. Raises FieldError, IndexError."""
    kind = _KINDS.get(block.words[1] if len(block.words) > 1 else "")
    if kind is None:
        notes.refuse(block.place, block.keyword, "no such shells of a sheet here", f"take one of {', '.join(_KINDS)}")
        return None
    rows = block.titled()[1]
    form = int(read_row(rows[0], 10)[0])
    n_points, _, thickness = read_row(rows[2], 10, 10, 20)
    if not n_points:
        n_points = _USUAL_POINTS
        notes.change(block.place, block.keyword, f"no points through the thickness (N = 0): {_USUAL_POINTS}")
    thin = "" if form == _FULL else "-"
    leave_fields(block, rows[0], f"{thin}Ishell -Ismstr -Ish3n -Idrill", notes)
    leave_rows(block, rows[1:2], "hourglass and damping", notes)
    leave_fields(block, rows[2], "N -Istrain Thick:20 -Ashear:20 - -Ithick -Iplas", notes)
    material, axis, angle = 0, None, 0.0
    if kind != 1:
        *vector, angle = read_row(rows[3], 20, 20, 20, 20 if kind == 9 else 0)
        leave_fields(
            block, rows[3], f"Vx:20 Vy:20 Vz:20 {'Phi:20' if kind == 9 else 'skew_ID -Iorth !Ipos -Ip'}", notes
        )
        axis = np.array(vector) if any(vector) else np.array([1.0, 0.0, 0.0])
    if kind == 11:
        if read_row(rows[3][60:], 10)[0]:
            notes.refuse(block.place, block.keyword, "axes of the material by a frame (skew_ID)", "give Vx, Vy, Vz")
        layers = np.array([read_row(row, 20, 20, 20, 10) for row in rows[4 : 4 + int(n_points)]])
        if len(np.unique(layers[:, 0])) > 1 or len(np.unique(layers[:, 3])) > 1:
            notes.refuse(block.place, block.keyword, "a sheet of several layers", "give one material and one angle")
        angle, material = float(layers[0, 0]), int(layers[0, 3])
        thickness = thickness or float(layers[:, 1].sum())
    n_read = 3 if kind == 1 else 4 if kind == 9 else 4 + int(n_points)
    leave_rows(block, rows[n_read:], "further rows", notes)
    card = SectionCard(thickness, int(n_points), form == _FULL, block.place, block.keyword)
    return Property(card, material, axis, angle)
