# SPDX-License-Identifier: Apache-2.0
"""Divides the mesh of a blank into its zones, and gives its cells thickness, material and rolling direction."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import cos, radians, sin
from pathlib import Path

import numpy as np

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.stamping.blank import Blank, BlankFile
from presswork.case.stamping.plan_line import draw_line
from presswork.case.zones.schema import BlankZone, ZonedPart
from presswork.geometry.polygon import contains, list_sides, measure_distance
from presswork.mesh import MeshError
from presswork.mesh.cut import divide_mesh
from presswork.mesh.make.blanks import name_sets
from presswork.mesh.relax import find_sines, relax_mesh
from presswork.mesh.topology import find_boundary_edges
from presswork.model import BoolArray, FloatArray, IntArray

logger = logging.getLogger(__name__)

ON_LINE = 1e-6
"""Distance from a weld line over the blank's size within which nodes lie on it."""
SHARPEST = float(np.sin(np.radians(9.0)))
"""Sine of the sharpest corner of a cell that a weld line may leave."""
BEYOND = 1e-6
"""How far a rolled blank may reach beyond its table, over its size."""


@dataclass(frozen=True)
class Region:
    """The part of the plan that a zone takes."""

    key: str
    polygon: FloatArray
    """Corners of its line in turn (m, 2) [mm]."""
    is_inside: bool
    weld: FloatArray
    """What of its line may be a weld, as sides (n, 2, 2) [mm]: a half plane ends nowhere else."""

    def holds(self, places: FloatArray) -> BoolArray:
        """Return which places (n, 2) lie in it."""
        return np.asarray(contains(list_sides(self.polygon), places) == self.is_inside)


def draw_regions(
    blank: ZonedPart, folder: Path, size: float, part: str = "blank"
) -> tuple[list[Region | None], list[Problem]]:
    """Return the regions of a blank's zones, None of those that are sets of a mesh file.

    size: of the blank [mm]; part: its table in the case.
    """
    found: list[Region | None] = []
    problems = []
    for index, zone in enumerate(blank.zones):
        key = f"{part}.zones.{index}"
        if zone.line is not None:
            found.append(_draw_half_plane(f"{key}.line", zone, size))
        elif zone.set is not None:
            found.append(None)
        else:
            side = "outside" if zone.inside is None else "inside"
            line = zone.inside or zone.outside
            assert line is not None
            polygon = draw_line(line, f"{key}.{side}", folder)
            if isinstance(polygon, Problem):
                problems.append(polygon)
            else:
                found.append(Region(f"{key}.{side}", polygon, side == "inside", list_sides(polygon)))
    return found, problems


def _draw_half_plane(key: str, zone: BlankZone, size: float) -> Region:
    """Return the half plane on a side of a line, as far as the blank may reach."""
    assert zone.line is not None
    start, end = np.array(zone.line)
    along = (end - start) / np.linalg.norm(end - start)
    far = 4.0 * size + float(np.abs(zone.line).max())
    across = far * np.array([-along[1], along[0]]) * (1.0 if zone.side == "left" else -1.0)
    middle = start - (start @ along) * along  # of the line, nearest to the origin
    first, last = middle - far * along, middle + far * along
    return Region(key, np.array([first, last, last + across, first + across]), True, np.array([[first, last]]))


def find_weld_lines(blank: Blank) -> tuple[list[float], list[float]]:
    """Return x and y of weld lines along y and x, at which the grid of a rectangular blank has lines."""
    at: tuple[list[float], list[float]] = ([], [])
    for zone in blank.zones:
        if zone.line is not None:
            for axis in (0, 1):
                if zone.line[0][axis] == zone.line[1][axis]:
                    at[axis].append(zone.line[0][axis])
    return at


def divide_blank(mesh: model.Mesh, regions: Sequence[Region | None], symmetry: Sequence[bool]) -> model.Mesh:
    """Return a blank's mesh with nodes on its weld lines, as far as they cross it and leave cells of a good shape."""
    for region in filter(None, regions):
        done = [other for other in regions[: regions.index(region) + 1] if other is not None]
        for with_corners in (True, False):
            divided = _divide(mesh, region, done, symmetry, with_corners)
            if divided is not None:
                mesh = divided
                break
    return mesh


