# SPDX-License-Identifier: Apache-2.0
"""Closed dies in space drawn at random, forged hands off: how many are filled, and why the others are not.

A die is a surface of facets (STL). Its cavity joins a web of rounded rectangular outline with one to three ribs and
bosses, drafts of 7 to 15 degrees, edges and fillets of 0.6 to 2 mm, a flash land and a gutter; every third die has
sharp edges. The billet is a box with the volume of the cavity and of the flash. An eighth is modelled.

A die is filled where its stroke is complete and FILLED of the cavity's wall has metal within OPEN. No finite pressure
fills an inner edge without a radius, so the wall is taken twice: as it is drawn, and with fillets of the smallest
cell's edge at inner edges (rounded dies have larger ones from the start). A die that is full where its run gave up is
counted apart.

Run: python -m validation.closed_dies_in_space [--first 0] [--count 30] [--folder runs]
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy import ndimage

from presswork import build_model
from presswork.case.space.schema import SpaceCase
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, IntArray, Triangulation
from presswork.recorder import run_model
from presswork.remesh.space.tetrahedra import find_skin
from presswork.results import Result
from validation.closed_dies import FILLED, STEEL

OPEN = 0.1
"""Gap between wall and metal that counts as filled, as in post.measure_die_fill [mm]."""
SPACING = 0.25
"""Of the points of a die [mm]."""
SMALLEST = 0.6
"""Edge of cells [mm]."""


@dataclass(frozen=True)
class SpaceDie:
    """An eighth of a die and its billet."""

    line: FloatArray
    """x and y of the points of the die (n,) [mm]; those below zero are the mirror image of others."""
    height: FloatArray
    """z of the die over x and y at the end of the stroke (n, n) [mm]."""
    outline: FloatArray
    """Half length and half width of the cavity at the land (2,) [mm]."""
    corner: float
    """Radius of that outline's corners [mm]."""
    flash: float
    """Half the thickness of the flash at the end [mm]."""
    billet: tuple[float, float, float]
    """Half of its extents [mm]."""
    shear: float
    """Friction factor."""


def draw_die(seed: int) -> SpaceDie:
    """Return the die of a seed."""
    rng = np.random.default_rng(seed)
    half = np.array([rng.uniform(8.0, 12.0), rng.uniform(6.0, 9.0)])
    corner = float(rng.uniform(2.0, 4.0))
    web, flash, land = (float(rng.uniform(*span)) for span in ((2.5, 4.0), (0.7, 1.1), (2.5, 3.5)))
    reach = float(half.max()) + land + 8.0
    line = SPACING * np.arange(-2, int(reach / SPACING))
    x, y = np.meshgrid(np.abs(line), np.abs(line), indexing="ij")
    draft = lambda: float(np.tan(np.radians(rng.uniform(7.0, 15.0))))  # noqa: E731
    around = measure_box(x, y, half, corner)
    height = np.minimum(flash + np.maximum(-around, 0.0) / draft(), web)
    for _ in range(int(rng.integers(1, 4))):
        height = np.maximum(height, np.minimum(draw_feature(rng, x, y, half, web, around), -around / draft() + flash))
    gutter = np.clip((around - land) / 1.0, 0.0, 1.2)
    height = np.where(around > land, flash + gutter, height)
    if seed % 3:
        height = round_off(height, float(rng.uniform(0.7, 1.5)), float(rng.uniform(0.8, 2.0)))
    billet = choose_billet(rng, line, height, around, half, land)
    return SpaceDie(line, height, half, corner, flash, billet, float(rng.uniform(0.05, 0.25)))


def measure_box(x: FloatArray, y: FloatArray, half: FloatArray, corner: float) -> FloatArray:
    """Return the distance of places from a rounded rectangle, negative inside [mm]."""
    over = np.stack([x - half[0] + corner, y - half[1] + corner])
    return np.asarray(np.linalg.norm(np.maximum(over, 0.0), axis=0) + np.minimum(over.max(axis=0), 0.0) - corner)


