# SPDX-License-Identifier: Apache-2.0
"""Whether a symmetry plane halves a shape: its part beyond the plane against its part beside the workpiece."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray


@dataclass(frozen=True)
class HalfSpace:
    """The side of a symmetry plane that is modelled."""

    axis: int
    """Axis that the plane is normal to."""
    level: float
    """Where the plane cuts this axis [mm]."""
    inward: float = 1.0
    """1 where the workpiece lies above the level, else -1."""

    def depth(self, places: FloatArray) -> FloatArray:
        """Return how far inside places (n, dimension) lie (n,) [mm]; negative beyond the plane."""
        return np.asarray(self.inward * (places[:, self.axis] - self.level))

    def mirror(self, places: FloatArray) -> FloatArray:
        """Return the mirror images of places (n, dimension) [mm]."""
        mirrored = np.array(places, dtype=float)
        mirrored[:, self.axis] = 2.0 * self.level - mirrored[:, self.axis]
        return mirrored


@dataclass(frozen=True)
class Asymmetry:
    """Where two halves of a shape differ most."""

    deviation: float
    """Distance of the mirror image of a place from the shape [mm]."""
    place: FloatArray
    """Place of that difference, on the side that is modelled (dimension,) [mm]."""

    def describe(self) -> str:
        """Describe by how much they differ, and where."""
        where = ", ".join(f"{x:.4g}" for x in np.round(self.place, 6) + 0.0)
        return f"its halves differ, by {self.deviation:.3g} mm at ({where})"


def find_asymmetry(
    places: FloatArray,
    measure: Callable[[FloatArray], FloatArray],
    half: HalfSpace,
    window: tuple[FloatArray, FloatArray],
    margin: float,
    tolerance: float,
) -> Asymmetry | None:
    """Return where the halves of a shape that a plane cuts differ most; None where they are alike.

    places: of the shape (n, dimension) [mm]. measure: distance of places from the shape; infinite past its
    rim, where one half goes on and the other does not. window: least and largest
    coordinates of what counts, on the side that is modelled. margin: a shape that ends no farther beyond the plane has
    no other half, and is taken for the half of one. tolerance: of the distance [mm].

    A half that reaches less far than the other is compared as far as it goes.
    """
    depth = half.depth(places)
    over = -float(depth.min(initial=np.inf))
    if over <= margin:
        return None
    inside = np.where((depth < 0.0)[:, None], half.mirror(places), places)
    counts = ((inside >= window[0]) & (inside <= window[1])).all(axis=1)
    counts &= (depth < -margin) | ((depth > margin) & (depth <= over))
    if not counts.any():
        return None
    off = np.abs(measure(half.mirror(places[counts])))
    off[~np.isfinite(off)] = 0.0
    worst = int(np.argmax(off))
    return Asymmetry(float(off[worst]), inside[counts][worst]) if off[worst] > tolerance else None
