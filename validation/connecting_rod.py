# SPDX-License-Identifier: Apache-2.0
"""A small connecting rod forged with flash, hands off: a die of facets, an upper half cut in two.

With cells of 0.8 to 1.8 mm and a stroke of 4.9 mm, 98.2 % of the wall are filled, the flash is 2.2 mm thick, and ten
new meshes lead to 9,900 cells. A stroke of 5.1 mm gives up at 4.92 mm.

Run: python -m validation.connecting_rod [--folder runs/rod] [--stroke 4.9]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from presswork import build_model
from presswork.case.space.schema import SpaceCase
from presswork.model import FloatArray
from presswork.recorder import run_model
from validation.closed_dies_in_space import SPACING, join_points, round_off, write_stl

ROD = 36.0
"""From eye to eye [mm]."""
FLASH, LAND = 0.9, 3.0
"""Half the thickness of the flash after 5.1 mm, and the width of its land [mm]."""
PREFORM = [[-9, 3.5], [-6, 6.3], [6, 6.3], [10, 4.2], [14, 3.1], [27, 3.1], [30, 4.2], [33, 5], [38, 5], [41, 3]]
"""Its outline on one side [mm]."""


def draw_rod(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the height of the die over its parting plane [mm]."""
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


def make_case(folder: Path, stroke: float) -> SpaceCase:
    """Write the die and return the job."""
    folder.mkdir(parents=True, exist_ok=True)
    along, across = SPACING * np.arange(-60, 190), SPACING * np.arange(-20, 63)
    half = across >= 0.0
    height = draw_rod(*np.meshgrid(along, across, indexing="ij"))[::2, half][:, ::2]
    write_stl(folder / "die.stl", *join_points(along[::2], across[half][::2], height))
    outline = [[x, -y] for x, y in PREFORM] + PREFORM[::-1]
    preform = {
        "kind": "extruded",
        "outline": outline,
        "symmetry": ["y"],
        "element_size": 1.8,
        "height": 6.7,
        "cells": 4,
    }
    die = {"shape": "file", "path": str(folder / "die.stl"), "position": [0.0, 0.0, 5.1], "contact": "shear", "m": 0.3}
    return SpaceCase(
        title="Forging of a connecting rod with flash",
        analysis="solid",
        workpiece={"material": "steel", "element": "tet4_mini", "mesh": preform},
        materials={  # about 1100 degrees Celsius
            "steel": {
                "young": "100 GPa",
                "poisson": 0.35,
                "hardening": {"law": "swift", "K": 110, "e0": 0.01, "n": 0.12},
            }
        },
        tools={"die": die},
        boundary={"middle": {"set": "bottom", "fix": ["y"]}, "parting_plane": {"set": "back", "fix": ["z"]}},
        stages=[{"name": "forge", "tools": {"die": {"stroke": stroke, "direction": [0, 0, -1]}}}],
        remesh={"size": 1.8, "smallest_size": 0.8, "max_cells": 12_000},
        output={"steps": 8},
    )


def main() -> None:
    """Forge it, and print what became of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("runs/rod"))
    parser.add_argument("--stroke", type=float, default=5.1, help="[mm]")
    arguments = parser.parse_args()
    done = run_model(
        build_model(make_case(arguments.folder, arguments.stroke)), arguments.folder / "run", overwrite=True
    )
    print(done.status, done.reason, done.result.summary.get("die_fill"))


if __name__ == "__main__":
    main()