def draw_feature(
    rng: np.random.Generator, x: FloatArray, y: FloatArray, half: FloatArray, web: float, around: FloatArray
) -> FloatArray:
    """Return the height of a rib or a boss over places [mm]."""
    kind = rng.choice(["boss", "rib along x", "rib along y", "rim"])
    top = web * float(rng.uniform(1.4, 2.0))
    slope = float(np.tan(np.radians(rng.uniform(7.0, 15.0))))
    width = float(rng.uniform(1.8, 3.0))
    if kind == "boss":
        middle = np.where(rng.random(2) < 0.5, 0.0, 0.5 * half)
        away = np.hypot(x - middle[0], y - middle[1]) - width - 0.5
    elif kind == "rib along x":
        away = y - width
    elif kind == "rib along y":
        away = x - width
    else:
        away = np.abs(around + 0.6 + width) - 0.5 * width
    return np.asarray(np.minimum(top, top - away / slope))


def round_off(height: FloatArray, edge: float, fillet: float) -> FloatArray:
    """Return a die with its edges, then its fillets rounded by a ball rolled along it, radii in mm."""
    for radius, roll in ((edge, ndimage.grey_closing), (fillet, ndimage.grey_opening)):
        n = int(radius / SPACING)
        a, b = np.meshgrid(*2 * [SPACING * np.arange(-n, n + 1)], indexing="ij")
        inside = radius**2 - a**2 - b**2
        ball = np.sqrt(np.maximum(inside, 0.0)) - radius
        height = roll(height, footprint=inside >= 0.0, structure=ball, mode="nearest")
    return height


def choose_billet(
    rng: np.random.Generator, line: FloatArray, height: FloatArray, around: FloatArray, half: FloatArray, land: float
) -> tuple[float, float, float]:
    """Return half the extents of a billet that fills the cavity, the land and a part of the gutter."""
    own = (line[:, None] > -1e-9) & (line[None] > -1e-9) & (around < land + 0.5)
    weight = np.where(np.abs(line) < 1e-9, 0.5, 1.0)
    volume = 1.01 * float((height * own * weight[:, None] * weight[None]).sum() * SPACING**2)
    share = float(rng.uniform(0.72, 0.85))
    while volume / (share**2 * half.prod()) > 1.6 * share * half.min():
        share *= 1.03
    a, b = share * half
    return float(a), float(b), volume / float(a * b)


