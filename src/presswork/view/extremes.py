# SPDX-License-Identifier: Apache-2.0
"""The smallest and the largest value of a field in a picture, and where they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def find_extremes(values: FloatArray) -> tuple[int, int] | None:
    """Return the places in `values` (n,) of the smallest and the largest finite value; None if there is none."""
    finite = np.flatnonzero(np.isfinite(values))
    if not len(finite):
        return None
    return int(finite[values[finite].argmin()]), int(finite[values[finite].argmax()])


def describe_extremes(values: FloatArray, places: FloatArray) -> str:
    """Return a line with the extremes of `values` (n,) and their `places` (n, 2 or 3) [mm], or nothing."""
    found = find_extremes(values)
    if found is None:
        return ""
    digits = ".0f" if places.shape[1] == 3 else ".3g"
    low, high = (", ".join(format(coordinate, digits) for coordinate in places[at] + 0.0) for at in found)
    return f"max {shorten(values[found[1]])} at ({high}) mm, min {shorten(values[found[0]])} at ({low}) mm"


def shorten(value: float) -> str:
    """Return a number in three digits, and not fewer than its whole part has.

    >>> shorten(3.16812), shorten(0.0079271), shorten(1268.4)
    ('3.17', '0.00793', '1268')
    """
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.3g}"


def mark_extremes(ax: Axes, values: FloatArray, places: FloatArray) -> None:
    """Mark the smallest value by a triangle that points down and the largest by one that points up."""
    found = find_extremes(values)
    if found is None or values[found[0]] == values[found[1]]:
        return
    for at, marker in zip(found, "v^", strict=True):
        x, y = places[at]
        ax.scatter([x], [y], s=36, marker=marker, c="white", edgecolors="0.1", zorder=5, clip_on=False)