def _divide(
    mesh: model.Mesh, region: Region, done: Sequence[Region], symmetry: Sequence[bool], with_corners: bool
) -> model.Mesh | None:
    """Return a mesh with nodes on the line of a region, evened out round all that are done; None where that fails.

    with_corners: with a node on each of its corners.
    """
    cells = tuple(block.connectivity for block in mesh.blocks)
    plan = np.column_stack([mesh.points[:, :2], np.zeros(len(mesh.points))])
    try:
        points, kinds = divide_mesh(plan, cells, region.polygon, with_corners=with_corners)
    except MeshError:  # the line does not cross the blank, which lay_zones reports
        return None
    if not _has_no_gap(kinds):
        return None
    used = np.unique(np.concatenate([each.ravel() for each in kinds]))
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    plan, kinds = points[used, :2], [number[each] for each in kinds]
    if len(plan) == len(mesh.points) and (plan == mesh.points[:, :2]).all():
        return mesh
    made = name_sets(plan, kinds, symmetry, False)
    kinds = [block.connectivity for block in made.blocks]
    plan = relax_mesh(made.points[:, :2], kinds, *_find_welds(made, done))
    if min(float(find_sines(plan, each).min()) for each in kinds) < SHARPEST:
        return None
    return name_sets(plan, kinds, symmetry, False)


def _has_no_gap(kinds: Sequence[IntArray]) -> bool:
    """Return whether cells share whole edges: their boundary then goes into each of its nodes once, and out of it."""
    ends = find_boundary_edges(list(kinds))[:, :2]
    return bool((np.bincount(ends.ravel())[np.unique(ends)] == 2).all())


def _find_welds(mesh: model.Mesh, regions: Sequence[Region | None]) -> tuple[BoolArray, FloatArray]:
    """Return which nodes lie on weld lines (n,), and the direction of straight ones at nodes of one (n, 2), else 0."""
    plan, n_lines = mesh.points[:, :2], np.zeros(len(mesh.points), dtype=int)
    along = np.zeros_like(plan)
    near = ON_LINE * float(np.ptp(plan, axis=0).max())
    for region in filter(None, regions):
        on = measure_distance(region.weld, plan) <= near
        n_lines += on
        if len(region.weld) == 1:
            start, end = region.weld[0]
            along[on] = (end - start) / np.linalg.norm(end - start)
        else:
            n_lines += on
    along[n_lines != 1] = 0.0
    return n_lines > 0, along


def lay_zones(
    mesh: model.Mesh,
    blank: ZonedPart,
    regions: Sequence[Region | None],
    materials: Mapping[int, int],
    part: str = "blank",
) -> tuple[model.Mesh, list[Problem]]:
    """Return the mesh with the cells of its zones in blocks of their own, and the problems of zones.

    materials: of each zone by its number, the remaining blank being 0, as indices of the Model's. part: the blank's
    table in the case.
    """
    middles = [mesh.points[block.connectivity].mean(axis=1)[:, :2] for block in mesh.blocks]
    of_cells, problems = _choose_zones(mesh, middles, blank, regions, part)
    if problems:
        return mesh, problems
    blocks = []
    for number in range(len(blank.zones) + 1):
        zone = blank.zones[number - 1] if number else None
        for block, middle, own in zip(mesh.blocks, middles, of_cells, strict=True):
            cells = np.flatnonzero(own == number).astype(np.int32)
            if not len(cells):
                continue
            thickness, table = blank.mean_thickness, None
            if zone is not None and zone.thickness is not None:
                thickness = zone.thickness
            else:
                table = blank.find_thickness(middle[cells])
            assert block.section is not None
            blocks.append(
                replace(
                    block,
                    connectivity=block.connectivity[cells],
                    material=materials[number],
                    section=replace(block.section, thickness=thickness),
                    zone=number,
                    rolling=None if zone is None else _find_rolling(zone),
                    own_thickness=table,
                )
            )
    return replace(mesh, blocks=tuple(blocks)), []


def _find_rolling(zone: BlankZone) -> tuple[float, float, float] | None:
    if zone.rolling_direction is None:
        return None
    angle = radians(zone.rolling_direction)
    return cos(angle), sin(angle), 0.0


