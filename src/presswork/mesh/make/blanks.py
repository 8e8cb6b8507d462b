# SPDX-License-Identifier: Apache-2.0
"""Meshes of blanks: cells over a rectangle or a circle about the origin, or in a line; whole or cut by symmetry planes.

Quadrilaterals, or triangles: each quadrilateral is cut by both diagonals, so that no direction is preferred.

Sets: all; edge, the outline without what lies in symmetry planes; symmetry_x and symmetry_y, the nodes in the planes
x = 0 and y = 0 where the blank is cut by them; left, right, bottom, top, the outermost nodes along x and y.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from math import ceil

import numpy as np

from presswork.mesh.topology import find_boundary_edges, select_edges
from presswork.model import ELEMENTS, CellBlock, ElementName, FloatArray, IntArray, Mesh, Section, find_cell

ELEMENTS_OF_BLANKS: dict[str, ElementName] = {"tri3": "shell3_1pt", "quad4": "shell4_1pt"}
"""Elements by kind of cell, until assign_section gives them those of a case."""
_ON_AXIS, _ON_DIAGONAL = 0.65, 0.75
"""Extent of the square core of a circle along its axes and its diagonal, over the radius."""


def mesh_rectangular_blank(
    size: tuple[float, float],
    element_size: float | tuple[float, float],
    symmetry: Sequence[bool],
    *,
    triangles: bool = False,
    welds: tuple[Sequence[float], Sequence[float]] = ((), ()),
) -> Mesh:
    """Mesh a rectangle of size [mm] about the origin; symmetry: whether the planes x = 0 and y = 0 cut it.

    welds: x and y at which the grid has lines [mm].

    element_size: largest side of a cell, or largest along x and along y [mm]. A side that is not cut has one cell or an
    even number of them, so that the whole blank is meshed as its half and its mirror image are.
    """
    half = 0.5 * np.array(size)
    low = np.where(symmetry, 0.0, -half)
    counts, sides = _count_cells(half - low, np.asarray(element_size), symmetry), np.broadcast_to(element_size, 2)
    each = zip(low, half, counts, sides, welds, strict=True)
    points, cells = _draw_grid([_place_lines(begin, end, n, side, at) for begin, end, n, side, at in each])
    return name_sets(points, [cells], symmetry, triangles)


def _count_cells(length: FloatArray, size: FloatArray, symmetry: Sequence[bool]) -> IntArray:
    """Return the numbers of cells along x and y."""
    counts = np.maximum(1, np.ceil(length / size - 1e-9)).astype(int)
    return np.where(symmetry, counts, np.where(counts > 1, counts + counts % 2, counts))


def _place_lines(begin: float, end: float, n: int, size: float, welds: Sequence[float]) -> FloatArray:
    """Return the lines of n equal cells, or of cells up to a size that end at welds between both ends."""
    inside = sorted({at for at in welds if begin < at < end})
    lines = np.linspace(begin, end, n + 1)
    if all(np.abs(lines - at).min() <= 1e-9 * (end - begin) for at in inside):
        return lines
    ends = [begin, *inside, end]
    parts = [np.linspace(a, b, max(1, ceil((b - a) / size - 1e-9)) + 1) for a, b in itertools.pairwise(ends)]
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])


def _draw_grid(lines: Sequence[FloatArray]) -> tuple[FloatArray, IntArray]:
    """Return points (n, 2) and quadrilaterals between lines along x and along y."""
    x, y = (grid.ravel() for grid in np.meshgrid(*lines))
    n = len(lines[0])
    first = (np.arange(n - 1)[None, :] + n * np.arange(len(lines[1]) - 1)[:, None]).ravel()
    return np.column_stack([x, y]), np.stack([first, first + 1, first + n + 1, first + n], axis=1)


def mesh_circular_blank(
    diameter: float, element_size: float, symmetry: Sequence[bool], *, triangles: bool = False
) -> Mesh:
    """Mesh a circle [mm] about the origin: a square core with bulging sides, and a ring of quadrilaterals round it.

    No corner is sharper than 45 degrees, and the cells' sides are within 0.6 and 1.4 of element_size.
    """
    points, cells = _quarter_circle(0.5 * diameter, element_size)
    for axis, is_cut in enumerate(symmetry):
        if not is_cut:
            points, cells = _add_mirror_image(points, cells, axis)
    return name_sets(points, [cells], symmetry, triangles)


def _quarter_circle(radius: float, element_size: float) -> tuple[FloatArray, IntArray]:
    """Return points (n, 2) and cells of the quarter x, y >= 0."""
    n = max(1, ceil(_ON_AXIS * radius / element_size - 1e-9))
    m = max(1, ceil((1 - 0.5 * (_ON_AXIS + _ON_DIAGONAL)) * radius / element_size - 1e-9))
    on_axis, on_diagonal = _ON_AXIS * radius, _ON_DIAGONAL * radius * np.sqrt(0.5)
    s, t = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)))
    bulge = on_diagonal - on_axis
    core = np.column_stack([on_axis * s + bulge * s * t, on_axis * t + bulge * s * t])
    first = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    core_cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1)
    rim = np.concatenate([n + (n + 1) * np.arange(n + 1), (n + 1) * n + np.arange(n - 1, -1, -1)])
    angle = np.linspace(0.0, 0.5 * np.pi, 2 * n + 1)
    circle = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    circle[0, 1] = circle[-1, 0] = 0.0
    outwards = np.arange(1, m + 1)[:, None, None] / m
    ring = core[rim] + outwards * (circle - core[rim])
    number = np.vstack([rim, len(core) + np.arange(m * len(rim)).reshape(m, -1)])
    inner, outer = number[:-1], number[1:]
    ring_cells = np.stack([inner[:, :-1], outer[:, :-1], outer[:, 1:], inner[:, 1:]], axis=-1).reshape(-1, 4)
    return np.concatenate([core, ring.reshape(-1, 2)]), np.concatenate([core_cells, ring_cells])


def _add_mirror_image(points: FloatArray, cells: IntArray, axis: int) -> tuple[FloatArray, IntArray]:
    """Return the mesh with its image at the plane where the coordinate `axis` is zero, joined there."""
    beyond = points[:, axis] > 1e-9 * np.abs(points).max()
    number = np.arange(len(points))
    number[beyond] = len(points) + np.arange(int(beyond.sum()))
    image = points[beyond].copy()
    image[:, axis] *= -1.0
    return np.concatenate([points, image]), np.concatenate([cells, number[cells][:, ::-1]])


def name_sets(points: FloatArray, kinds: Sequence[IntArray], symmetry: Sequence[bool], triangles: bool) -> Mesh:
    """Return the mesh in space; its elements and section are filled in by assign_section.

    kinds: quadrilaterals, triangles.
    """
    if triangles and not find_cell(2, kinds[0]).is_simplex:
        quads = kinds[0]
        centre = np.tile(len(points) + np.arange(len(quads)), (4, 1)).T
        points = np.concatenate([points, points[quads].mean(axis=1)])
        parts = np.stack([quads, np.roll(quads, -1, axis=1), centre], axis=2).reshape(-1, 3)
        kinds = [np.concatenate([parts, *kinds[1:]])]
    blocks = tuple(
        CellBlock(ELEMENTS_OF_BLANKS[find_cell(2, cells).name], cells.astype(np.int32), 0) for cells in kinds
    )
    boundary = find_boundary_edges([block.connectivity for block in blocks])
    tolerance = 1e-9 * float(np.abs(points).max())
    low, high = points.min(axis=0), points.max(axis=0)
    node_sets = {
        "left": points[:, 0] <= low[0] + tolerance,
        "right": points[:, 0] >= high[0] - tolerance,
        "bottom": points[:, 1] <= low[1] + tolerance,
        "top": points[:, 1] >= high[1] - tolerance,
        "all": np.ones(len(points), dtype=bool),
    }
    for axis, name in enumerate(("symmetry_x", "symmetry_y")):
        if symmetry[axis]:
            node_sets[name] = np.abs(points[:, axis]) <= tolerance
    numbered = {name: np.flatnonzero(mask).astype(np.int32) for name, mask in node_sets.items()}
    inside = [select_edges(boundary, numbered[name]) for name in ("symmetry_x", "symmetry_y") if name in numbered]
    cut = {tuple(edge) for edges in inside for edge in edges.tolist()}
    outline = np.array([edge for edge in boundary.tolist() if tuple(edge) not in cut], dtype=np.int32).reshape(-1, 2)
    numbered["edge"] = np.unique(outline).astype(np.int32)
    space = np.column_stack([points, np.zeros(len(points))])
    return Mesh(space, blocks, numbered, {"edge": outline, "boundary": boundary}, boundary)


def assign_section(mesh: Mesh, elements: Mapping[str, ElementName], section: Section, material: int) -> Mesh:
    """Return the mesh with its cells' element, by their kind, section and material."""
    blocks = tuple(
        CellBlock(elements[ELEMENTS[block.element].cell], block.connectivity, material, section)
        for block in mesh.blocks
    )
    return Mesh(mesh.points, blocks, mesh.node_sets, mesh.edge_sets, mesh.boundary_edges, mesh.normals)
