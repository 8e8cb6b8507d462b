# SPDX-License-Identifier: Apache-2.0
"""Draws the dies of the packaged examples in space that no profile describes, and writes them as STL.

Run in the folder of the project: python -m examples.forging_dies [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from presswork.model import FloatArray
from validation.closed_dies_in_space import SPACING, join_points, round_off, write_stl

ROD = 36.0
"""From eye to eye [mm]."""
FLASH = 0.9
"""Half the thickness of the rod's flash [mm]."""
LAND = 3.0


def draw_rod(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the height of the die of a connecting rod over its parting plane [mm]."""
    around = _smooth_least(np.hypot(x, y) - 10.0, np.hypot(x - ROD, y) - 6.5, 3.0)
    shank = np.maximum(np.abs(y) - 4.5, np.maximum(-x, x - ROD))
    around = _smooth_least(around, shank, 3.0)
    height = np.minimum(FLASH + np.maximum(-around, 0.0) / np.tan(np.radians(8.0)), 5.0)
    eye = np.hypot(x, y) - 4.0
    pocket = np.hypot(x - np.clip(x, 14.5, 25.5), y) - 1.2
    for outline, web in ((eye, 1.6), (pocket, 2.2)):
        height = np.minimum(height, web + np.maximum(outline, 0.0) / np.tan(np.radians(15.0)))
    gutter = FLASH + np.clip((around - LAND) / 1.0, 0.0, 1.5)
    return round_off(np.where(around > LAND, gutter, height), 1.2, 1.2)


def _smooth_least(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    """Return the lesser of two distances, blended over a width."""
    part = np.maximum(width - np.abs(a - b), 0.0) / width
    return np.minimum(a, b) - 0.25 * width * part**2


def main() -> None:
    """Write the files."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "src/presswork/examples")
    along, across = SPACING * np.arange(-60, 190), SPACING * np.arange(-20, 63)
    height = draw_rod(*np.meshgrid(along, across, indexing="ij"))
    half = across >= 0.0
    points, triangles = join_points(along[::2], across[half][::2], height[::2, half][:, ::2])
    write_stl(folder / "connecting_rod_die.stl", points, triangles)


if __name__ == "__main__":
    main()
