# SPDX-License-Identifier: Apache-2.0
"""Structured meshes of a rectangle: quadrilaterals, or triangles by a pattern of diagonals, with graded cell sizes.

Every kind of cell is a stencil on a lattice that is a few times finer than the cells; the lattice points that some cell
uses are the nodes, numbered along the direction that has fewer cells, so that the numbering is banded.
In the 4CST pattern ("crossed") the quad is cut by both diagonals; on a rectangle they meet in its centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from presswork.mesh.topology import find_boundary_edges, select_edges
from presswork.model import Cell, CellBlock, ElementName, FloatArray, IntArray, Mesh, cell_of

Pattern = Literal["quad", "crossed", "left", "right"]

# Corners of the cells that a pattern makes of one quad, on a lattice of 2 x 2 steps per quad, counter-clockwise.
_CORNERS: dict[Pattern, list[list[tuple[int, int]]]] = {
    "quad": [[(0, 0), (2, 0), (2, 2), (0, 2)]],
    "crossed": [
        [(0, 0), (2, 0), (1, 1)],
        [(2, 0), (2, 2), (1, 1)],
        [(2, 2), (0, 2), (1, 1)],
        [(0, 2), (0, 0), (1, 1)],
    ],
    "right": [[(0, 0), (2, 0), (2, 2)], [(0, 0), (2, 2), (0, 2)]],
    "left": [[(0, 0), (2, 0), (0, 2)], [(2, 0), (2, 2), (0, 2)]],
}


def fitting_patterns(element: ElementName) -> tuple[Pattern, ...]:
    """Return the patterns that make cells for an element, the usual one first."""
    return ("crossed", "left", "right") if cell_of(element).is_simplex else ("quad",)


def grade_line(start: float, zones: Sequence[tuple[float, int, float]]) -> FloatArray:
    """Return the cell limits along a line of zones (length [mm], number of cells, last over first cell size).

    Cell sizes within a zone are a geometric progression. Shape (sum of the numbers of cells + 1,).
    """
    limits = [np.array([start])]
    for length, n_cells, ratio in zones:
        growth = ratio ** (1.0 / max(n_cells - 1, 1))
        ends = np.cumsum(growth ** np.arange(n_cells))
        limits.append(start + length * ends / ends[-1])
        start += length
        limits[-1][-1] = start
    return np.concatenate(limits)


def mesh_rectangle(
    x_lines: FloatArray, y_lines: FloatArray, *, element: ElementName, pattern: Pattern | None = None, material: int = 0
) -> Mesh:
    """Mesh the rectangle between grid lines.

    x_lines, y_lines: increasing coordinates of the grid lines [mm]. pattern: how a quad of the grid is cut; without it,
    the usual one of the element. material: index into Model.materials.
    Node sets: left, right, bottom, top, all, and the corners bottom_left, bottom_right, top_left, top_right; edge sets:
    left, right, bottom, top, boundary. Raises ValueError for a pattern that does not fit the element.
    """
    pattern = pattern or fitting_patterns(element)[0]
    if pattern not in fitting_patterns(element):
        raise ValueError(f"pattern {pattern} does not make cells for {element}")
    steps, stencil = _stencil(cell_of(element), pattern)
    x_first = len(x_lines) <= len(y_lines)
    inner, outer = (x_lines, y_lines) if x_first else (y_lines, x_lines)
    offset_inner, offset_outer = (stencil[..., 0], stencil[..., 1]) if x_first else (stencil[..., 1], stencil[..., 0])

    inner_points, outer_points = _subdivide(inner, steps), _subdivide(outer, steps)
    corner = (
        steps * np.arange(len(inner) - 1)[None, :] + steps * len(inner_points) * np.arange(len(outer) - 1)[:, None]
    ).ravel()
    cells = (corner[:, None, None] + offset_inner + offset_outer * len(inner_points)).reshape(-1, stencil.shape[1])

    used = np.zeros(len(inner_points) * len(outer_points), dtype=bool)
    used[cells] = True
    number = np.cumsum(used, dtype=np.int32) - 1
    lattice = np.flatnonzero(used)
    first, second = inner_points[lattice % len(inner_points)], outer_points[lattice // len(inner_points)]
    points = np.column_stack((first, second) if x_first else (second, first))
    block = CellBlock(element, number[cells].astype(np.int32), material)
    boundary = find_boundary_edges([block.connectivity])
    node_sets = _rectangle_node_sets(points)
    edge_sets = {side: select_edges(boundary, node_sets[side]) for side in ("left", "right", "bottom", "top")}
    return Mesh(points, (block,), node_sets, {**edge_sets, "boundary": boundary}, boundary)


def _stencil(cell: Cell, pattern: Pattern) -> tuple[int, IntArray]:
    """Return the lattice steps per quad and the cells' nodes on it, shape (cells per quad, nodes, 2).

    The lattice is as fine as mid-sides, also those of half diagonals, and inner nodes need it.
    """
    corners = np.array(_CORNERS[pattern], dtype=np.float64)
    nodes = np.repeat(corners.mean(axis=1, keepdims=True), cell.nodes, axis=1)
    nodes[:, : cell.corners] = corners
    if cell.is_quadratic:
        nodes[:, cell.edges[:, 2]] = corners[:, cell.edges[:, :2]].mean(axis=2)
    finer = next(n for n in range(1, 13) if np.allclose(n * nodes, np.rint(n * nodes)))
    return 2 * finer, np.rint(finer * nodes).astype(np.int32)


def _subdivide(lines: FloatArray, steps: int) -> FloatArray:
    """Put steps - 1 equally spaced points between neighbouring grid lines."""
    fraction = np.arange(steps) / steps
    inside = lines[:-1, None] * (1.0 - fraction) + lines[1:, None] * fraction
    return np.append(inside.ravel(), lines[-1])


def _rectangle_node_sets(points: FloatArray) -> dict[str, IntArray]:
    x, y = points.T
    left, right = x == x.min(), x == x.max()
    bottom, top = y == y.min(), y == y.max()
    masks = {
        "left": left,
        "right": right,
        "bottom": bottom,
        "top": top,
        "bottom_left": bottom & left,
        "bottom_right": bottom & right,
        "top_left": top & left,
        "top_right": top & right,
        "all": np.ones(len(points), dtype=bool),
    }
    return {name: np.flatnonzero(mask).astype(np.int32) for name, mask in masks.items()}
