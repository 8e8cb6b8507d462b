# SPDX-License-Identifier: Apache-2.0
"""Meshes of solids in space: a box of hexahedra, and hexahedra or tetrahedra from a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork import _core
from presswork.mesh.checks import MeshError, check_coordinates
from presswork.mesh.faces import find_boundary_faces, list_cell_faces, select_faces
from presswork.mesh.files.raw import RawMesh
from presswork.mesh.files.readers import read_raw
from presswork.mesh.topology import drop_unused_points, find_parts
from presswork.model import (
    CELLS,
    CellBlock,
    FloatArray,
    IntArray,
    Mesh,
    SpaceElement,
    cell_of,
    find_cell,
    list_names,
)

SIDES = (("left", "right"), ("bottom", "top"), ("back", "front"))
"""Names of the lower and upper sides normal to x, y and z."""


def mesh_box(
    x_lines: FloatArray, y_lines: FloatArray, z_lines: FloatArray, *, element: SpaceElement, material: int = 0
) -> Mesh:
    """Mesh the box between grid lines (increasing coordinates [mm]) by hexahedra, or by six tetrahedra in each.

    material: index into Model.materials. Node and face sets: left, right, bottom, top, back, front; all nodes are
    `all`, all faces `boundary`. Nodes are numbered fastest along the direction with the fewest cells.
    """
    lines = (x_lines, y_lines, z_lines)
    counts = np.array([len(line) for line in lines])
    order = np.argsort(counts, kind="stable")
    stride = np.empty(3, dtype=np.int64)
    stride[order] = np.concatenate([[1], np.cumprod(counts[order])[:-1]])
    grids = np.meshgrid(*(np.arange(count) for count in counts), indexing="ij")
    number = np.einsum("a...,a->...", np.array(grids), stride)
    points = np.empty((number.size, 3))
    for axis, (grid, line) in enumerate(zip(grids, lines, strict=True)):
        points[number.ravel(), axis] = line[grid.ravel()]
    first = number[:-1, :-1, :-1].ravel(order="F")[:, None]
    x, y, z = stride
    cells = first + np.array([0, x, x + y, y, z, z + x, z + x + y, z + y])
    return finish_mesh(points, cells.astype(np.int32), {}, element, material)


def read_solid_mesh(
    path: Path, *, element: SpaceElement, scale: float = 1.0, material: int = 0
) -> tuple[Mesh, tuple[str, ...]]:
    """Read a mesh of hexahedra or tetrahedra; return it and notes on what was changed.

    scale: factor of the file's coordinates to mm. material: index into Model.materials. Node sets come from the file's
    groups of nodes, faces and cells, face sets from its groups of such faces and from node sets that hold whole
    faces; the sides of the box that holds the body are added where the file has none of that name. Raises MeshError.
    """
    raw = read_raw(path)
    cells = _take_volumes(raw, element)
    check_coordinates(raw.points * scale)
    if cells.min() < 0 or cells.max() >= len(raw.points):
        raise MeshError("cells use nodes that the file does not have", "the file is cut short; write it again")
    points, number = drop_unused_points(raw.points * scale, [cells])
    cells = number[cells].astype(np.int32)
    notes = []
    if len(points) < len(raw.points):
        notes.append(f"{len(raw.points) - len(points)} nodes belong to no cell: they were left out")
    cells, turned = _wind_outwards(points, cells)
    if turned:
        notes.append("all cells are numbered inside out: they were turned over")
    n_parts, _ = find_parts([cells], len(points))
    if n_parts > 1:
        raise MeshError(f"the cells fall into {n_parts} parts that share no node", "keep one part, or join them")
    return finish_mesh(points, cells, _number_sets(raw, number), element, material), tuple(notes)


def _take_volumes(raw: RawMesh, element: SpaceElement) -> IntArray:
    """Return the cells that fit the element (n_cells, n_nodes). Raises MeshError where there are none, or others."""
    wanted = cell_of(element)
    there = ", ".join(sorted({*raw.cells, *raw.other_kinds})) or "nothing"
    if wanted.name not in raw.volumes:
        fits = [name for kind in raw.volumes for name in list_names(_core.Family.space, in_implicit=True, cell=kind)]
        remedy = f"take element = {' or '.join(fits)}" if fits else "mesh the body with such cells"
        raise MeshError(f"the file has no {wanted.plural} of {wanted.nodes} nodes (it has {there})", remedy)
    volumes = ("tetra", "wedge", "pyramid", "hexahedron", "C3D")
    others = [kind for kind in sorted(raw.other_kinds - {wanted.files.meshio}) if kind.startswith(volumes)]
    if others:
        fault = f"the file has cells of other kinds too ({', '.join(others)})"
        raise MeshError(fault, f"mesh with {wanted.plural} only")
    return np.concatenate(raw.volumes[wanted.name])


def finish_mesh(
    points: FloatArray, cells: IntArray, node_sets: dict[str, IntArray], element: SpaceElement, material: int
) -> Mesh:
    """Return the mesh with its boundary faces and sets; to `node_sets` the sides of the box are added.

    Hexahedra are split where the element is a tetrahedron, and edges get a node in the middle where it has 10 nodes;
    that node joins every set that has both ends.
    """
    wanted = cell_of(element)
    if wanted.is_simplex and not find_cell(3, cells).is_simplex:
        cells = split_hexahedra(cells)
    if wanted.is_quadratic and not find_cell(3, cells).is_quadratic:
        points, cells, node_sets = add_middles(points, cells, node_sets)
    faces, _ = find_boundary_faces([cells])
    sets = dict(node_sets)
    tolerance = 1e-9 * float(np.linalg.norm(np.ptp(points, axis=0)))
    low, high = points.min(axis=0), points.max(axis=0)
    for axis, (lower, upper) in enumerate(SIDES):
        for name, is_there in (
            (lower, points[:, axis] <= low[axis] + tolerance),
            (upper, points[:, axis] >= high[axis] - tolerance),
        ):
            sets.setdefault(name, np.flatnonzero(is_there).astype(np.int32))
    sets.setdefault("all", np.arange(len(points), dtype=np.int32))
    face_sets = {name: select_faces(faces, nodes) for name, nodes in sets.items() if name != "all"}
    face_sets = {name: own for name, own in face_sets.items() if len(own)}
    face_sets.setdefault("boundary", faces)
    no_edges = np.zeros((0, 2), dtype=np.int32)
    return Mesh(
        points, (CellBlock(element, cells, material),), sets, {}, no_edges, face_sets=face_sets, boundary_faces=faces
    )


def split_hexahedra(cells: IntArray) -> IntArray:
    """Return six tetrahedra of each hexahedron (6 n_cells, 4): faces that two cells share are cut alike in both.

    Each face is cut from its node of the smallest number, and each cell is filled from its own (Dompierre et al. 1999).
    """
    faces = list_cell_faces(cells).reshape(len(cells), 6, 4)
    first = cells.min(axis=1)
    lowest = np.argmin(faces, axis=2)
    turned = np.take_along_axis(faces, (lowest[:, :, None] + np.arange(4)) % 4, axis=2)
    triangles = turned[:, :, CELLS["quad4"].simplices].reshape(len(cells), 12, 3)
    far = np.repeat((faces != first[:, None, None]).all(axis=2), 2, axis=1)
    own = np.repeat(first, 6)[:, None]
    return np.concatenate([own, triangles[far]], axis=1).astype(np.int32)


def add_middles(
    points: FloatArray, cells: IntArray, node_sets: dict[str, IntArray]
) -> tuple[FloatArray, IntArray, dict[str, IntArray]]:
    """Return points, tetrahedra (n_cells, 10) and node sets with a node in the middle of every edge."""
    edges_of_cell = find_cell(3, cells).edges
    ends = np.sort(cells[:, edges_of_cell].astype(np.int64), axis=2)
    edges, number = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    middles = len(points) + number.reshape(len(cells), len(edges_of_cell))
    sets = {}
    for name, nodes in node_sets.items():
        inside = np.zeros(len(points), dtype=bool)
        inside[nodes] = True
        own = len(points) + np.flatnonzero(inside[edges].all(axis=1))
        sets[name] = np.concatenate([nodes, own]).astype(np.int32)
    return (
        np.concatenate([points, points[edges].mean(axis=1)]),
        np.concatenate([cells, middles], axis=1).astype(np.int32),
        sets,
    )


def _number_sets(raw: RawMesh, number: IntArray) -> dict[str, IntArray]:
    """Return the node sets of a file in the new numbers of its points."""
    found = {}
    for name in sorted({*raw.node_sets, *raw.line_sets}):
        nodes = np.concatenate([part.ravel() for part in (*raw.node_sets.get(name, []), *raw.line_sets.get(name, []))])
        kept = number[nodes.astype(np.int64)]
        found[name] = np.unique(kept[kept >= 0]).astype(np.int32)
    return found


def corner_volumes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the triple product of the three edges at each corner (n_cells, 8) [mm3]: the Jacobian's sign there.

    A tetrahedron of 4 nodes has one (n_cells, 1), six times its volume; one of 10 nodes has that of its corners and
    those at its four points of integration (n_cells, 5).
    """
    x, cell = points[cells], find_cell(3, cells)
    if cell.is_simplex:
        of_corners = np.asarray(np.linalg.det(x[:, 1:4] - x[:, :1]))[:, None]
        return of_corners if not cell.is_quadratic else np.column_stack([of_corners, _jacobians_inside(x)])
    x = x[:, : cell.corners]
    next_ones = np.array([[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]])
    edges = x[:, next_ones] - x[:, :, None]
    return np.asarray(np.linalg.det(edges))