def join_points(x: FloatArray, y: FloatArray, height: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return points and facets of a die of a height over x and y, its normals downwards, out of its metal."""
    n = len(y)
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), height], axis=-1).reshape(-1, 3)
    first = (np.arange(len(x) - 1)[:, None] * n + np.arange(n - 1)).ravel()
    a, b, c, d = first, first + n, first + n + 1, first + 1
    # the diagonal that bends less follows the die
    straight = np.abs(points[a, 2] - points[c, 2]) <= np.abs(points[b, 2] - points[d, 2])
    one = np.where(straight[:, None], np.column_stack([a, c, b]), np.column_stack([a, d, b]))
    two = np.where(straight[:, None], np.column_stack([a, d, c]), np.column_stack([b, d, c]))
    return points, np.concatenate([one, two]).astype(np.int32)


def write_stl(path: Path, points: FloatArray, triangles: IntArray) -> None:
    """Write facets as a binary STL file."""
    facets = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("tag", "<u2")])
    facets["corners"] = points[triangles]
    path.write_bytes(bytes(80) + np.uint32(len(facets)).tobytes() + facets.tobytes())


def make_case(die: SpaceDie, folder: Path, **changes: Any) -> SpaceCase:
    """Return the job: the die comes down from where it touches the billet."""
    folder.mkdir(parents=True, exist_ok=True)
    write_stl(folder / "die.stl", *join_points(die.line, die.line, die.height))
    edge = 0.16 * float(np.cbrt(np.prod(die.billet)) + die.billet[2])
    cells = [max(3, round(extent / edge)) for extent in die.billet]
    case: dict[str, Any] = {
        "title": "a closed die in space drawn at random",
        "analysis": "solid",
        "workpiece": {
            "material": "steel",
            "element": "tet4_mini",
            "mesh": {"kind": "box", "size": die.billet, "cells": cells},
        },
        "materials": {"steel": STEEL},
        "tools": {
            "die": {
                "shape": "file",
                "path": str(folder / "die.stl"),
                "contact": "shear",
                "m": die.shear,
                "position": "touch",
            }
        },
        "boundary": {
            "middle_x": {"set": "left", "fix": ["x"]},
            "middle_y": {"set": "bottom", "fix": ["y"]},
            "parting_plane": {"set": "back", "fix": ["z"]},
        },
        "stages": [{"name": "forge", "tools": {"die": {"stroke": 1.0, "direction": [0, 0, -1]}}}],
        "output": {"steps": 8},
        "remesh": {"size": 1.5, "smallest_size": SMALLEST, "max_cells": 8000},
    }
    way = float(build_model(SpaceCase(**case)).space_tools[0].position[2])
    case["tools"]["die"]["position"] = [0.0, 0.0, way]
    case["stages"][0]["tools"]["die"]["stroke"] = way
    return SpaceCase(**(case | changes))


@dataclass(frozen=True)
class Outcome:
    """What became of one die."""

    seed: int
    status: str
    drawn: float
    """Part of the wall that is filled, as it is drawn."""
    filled: float
    """The same with fillets at inner edges."""
    remeshes: int
    cells: int
    volume: float
    """Change without the elastic part, of the first."""
    energy: float
    """Error [per cent]."""
    seconds: float
    reason: str


def measure_fill(die: SpaceDie, result: Result) -> tuple[float, float]:
    """Return the part of the cavity's wall that metal has reached, as it is drawn and with fillets at inner edges."""
    faces, _ = find_skin(result.mesh_at(-1).blocks[0].connectivity.astype(np.intp))
    skin = make_surface(Triangulation(result.points(-1), faces.astype(np.int32), True))
    moved = float(result.placed_surface("die")[:, 2].max() - die.height.max())
    found = []
    for height in (die.height, round_off(die.height, 0.0, SMALLEST)):
        points, triangles = join_points(die.line, die.line, height + moved)
        corners = points[triangles]
        middle = corners.mean(axis=1)
        area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        inside = (measure_box(*middle[:, :2].T, die.outline, die.corner) < -0.5) & (middle[:, :2] > 0.0).all(axis=1)
        gap, own = skin.nearest(middle[inside])[0], area[inside]  # negative where an edge of cells cuts the die
        found.append(float(own[gap < OPEN].sum() / own.sum()))
    return found[0], found[1]


def forge(seed: int, folder: Path) -> Outcome:
    """Run one die to the end of its stroke."""
    die = draw_die(seed)
    started = time.perf_counter()
    done = run_model(build_model(make_case(die, folder)), folder / "run", threads=1, overwrite=True)
    seconds = time.perf_counter() - started
    result = Result(folder / "run")
    summary = result.summary
    volume = summary["volume"]
    change = (volume["change_percent"] - volume["elastic_part_percent"]) / 100
    cells = len(result.mesh_at(-1).blocks[0].connectivity)
    energy = summary["energy"]["error_percent"]
    return Outcome(
        seed, done.status, *measure_fill(die, result), summary["remeshes"], cells, change, energy, seconds, done.reason
    )


def main() -> None:
    """Forge and print a line for each die."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    print("seed status drawn filled remeshes cells volume energy seconds", flush=True)
    all_found = []
    with TemporaryDirectory() as temporary:
        for seed in range(arguments.first, arguments.first + arguments.count):
            found = forge(seed, (arguments.folder or Path(temporary)) / f"die_{seed}")
            all_found.append(found)
            print(
                f"{seed} {found.status} {found.drawn:.3f} {found.filled:.3f} {found.remeshes} {found.cells} "
                f"{found.volume:+.1e} {found.energy:+.2f} {found.seconds:.1f} {found.reason}",
                flush=True,
            )
    done = [found for found in all_found if found.status == "completed"]
    full_early = sum(found.filled >= FILLED for found in all_found) - sum(found.filled >= FILLED for found in done)
    print(
        f"{sum(found.filled >= FILLED for found in done)} of {arguments.count} are filled at the end of their stroke, "
        f"{sum(found.drawn >= FILLED for found in done)} as they are drawn; {full_early} more are full and gave up"
    )


if __name__ == "__main__":
    main()
