# SPDX-License-Identifier: Apache-2.0
"""Find where a trim line runs outside the sheet: there the part keeps the edge of the sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.geometry.polygon import contains, list_sides, measure_distance, sample_sides
from presswork.model import FloatArray

_PLACES = 2000
"""Number of places along the line that are checked."""
_ON = 1e-6
"""Part of the line's extent by which it may run beside the sheet's edge and counts as on it."""


@dataclass(frozen=True)
class Beside:
    """The part of a line that runs beside the sheet."""

    depth: float
    """Largest distance from the sheet [mm]."""
    place: tuple[float, float]
    """Place of the largest distance [mm]."""
    length: float
    """Length of the part that is outside [mm]."""
    whole: float
    """Length of the line within the modelled region [mm]."""


def find_beside(outline: FloatArray, line: FloatArray, symmetry: tuple[bool, bool]) -> Beside | None:
    """Return where a closed line (m, 2) runs beside the outline (n, 2, 2) of a sheet; None where it does not.

    symmetry: whether planes normal to x and y cut the sheet, which lies on one side of them.
    """
    sides = list_sides(line)
    length = float(np.linalg.norm(sides[:, 1] - sides[:, 0], axis=1).sum())
    tolerance = _ON * float(np.ptp(line, axis=0).max())
    places = sample_sides(sides, length / _PLACES)
    modelled = np.ones(len(places), dtype=bool)
    side = np.sign(outline.mean(axis=(0, 1)))  # negative of a part that was turned over or round
    for axis, is_cut in enumerate(symmetry):
        modelled &= (side[axis] * places[:, axis] > tolerance) | (not is_cut)
    places = places[modelled]
    outside = places[~contains(outline, places)]
    depth = measure_distance(outline, outside)
    outside, depth = outside[depth > tolerance], depth[depth > tolerance]
    if not len(depth):
        return None
    worst = int(np.argmax(depth))
    x, y = (float(c) for c in outside[worst])
    share = length / len(modelled)
    return Beside(float(depth[worst]), (x, y), share * len(outside), share * len(places))