def node_volumes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the volume that each node of each cell stands for, int N dV (n_cells, 8 | 4) [mm3].

    A tetrahedron of 10 nodes, whose corners would have negative volumes, is shared out in proportion to int N^2 dV
    (n_cells, 10): a corner for 1/36, a middle for 4/27 (Hinton, Rock & Zienkiewicz 1976).
    """
    cell = find_cell(3, cells)
    if cell.is_simplex:
        whole = corner_volumes(points, cells)
        volume = whole[:, 1:].sum(axis=1) / 24.0 if cell.is_quadratic else whole[:, 0] / 6.0
        return np.outer(volume, cell.mass_shares)
    corner, volumes = cell.places, np.zeros(cells.shape)
    for place in corner / np.sqrt(3.0):  # Gauss's points, of weight 1
        along = 0.5 * (1.0 + corner * place)
        slopes = 0.5 * corner * along[:, [1, 2, 0]] * along[:, [2, 0, 1]]
        jacobian = np.linalg.det(np.einsum("aj,cai->cij", slopes, points[cells]))
        volumes += jacobian[:, None] * along.prod(axis=1)
    return volumes


def _jacobians_inside(x: FloatArray) -> FloatArray:
    """Return the Jacobian of tetrahedra (n_cells, 10, 3) at the four points of their rule (n_cells, 4) [mm3]."""
    slopes, found = np.array([[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), []
    for near in range(4):
        share = np.full(4, 0.13819660112501051518)
        share[near] = 0.58541019662496845446
        middles = [4.0 * (slopes[a] * share[b] + share[a] * slopes[b]) for a, b, _ in CELLS["tet10"].edges]
        dN = np.concatenate([slopes * (4.0 * share - 1.0)[:, None], middles])
        found.append(np.linalg.det(np.einsum("aj,cai->cij", dN, x)))
    return np.stack(found, axis=1)


def _wind_outwards(points: FloatArray, cells: IntArray) -> tuple[IntArray, bool]:
    """Return the cells wound outwards, and whether all of them were turned over. Raises MeshError."""
    volumes = corner_volumes(points, cells)
    if (volumes > 0.0).all():
        return cells, False
    if (volumes < 0.0).all():
        return np.ascontiguousarray(cells[:, find_cell(3, cells).reversed]), True
    wrong = np.flatnonzero(~(volumes > 0.0).all(axis=1))
    centre = ", ".join(f"{c:.6g}" for c in points[cells[wrong[0]]].mean(axis=0))
    raise MeshError(
        f"{len(wrong)} of {len(cells)} cells are inverted, folded or without volume: cell {wrong[0] + 1}, near "
        f"({centre})",
        "mend these cells in the mesher; the three edges at each corner must span a volume, in all cells alike",
    )
