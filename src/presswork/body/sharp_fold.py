# SPDX-License-Identifier: Apache-2.0
"""Where a sheet is folded so sharply that its inner face has hardly any length left.

Between neighbouring nodes of a shell, e apart, with directors d1 and d2, a face lies t/2 off the middle surface, so it
is e -+ t/2 (d2 - d1) long: of the middle's length the inner face keeps c = 1 - t/2R, R the middle's radius. The inner
radius R - t/2 is t/2 c/(1 - c). Where it comes to zero the shell turns inside out; no smaller increment goes further.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.body.shell_arrays import ShellArrays
from presswork.body.shells import ShellMechanics
from presswork.mesh.topology import count_corners
from presswork.model import Mesh
from presswork.state import State

LEFT = 0.4
"""Of the middle's length, below which the inner face has hardly any left: an inner radius of a third of the
thickness."""


@dataclass(frozen=True)
class SharpFold:
    """The sharpest fold of a sheet."""

    place: tuple[float, float, float]
    """Between two nodes [mm]."""
    inner_radius: float
    """[mm]."""
    thickness: float
    """[mm]."""

    def __str__(self) -> str:
        x, y, z = np.round(self.place, 6) + 0.0
        radius, part = self.inner_radius, self.inner_radius / self.thickness
        how = f"to an inner radius of {radius:.2g} mm, {part:.2g} of its thickness" if radius else "without a radius"
        return (
            f"The sheet is folded at ({x:.4g}, {y:.4g}, {z:.4g}) mm {how}. A shell that is folded flat has no inner "
            "face left, and turns inside out"
        )


def find_sharp_fold(mesh: Mesh, mechanics: ShellMechanics, state: State) -> SharpFold | None:
    """Return the sharpest fold of a sheet, None where its inner faces keep more than LEFT of the middle's length."""
    points = mesh.points + state.nodes.displacement[:, :3]
    shells = state[ShellArrays]
    sharpest, least = None, LEFT
    for block, of_cell, thickness in zip(mesh.blocks, mechanics.directors.of_cell, shells.thickness, strict=True):
        n = count_corners(block.connectivity.shape[1])
        x, d = points[block.connectivity[:, :n]], shells.director[of_cell[:, :n]]
        t = thickness.mean(axis=1)
        edge, turn = np.roll(x, -1, axis=1) - x, np.roll(d, -1, axis=1) - d
        kept = 1.0 - 0.5 * t[:, None] * np.abs((edge * turn).sum(axis=2)) / (edge**2).sum(axis=2)
        cell, side = np.unravel_index(int(kept.argmin()), kept.shape)
        if kept[cell, side] < least:
            least = max(float(kept[cell, side]), 0.0)
            place = x[cell, side] + 0.5 * edge[cell, side]
            radius = 0.5 * float(t[cell]) * least / (1.0 - least)
            sharpest = SharpFold((float(place[0]), float(place[1]), float(place[2])), radius, float(t[cell]))
    return sharpest
