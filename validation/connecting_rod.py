# SPDX-License-Identifier: Apache-2.0
"""The die and the preform of the example connecting_rod: an upper half, cut in two along its middle plane.

A big and a small eye with recesses are joined by a shank with a web. The draft is 12 degrees, edges and fillets are
rounded by 1.5 mm. The preform has as much metal in each cross-section as the die, its flash land half filled, and a
tenth more.

Run: python -m validation.connecting_rod [--folder src/presswork/examples]
writes connecting_rod_die.stl there and prints the outline of the preform.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from presswork.mesh.files.stl_file import pack_stl
from presswork.model import FloatArray, Triangulation
from validation.closed_dies_in_space import SPACING, join_points, round_off

ROD, BIG, SMALL, SHANK = 40.0, 11.0, 7.5, 5.0
"""Eye to eye; radii of the ends; half the width of the shank [mm]."""
TOP, WEB, FLASH, LAND = 4.5, 2.6, 0.9, 3.0
"""Heights of the die over the parting plane after the stroke: at most, over the webs, over the flash; the land's width
[mm]."""
EYE, POCKET, BLEND, RADIUS = 4.5, 2.0, 4.0, 1.5
"""Radius of the eye's recess, half the width of the shank's, blend of the outlines, radii of edges and fillets [mm]."""
DRAFT, SLOPE = np.radians(12.0), np.radians(30.0)
"""Of the outer wall; of the recesses."""
HEIGHT, SURPLUS, NARROWEST = 5.6, 1.1, 2.5
"""Of the preform: half its height [mm], its metal over what is needed, half its width at least [mm]."""
STATIONS = (-8.5, -6, -3, 0, 3, 6, 9, 12, 15, 20, 25, 29, 32, 35, 38, 40, 42.5, 45.5)
"""Places along the rod where the preform has a corner [mm]."""
EVERY = 3
"""Of the points of the drawn die, those that the file has."""


def measure_outline(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the distance of places from the outline of the rod, negative inside [mm]."""
    ends = _smooth_least(np.hypot(x, y) - BIG, np.hypot(x - ROD, y) - SMALL)
    return _smooth_least(ends, np.maximum(np.abs(y) - SHANK, np.maximum(-x, x - ROD)))


def _smooth_least(a: FloatArray, b: FloatArray) -> FloatArray:
    part = np.maximum(BLEND - np.abs(a - b), 0.0) / BLEND
    return np.minimum(a, b) - 0.25 * BLEND * part**2


def draw_die(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the height of the die over its parting plane on a lattice of SPACING [mm]."""
    around = measure_outline(x, y)
    height = np.minimum(FLASH + np.maximum(-around, 0.0) / np.tan(DRAFT), TOP)
    eye = np.hypot(x, y) - EYE
    pocket = np.hypot(x - np.clip(x, BIG + 5.0, ROD - SMALL - 4.0), y) - POCKET
    for outline in (eye, pocket):
        height = np.minimum(height, WEB + np.maximum(outline, 0.0) / np.tan(SLOPE))
    gutter = FLASH + np.clip(around - LAND, 0.0, 1.5)
    return round_off(np.where(around > LAND, gutter, height), RADIUS, RADIUS)


def draw_preform(along: FloatArray, across: FloatArray, height: FloatArray, inside: FloatArray) -> list[list[float]]:
    """Return one side of the preform's outline [mm].

    height: of the die over along (n,) and across (m,), from 0 on; inside: which places lie within the outline (n, m).
    """
    share = np.where(across == 0.0, 0.5, 1.0)
    area = (height * inside * share).sum(axis=1) * SPACING
    half = SURPLUS * (area + 0.5 * FLASH * LAND * (area > 0.0)) / HEIGHT
    widths = np.maximum(np.interp(STATIONS, along, half), NARROWEST)
    return [[float(x), round(float(y), 2)] for x, y in zip(STATIONS, widths, strict=True)]


def draw_files(folder: Path) -> list[list[float]]:
    """Write connecting_rod_die.stl into a folder; return one side of the preform's outline [mm]."""
    folder.mkdir(parents=True, exist_ok=True)
    along, across = SPACING * np.arange(-72, 216), SPACING * np.arange(-24, 72)
    places = np.meshgrid(along, across, indexing="ij")
    height, half = draw_die(*places), across >= 0.0
    x, y = np.abs(along - 18.0) <= 34.5, half & (across <= 16.5)
    kept = height[x][::EVERY][:, y][:, ::EVERY]
    face = Triangulation(*join_points(along[x][::EVERY], across[y][::EVERY], kept), is_closed=False)
    (folder / "connecting_rod_die.stl").write_bytes(pack_stl("die", face))
    inside = measure_outline(*places) < 0.0
    return draw_preform(along, across[half], height[:, half], inside[:, half])


def main() -> None:
    """Write the die and print the preform."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("src/presswork/examples"))
    print(draw_files(parser.parse_args().folder))


if __name__ == "__main__":
    main()
