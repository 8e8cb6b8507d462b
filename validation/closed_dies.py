# SPDX-License-Identifier: Apache-2.0
"""Closed dies drawn at random, forged hands off: how many are filled, and why the others are not.

A die has one to three zones (hubs, ribs, webs) between the axis and its outer flank, drafts of 3 to 12 degrees, radii
of 1 to 4 mm, and a flash land with a gutter; the billet is a cylinder or a bar with the volume of the cavity and of the
flash.

Run: python -m validation.closed_dies [--first 0] [--count 100] [--folder runs]
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from presswork import Case, build_model
from presswork.model import FloatArray
from presswork.post import measure_die_fill
from presswork.recorder import run_model
from presswork.results import Result

FILLED = 0.98
"""Part of the cavity's wall from which on a die counts as filled."""
STEEL = {
    "young": "206 kN/mm^2",
    "poisson": 0.3,
    "hardening": {"law": "swift", "K": 700, "e0": 0.015, "n": 0.2},
}


@dataclass(frozen=True)
class ClosedDie:
    """The upper half of a die and its billet; x is the radius or half the width."""

    analysis: str
    profile: list[Any]
    """Corners and fillets at the end of the stroke."""
    outer: float
    """x up to which the cavity reaches [mm]."""
    flash: float
    """Half the thickness of the flash at the end [mm]."""
    billet: tuple[float, float]
    """Radius and half height [mm]."""
    shear: float
    """Friction factor."""


def draw_die(seed: int) -> ClosedDie:
    """Return the die of a seed."""
    rng = np.random.default_rng(seed)
    analysis = "axisymmetric" if rng.random() < 0.7 else "plane_strain"
    n_zones = int(rng.integers(1, 4))
    web, flash = float(rng.uniform(3.0, 5.5)), float(rng.uniform(0.6, 1.2))
    high = bool(rng.random() < 0.5)
    heights, x, corners = [], 0.0, []
    for _ in range(n_zones):
        heights.append(float(rng.uniform(1.5, 2.6) * web) if high else web)
        high = not high
    corners.append((0.0, heights[0], 0.0))
    for zone, height in enumerate(heights):
        after = heights[zone + 1] if zone + 1 < n_zones else flash
        draft = np.radians(rng.uniform(3.0, 12.0))
        x += float(rng.uniform(5.0, 9.0)) + (float(rng.uniform(0.0, 4.0)) if height == web else 0.0)
        width = abs(after - height) * np.tan(draft)
        first, last = (x, x + width)
        most = 0.42 * abs(after - height) / np.cos(draft)
        radii = [float(min(rng.uniform(1.0, 4.0), most)) for _ in range(2)]
        room = 0.5 * abs(after - height) / np.cos(draft) / np.tan(0.5 * (0.5 * np.pi - draft))
        corners += [
            (at, y, min(max(r, 1.0), 0.999 * room))
            for at, y, r in zip((first, last), (height, after), radii, strict=True)
        ]
        x = last
    land = float(rng.uniform(4.0, 6.0))
    corners += [(x + land, flash, 1.0), (x + land + 3.0, flash + 2.0, 0.0), (3.0 * x + 60.0, flash + 2.0, 0.0)]
    profile = [[a, b] if radius == 0.0 else {"to": [a, b], "radius": radius} for a, b, radius in corners]
    billet = choose_billet(rng, np.array([c[:2] for c in corners]), x, land, analysis == "axisymmetric")
    return ClosedDie(analysis, profile, x, flash, billet, float(rng.uniform(0.05, 0.25)))


def choose_billet(
    rng: np.random.Generator, corners: FloatArray, outer: float, land: float, ring: bool
) -> tuple[float, float]:
    """Return radius and half height of a billet that fills the cavity, the land and a part of the gutter."""
    wall = np.linspace(0.0, outer + land + 3.0, 4000)
    height = np.interp(wall, *corners.T)
    weight = 2.0 * np.pi * wall if ring else np.ones_like(wall)
    volume = 1.01 * float(np.trapezoid(height * weight, wall))
    radius = float(rng.uniform(0.55, 0.85)) * outer
    area = np.pi * radius**2 if ring else radius
    while volume / area > 2.2 * radius:
        radius *= 1.05
        area = np.pi * radius**2 if ring else radius
    return radius, volume / area


def make_case(die: ClosedDie, **changes: Any) -> Case:
    """Return the job: the die comes down from where it touches the billet."""
    radius, height = die.billet
    cells = max(12, round(20 * radius / max(radius, height)))
    edge = radius / cells
    tool = {"profile": die.profile, "contact": "shear", "m": die.shear, "position": "touch", "free_side": "right"}
    case = {
        "title": "a closed die drawn at random",
        "analysis": die.analysis,
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"size": [radius, height], "cells": [cells, max(4, round(height / edge))]},
        },
        "materials": {"steel": STEEL},
        "tools": {"die": tool},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "parting_plane": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "forge", "tools": {"die": {"stroke": 0.1 * height, "direction": [0, -1]}}}],
        "solver": {"max_increment": 0.01},
        "output": {"steps": 10},
        "remesh": {},
    }
    tool["profile"] = lift(die.profile, height)
    way = height + build_model(Case(**case)).plane_tools[0].position[1]
    tool |= {"profile": die.profile, "position": [0.0, way]}
    case["stages"][0]["tools"]["die"]["stroke"] = way
    return Case(**(case | changes))


def lift(profile: list[Any], way: float) -> list[Any]:
    """Return a profile moved upwards."""
    return [{**p, "to": [p["to"][0], p["to"][1] + way]} if isinstance(p, dict) else [p[0], p[1] + way] for p in profile]


@dataclass(frozen=True)
class Outcome:
    """What became of one die."""

    seed: int
    status: str
    filled: float
    remeshes: int
    cells: int
    volume: float
    """Change without the elastic part, of the first."""
    energy: float
    """Error [per cent]."""
    seconds: float
    reason: str


def forge(seed: int, folder: Path) -> Outcome:
    """Run one die to the end of its stroke."""
    die = draw_die(seed)
    started = time.perf_counter()
    done = run_model(build_model(make_case(die)), folder, threads=1, overwrite=True)
    seconds = time.perf_counter() - started
    result = Result(folder)
    filled = measure_die_fill(result, "die", x_range=(0.0, die.outer - 0.5)).filled
    summary = result.summary
    volume = summary["volume"]
    change = (volume["change_percent"] - volume["elastic_part_percent"]) / 100
    cells = len(result.mesh_at(-1).blocks[0].connectivity)
    energy = summary["energy"]["error_percent"]
    return Outcome(seed, done.status, filled, summary["remeshes"], cells, change, energy, seconds, done.reason)


def main() -> None:
    """Forge and print a line for each die."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    if arguments.folder:
        arguments.folder.mkdir(parents=True, exist_ok=True)
    print("seed status filled remeshes cells volume energy seconds", flush=True)
    n_filled = 0
    with TemporaryDirectory() as temporary:
        for seed in range(arguments.first, arguments.first + arguments.count):
            found = forge(seed, (arguments.folder or Path(temporary)) / f"die_{seed}")
            n_filled += found.filled >= FILLED
            print(
                f"{seed} {found.status} {found.filled:.3f} {found.remeshes} {found.cells} {found.volume:+.1e} "
                f"{found.energy:+.2f} {found.seconds:.1f} {found.reason}",
                flush=True,
            )
    print(f"{n_filled} of {arguments.count} are filled")


if __name__ == "__main__":
    main()
