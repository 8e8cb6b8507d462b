# SPDX-License-Identifier: Apache-2.0
"""How large cells may be where: the least of what the tools' curvature, the thickness of the metal and the surface's
own curvature ask for, growing from there by no more than the gradation, within a budget of cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from presswork.geometry.profile_path import ProfilePath
from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.fill import measure_thickness

GRADATION = np.log(1.3)
"""Growth of the cell size over a length, from 1.3 between neighbours."""
OF_RADIUS = 0.25
OF_GAP = 0.25
REACH = 2.5
"""Cells of the largest size ahead of contact over which a tool's curvature counts."""
_CLASSES = 1.15
_CELLS_OF_GRID = 160


@dataclass(frozen=True)
class SizeSources:
    """Places (n, 2) where cells may be no larger than a size (n,) [mm]."""

    place: FloatArray
    size: FloatArray


class GradedSize:
    """The size of cells at points of the plane, from sources, by interpolation on a grid over them."""

    def __init__(self, line: FloatArray, sources: SizeSources, largest: float, smallest: float) -> None:
        margin = 2.0 * largest
        low, high = line.min(axis=0) - margin, line.max(axis=0) + margin
        self._low = low
        self._step = max(0.5 * smallest, float((high - low).max()) / _CELLS_OF_GRID)
        count = np.ceil((high - low) / self._step).astype(int) + 2
        x, y = (low[k] + self._step * np.arange(count[k]) for k in (0, 1))
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        self._values = grade(grid.reshape(-1, 2), sources, largest, smallest).reshape(grid.shape[:2])

    def __call__(self, points: FloatArray) -> FloatArray:
        """Return the edge length of cells at points (n, 2) [mm]."""
        at = ((points - self._low) / self._step).T
        return np.asarray(scipy.ndimage.map_coordinates(self._values, at, order=1, mode="nearest"))

    def limit(self, box: tuple[float, float, float, float], size: float) -> None:
        """Make cells in a rectangle (least x, y, largest x, y) no larger than a size [mm], graded round it."""
        x, y = (self._low[k] + self._step * np.arange(self._values.shape[k]) for k in (0, 1))
        outside = [np.maximum(np.maximum(box[k] - at, at - box[k + 2]), 0.0) for k, at in ((0, x), (1, y))]
        distance = np.hypot(outside[0][:, None], outside[1][None])
        self._values = np.minimum(self._values, size + GRADATION * distance)

    def scale(self, factor: float) -> None:
        """Make all cells larger by a factor."""
        self._values = self._values * factor


def grade(points: FloatArray, sources: SizeSources, largest: float, smallest: float) -> FloatArray:
    """Return the size at points (n, 2): the least over all sources of theirs and the gradation times the distance."""
    size = np.full(len(points), largest)
    wanted = np.clip(sources.size, smallest, largest)
    own_class = np.floor(np.log(wanted / smallest) / np.log(_CLASSES)).astype(int)
    for number in np.unique(own_class):
        own = own_class == number
        least = float(wanted[own].min())
        if least >= largest:
            continue
        reach = (largest - least) / GRADATION
        distance, _ = scipy.spatial.cKDTree(sources.place[own]).query(points, distance_upper_bound=reach)
        size = np.minimum(size, least + GRADATION * distance)
    return size


def join_sources(*sources: SizeSources) -> SizeSources:
    """Return all sources as one."""
    return SizeSources(np.concatenate([s.place for s in sources]), np.concatenate([s.size for s in sources]))


def tool_curvature(sides: FloatArray, profile: FloatArray, largest: float, corner_size: float) -> SizeSources:
    """Return sizes asked for by the arcs and corners of a placed profile near the sides of a boundary (k, 2, 2)."""
    path = ProfilePath(profile)
    places, sizes = [np.zeros((0, 2))], [np.zeros(0)]
    for i in np.flatnonzero(OF_RADIUS * path.radius < largest):
        least = max(OF_RADIUS * float(path.radius[i]), corner_size)
        first, last = path.begin[i], path.begin[i + 1]
        n = max(2, int(np.ceil((last - first) / least)) + 1)
        places.append(path.at(np.linspace(first, last, n) - 1e-9 * (last - first) * np.linspace(-1, 1, n)))
        sizes.append(np.full(n, least))
    corners, _ = path.corners()
    places.append(path.at(corners))
    sizes.append(np.full(len(corners), corner_size))
    place, size = np.concatenate(places), np.concatenate(sizes)
    distance, _ = scipy.spatial.cKDTree(_refine(sides, largest)).query(place)
    near = distance < REACH * largest
    # what is farther off may wait: it asks for less
    return SizeSources(place[near], size[near] + GRADATION * np.maximum(distance[near] - largest, 0.0))