def _choose_zones(
    mesh: model.Mesh, middles: Sequence[FloatArray], blank: ZonedPart, regions: Sequence[Region | None], part: str
) -> tuple[list[IntArray], list[Problem]]:
    """Return the zone of each cell of the blocks (n_cells,), 0 beside all of them, and the problems of zones."""
    found, problems = [np.zeros(len(middle), dtype=np.int32) for middle in middles], []
    size = float(np.ptp(mesh.points[:, :2], axis=0).max())
    for number, (zone, region) in enumerate(zip(blank.zones, regions, strict=True), 1):
        key = f"{part}.zones.{number - 1}"
        if region is None:
            assert zone.set is not None
            if zone.set not in mesh.node_sets:
                remedy = suggest(zone.set, sorted(mesh.node_sets), "sets of the mesh")
                problems.append(Problem(f"{key}.set", "no such set", remedy, zone.set))
                continue
            of_set = mesh.node_sets[zone.set]
            inside = [np.asarray(np.isin(b.connectivity, of_set).all(axis=1)) for b in mesh.blocks]
        else:
            inside = [region.holds(middle) for middle in middles]
        if not any(own.any() for own in inside):
            low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
            text = "no element of the blank lies in the zone"
            remedy = (
                f"the blank that is computed reaches over x {low[0]:.4g} to {high[0]:.4g}, y {low[1]:.4g} to "
                f"{high[1]:.4g} mm: move the line, take its other side, or a smaller element_size"
            )
            problems.append(Problem(region.key if region else f"{key}.set", text, remedy))
            continue
        if all(own.all() for own in inside):
            text = "the zone is the whole blank: its line does not cross it"
            remedy = "move the line into the blank, or give the blank itself thickness and material of the zone"
            problems.append(Problem(region.key if region else f"{key}.set", text, remedy))
            continue
        for of_block, own, middle in zip(found, inside, middles, strict=True):
            both = own & (of_block > 0)
            if both.any():
                x, y = middle[both][0]
                other = blank.zones[int(of_block[both][0]) - 1].name
                text = f"overlaps the zone {other}, at ({x:.4g}, {y:.4g}) mm among others"
                problems.append(
                    Problem(key, text, "draw zones that do not overlap: each place has one sheet", zone.name)
                )
                break
            of_block[own] = number
        if region is not None and (off := _measure_off(mesh, inside, region)) > ON_LINE * size:
            logger.warning(
                "%s = %s: nodes of the weld are up to %.3g mm off its line: the line runs through elements, each of "
                "which is on the side of its middle",
                key,
                zone.name,
                off,
            )
    return found, problems


def _measure_off(mesh: model.Mesh, inside: Sequence[BoolArray], region: Region) -> float:
    """Return how far nodes of cells inside and of cells outside are off the line of a zone [mm]."""
    parts = [(block.connectivity, own) for block, own in zip(mesh.blocks, inside, strict=True)]
    one, other = (np.concatenate([cells[own == side].ravel() for cells, own in parts]) for side in (True, False))
    shared = np.intersect1d(one, other)
    return float(measure_distance(region.weld, mesh.points[shared, :2]).max()) if len(shared) else 0.0


def check_table(blank: Blank, mesh: model.Mesh) -> list[Problem]:
    """Return the problem of a table of thickness that ends within the blank."""
    if isinstance(blank.thickness, float):
        return []
    angle = radians(blank.thickness_direction)
    along = mesh.points[:, :2] @ [cos(angle), sin(angle)]
    first, last = blank.thickness[0][0], blank.thickness[-1][0]
    beyond = BEYOND * float(np.ptp(along))
    if along.min() >= first - beyond and along.max() <= last + beyond:
        return []
    reach = f"{along.min():g} to {along.max():g}"
    text = f"the table ends within the blank: it has {first:g} to {last:g} mm, the blank {reach}"
    remedy = f"add rows up to its edges, for instance [{along.min():g}, {blank.thickness[0][1]:g}]"
    return [Problem("blank.thickness", text, remedy)]


def is_made(blank: Blank) -> bool:
    """Return whether the program makes the mesh of a blank."""
    return not isinstance(blank, BlankFile)
