# SPDX-License-Identifier: Apache-2.0
"""How the press of a deck is turned into that of a case: punch above, working down along z, planes of symmetry at 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.deck.contents import Held
from presswork.model import FloatArray, IndexArray

_FLAT = 1e-3
"""How far a flat sheet may leave its plane, over its size."""
_ON = 1e-4
"""How far nodes on a plane may lie off it, over the size of the sheet."""
_PLANES = {
    0: (True, False, False, False, True, True),
    1: (False, True, False, True, False, True),
    2: (False, False, True, True, True, False),
}
"""What symmetry planes normal to x, y, z hold."""


@dataclass(frozen=True)
class Seat:
    """Turn, then shift."""

    turn: FloatArray
    """Rotation matrix (3, 3)."""
    shift: FloatArray
    """(3,) [mm]."""

    def place(self, points: FloatArray) -> FloatArray:
        """Return points (n, 3) [mm] of the deck in the frame of the case."""
        return np.asarray(points @ self.turn.T + self.shift)

    def describe(self) -> str:
        """Describe what was done; empty where nothing was."""
        words = []
        if not np.allclose(self.turn, np.eye(3)):
            names = np.array(["x", "y", "z"])
            axes = [("-" if row.min() < -0.5 else "") + str(names[np.abs(row).argmax()]) for row in self.turn]
            words.append(f"x, y, z of the case are {', '.join(axes)} of the deck")
        if np.abs(self.shift).max() > 1e-9:
            words.append("moved by ({:.6g}, {:.6g}, {:.6g}) mm".format(*self.shift))
        return "; ".join(words)


def find_normal(points: FloatArray) -> int | None:
    """Return the axis normal to a flat sheet (n, 3); None where it is not flat, or lies askew."""
    extent = np.ptp(points, axis=0)
    axis = int(extent.argmin())
    return axis if extent[axis] <= _FLAT * extent.max() else None


def find_planes(
    points: FloatArray, index: IndexArray, held: Sequence[Held], normal: int
) -> dict[int, tuple[float, list[Held]]]:
    """Return position and supports of the symmetry planes of a sheet by their axis.

    points: of the sheet (n, 3); index: the place in it of a node's label, -1 for others. A plane holds all nodes of an
    end of the sheet, and they hold what mirrored halves hold of each other; z-supports of the sheet's plane count too.
    """
    planes: dict[int, tuple[float, list[Held]]] = {}
    size = float(np.ptp(points, axis=0).max())
    for axis, wanted in _PLANES.items():
        if axis == normal:
            continue
        own = [each for each in held if each.fixed == wanted]
        nodes = [index[each.nodes[each.nodes < len(index)]] for each in own]
        numbers = np.unique(np.concatenate(nodes)) if nodes else np.empty(0, dtype=np.intp)
        numbers = numbers[numbers >= 0]
        if not len(numbers):
            continue
        places = points[numbers, axis]
        if np.ptp(places) > _ON * size:
            continue
        at = float(places.mean())
        on = np.abs(points[:, axis] - at) <= _ON * size
        is_end = min(points[:, axis].max() - at, at - points[:, axis].min()) <= _ON * size
        if is_end and on.sum() == len(numbers):
            planes[axis] = (at, own)
    return planes


def seat(points: FloatArray, normal: int, upwards: bool, planes: dict[int, float]) -> tuple[Seat, tuple[str, ...]]:
    """Return how a deck is turned, and the symmetry of the blank in the case.

    points: of the flat sheet (n, 3) [mm]; upwards: whether the punch comes from the side of +normal; planes: position
    by axis [mm].
    """
    turn = np.eye(3)[[(normal + 1) % 3, (normal + 2) % 3, normal]]
    if not upwards:
        turn = np.diag([1.0, -1.0, -1.0]) @ turn
    best: tuple[Seat, tuple[str, ...]] | None = None
    for quarter in range(4):
        c, s = (1.0, 0.0, -1.0, 0.0)[quarter], (0.0, 1.0, 0.0, -1.0)[quarter]
        about = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ turn
        turned = points @ about.T
        shift, symmetry, fits = np.zeros(3), [], True
        shift[2] = -0.5 * (turned[:, 2].max() + turned[:, 2].min())
        for axis, at in planes.items():
            own = int(np.abs(about[:, axis]).argmax())
            position = at * about[own, axis]
            shift[own] = -position
            symmetry.append("xy"[own])
            fits &= bool(turned[:, own].min() - position > -1e-6 * np.ptp(turned[:, own]))
        if fits:
            best = Seat(about, shift), tuple(sorted(symmetry))
            break
    assert best is not None, "one of four quarters lies at x, y >= 0"
    return best
