# SPDX-License-Identifier: Apache-2.0
"""Meshes of shells: rectangles, flat or rolled, and mesh files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from presswork import _core
from presswork.mesh.checks import MeshError, check_connected, check_coordinates
from presswork.mesh.directors import find_directors
from presswork.mesh.files.readers import build_sets, read_raw, take_cells
from presswork.mesh.make.structured import Pattern, mesh_rectangle
from presswork.mesh.topology import drop_unused_points, find_boundary_edges
from presswork.model import CellBlock, ElementName, FloatArray, IntArray, Mesh, Section


def mesh_shell_rectangle(
    x_lines: FloatArray,
    y_lines: FloatArray,
    *,
    element: ElementName,
    section: Section,
    pattern: Pattern | None = None,
    roll_radius: float | None = None,
    material: int = 0,
) -> Mesh:
    """Mesh the rectangle between grid lines, in the plane z = 0 or rolled about an axis along x.

    Rolled, y becomes arc length on a cylinder of `roll_radius` whose axis lies at z = -roll_radius. Normals point up,
    or outwards. Sets as in mesh_rectangle, and the nodes of its edges as `boundary`.
    """
    plane = mesh_rectangle(x_lines, y_lines, element=element, pattern=pattern, material=material)
    plane = replace(plane, node_sets=_add_boundary(plane.node_sets, plane.boundary_edges))
    block = replace(plane.blocks[0], section=section)
    x, y = plane.points.T
    if roll_radius is None:
        return replace(plane, points=np.column_stack([x, y, np.zeros_like(x)]), blocks=(block,))
    angle = y / roll_radius
    points = np.column_stack([x, roll_radius * np.sin(angle), roll_radius * (np.cos(angle) - 1.0)])
    normals = np.column_stack([np.zeros_like(x), np.sin(angle), np.cos(angle)])
    return replace(plane, points=points, blocks=(block,), normals=normals)


def read_shell_mesh(
    path: Path, *, element: ElementName, section: Section, scale: float = 1.0, material: int = 0, in_parts: bool = False
) -> tuple[Mesh, tuple[str, ...]]:
    """Read the mesh of a shell; return it and notes on what was changed.

    scale: factor of the file's coordinates to mm. in_parts: whether it may have several, which share no node. Sets as
    in read_mesh, by x and y. Cells may be wound in either sense. Raises MeshError.
    """
    raw = read_raw(path)
    if not len(raw.points):
        raise MeshError("the file has no nodes", "write it again from the mesher")
    check_coordinates(raw.points * scale)
    space = np.zeros((len(raw.points), 3))
    space[:, : raw.points.shape[1]] = raw.points * scale
    cells = take_cells(raw, element)
    points, number = drop_unused_points(space, [cells])
    cells = number[cells].astype(np.int32)
    check_connected(points, cells, most=8, in_parts=in_parts)
    boundary = find_boundary_edges([cells])
    node_sets, edge_sets = build_sets(raw, number, points, boundary)
    notes = []
    if len(points) < len(space):
        notes.append(f"{len(space) - len(points)} nodes belong to no cell: they were left out")
    block = CellBlock(element, cells, material, section)
    find_directors(points, [block], [_core.shell_shape(element)[3]])  # refuses cells and nodes without
    return Mesh(points, (block,), _add_boundary(node_sets, boundary), edge_sets, boundary), tuple(notes)


def _add_boundary(node_sets: Mapping[str, IntArray], edges: IntArray) -> dict[str, IntArray]:
    """Return sets of nodes with those of the edges (n, 2) as `boundary`, unless a file has its own."""
    return {"boundary": np.unique(edges), **node_sets}