def along_tool(sides: FloatArray, profile: FloatArray, largest: float, size: float) -> SizeSources:
    """Return a size all along a placed profile, where it is near the sides of a boundary (k, 2, 2)."""
    path = ProfilePath(profile)
    place = path.at(np.linspace(0.0, path.length, max(2, int(np.ceil(2.0 * path.length / size)) + 1))[:-1])
    distance, _ = scipy.spatial.cKDTree(_refine(sides, largest)).query(place)
    near = distance < REACH * largest
    return SizeSources(place[near], size + GRADATION * np.maximum(distance[near] - largest, 0.0))


def measure_power(corners: FloatArray, moves: FloatArray, stress: FloatArray, *, ring: bool) -> FloatArray:
    """Return the work of the mean stress (n_cells, 4) [MPa] over volume as corners move (n_cells,) [MPa].

    corners, moves: of the cells (n_cells, 3 | 4, 2) [mm]; the mean gradient of the moves is their integral along the
    edges over the area. ring: the third stress works round x = 0.
    """
    after, to = np.roll(corners, -1, axis=1), np.roll(moves, -1, axis=1)
    edge = after - corners
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
    area = 0.5 * (corners[..., 0] * after[..., 1] - after[..., 0] * corners[..., 1]).sum(axis=1)
    gradient = np.einsum("cki,ckj->cij", 0.5 * (moves + to), normal) / area[:, None, None]
    power = stress[:, 0] * gradient[:, 0, 0] + stress[:, 1] * gradient[:, 1, 1]
    power += stress[:, 3] * (gradient[:, 0, 1] + gradient[:, 1, 0])
    if ring:
        power += stress[:, 2] * moves[..., 0].mean(axis=1) / corners[..., 0].mean(axis=1)
    return np.asarray(power)


def error_sources(corners: FloatArray, cells: IndexArray, power: FloatArray, error: float) -> SizeSources:
    """Return the sizes with which cells miss a part `error` of the stress power, as much of it in each.

    corners: of the cells (n_cells, 3 | 4, 2) [mm], cells: their nodes, power: over volume, of each (n_cells,). What a
    cell misses is the difference of its power from that at its nodes, the mean of the cells round them (Zienkiewicz &
    Zhu 1987, with values constant in cells); over a cell it falls with the square of the size.
    """
    x, y = np.moveaxis(corners, -1, 0)
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
    weight = np.repeat(area[:, None], cells.shape[1], axis=1)
    n = int(cells.max()) + 1
    whole = np.maximum(np.bincount(cells.ravel(), weight.ravel(), n), 1e-300)
    at_nodes = np.bincount(cells.ravel(), (weight * power[:, None]).ravel(), n) / whole
    missed = np.sqrt(area * ((at_nodes[cells] - power[:, None]) ** 2).mean(axis=1))
    allowed = error * np.sqrt(float((area * power**2).sum()) / len(cells))
    size = np.sqrt(area) * np.sqrt(allowed / np.maximum(missed, 1e-12 * max(allowed, 1e-300)))
    return SizeSources(corners.mean(axis=1), size)


def _refine(sides: FloatArray, spacing: float) -> FloatArray:
    """Return points along sides (k, 2, 2) no farther apart than a spacing."""
    line, after = np.moveaxis(sides, 1, 0)
    n = max(1, int(np.ceil(float(np.linalg.norm(after - line, axis=1).max()) / spacing)))
    part = (np.arange(n) / n)[:, None, None]
    return np.asarray((line + part * (after - line)).reshape(-1, 2))


def metal_thickness(sides: FloatArray, doubled: BoolArray) -> FloatArray:
    """Return how thick the metal is inwards of the middle of sides (k, 2, 2), the metal on their left (k,) [mm].

    doubled (k,): sides in symmetry planes; metal up to one is twice as thick. Infinite where no side lies opposite.
    """
    along = sides[:, 1] - sides[:, 0]
    inwards = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1, keepdims=True)
    thickness = measure_thickness(sides, sides.mean(axis=1), inwards, doubled)
    return np.asarray(np.where(doubled, np.inf, thickness))


def gap_sources(sides: FloatArray, doubled: BoolArray) -> SizeSources:
    """Return a quarter of the metal's thickness at the middle of each of sides (k, 2, 2)."""
    size = OF_GAP * metal_thickness(sides, doubled)
    known = np.isfinite(size)
    return SizeSources(sides.mean(axis=1)[known], size[known])
