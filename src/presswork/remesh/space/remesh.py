# SPDX-License-Identifier: Apache-2.0
"""A new mesh for one deformed body of tetrahedra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import FilledBody, mesh_to_size
from presswork.remesh.space.size_field import EdgeSizes, measure_sizes
from presswork.remesh.space.surface import locate_on_skin, place_skin
from presswork.remesh.space.tetrahedra import list_edges, measure_quality

AWAY = 0.1
"""Of the largest edge, by which the new skin may leave the old one, taken as smooth."""
LEAST_QUALITY = 0.05
"""Of the worst cell: a mesh with a flatter one is refused."""
_ATTEMPTS, _FINER = 3, 0.8
"""Where no mesh can be made cells are made smaller by a factor, and it is tried again."""
_ROUNDS, _HALVINGS = 4, 8
"""In which the skin comes to its place where cells would turn inside out on its way, and halvings of that way."""
_SWEEPS = 40
"""In which moves of the skin spread into the body."""


def remesh_body(body: OldBody, sizes: EdgeSizes, *, part: float = 1.0) -> NewBody:
    """Return a new mesh of a body, with a part of the edges that its sizes ask for. Raises MeshError."""
    fault = MeshError("", "")
    for attempt in range(_ATTEMPTS):
        finer = part * _FINER**attempt
        try:
            return _try_mesh(body, replace(sizes, largest=finer * sizes.largest, smallest=finer * sizes.smallest))
        except MeshError as error:
            fault = error if attempt == 0 else fault
    raise fault


def _try_mesh(body: OldBody, sizes: EdgeSizes) -> NewBody:
    number, table = body.references
    size = measure_sizes(body, sizes)
    present = FilledBody(body.points, body.cells, body.faces, number)
    worst = 0.0
    for _ in range(_ROUNDS):
        made = mesh_to_size(
            present, size, smallest=sizes.smallest, largest=float(size.max()), away=AWAY * sizes.largest
        )
        points, in_plane = _keep_planes(body, made, table)
        skin = np.unique(made.faces)
        places = locate_on_skin(body.points, body.faces, points[skin])
        placed = place_skin(body, points, made.faces, in_plane, places)
        points = spread_moves(made.points, made.cells, skin, placed.points)
        worst = float(measure_quality(points, made.cells).min())
        if worst >= LEAST_QUALITY:
            first_set = len(body.planes)
            sets = {name: made.faces[table[made.number, first_set + column]] for column, name in enumerate(body.sets)}
            corners = body.faces[places.face]
            return NewBody(
                points, made.cells, made.faces, sets, placed.on_tool, skin, corners, places.share, placed.offset
            )
        # the skin goes as far as cells allow, and what is left of its way is gone on a mesh of that
        points = retreat(made.points, points, made.cells)
        present = FilledBody(points, made.cells, made.faces, made.number)
        size = measure_sizes(body, sizes, points)
    raise MeshError(f"a cell of the new mesh has a quality of {worst:.2g}", "smaller cells")


def _keep_planes(body: OldBody, made: FilledBody, table: BoolArray) -> tuple[FloatArray, BoolArray]:
    """Return the points with those in planes exactly there, and which coordinates planes hold (n, 3)."""
    points, in_plane = made.points.copy(), np.zeros(made.points.shape, dtype=bool)
    for column, (axis, level, _) in enumerate(body.planes):
        nodes = np.unique(made.faces[table[made.number, column]])
        points[nodes, axis] = level
        in_plane[nodes, axis] = True
    return points, in_plane


def retreat(start: FloatArray, end: FloatArray, cells: IndexArray) -> FloatArray:
    """Return nodes as far on their ways from start to end (n, 3) [mm] as leaves no cell flat or inside out."""
    part = np.ones(len(start))
    for _ in range(_HALVINGS):
        points = start + part[:, None] * (end - start)
        bad = measure_quality(points, cells) < LEAST_QUALITY
        if not bad.any():
            return points
        part[np.unique(cells[bad])] *= 0.5
    return start


def spread_moves(points: FloatArray, cells: IndexArray, skin: IndexArray, placed: FloatArray) -> FloatArray:
    """Return all nodes (n, 3), those of the skin as placed, others moved with the nodes round them.

    An inner node takes the mean of its neighbours' moves, weighted by the inverse square of their distance.
    """
    edges = list_edges(cells)
    weight = 1.0 / np.maximum(((points[edges[:, 1]] - points[edges[:, 0]]) ** 2).sum(axis=1), 1e-300)
    total = np.bincount(edges.ravel(), np.repeat(weight, 2), len(points))
    moves: FloatArray = np.zeros_like(points)
    moves[skin] = placed[skin] - points[skin]
    inner: BoolArray = np.ones(len(points), dtype=bool)
    inner[skin] = False
    for _ in range(_SWEEPS):
        for axis in range(3):
            own = moves[:, axis]
            given = np.bincount(edges[:, 0], weight * own[edges[:, 1]], len(points))
            given += np.bincount(edges[:, 1], weight * own[edges[:, 0]], len(points))
            moves[inner, axis] = given[inner] / total[inner]
    result = points + moves
    result[skin] = placed[skin]
    return result
