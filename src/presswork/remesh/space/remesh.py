# SPDX-License-Identifier: Apache-2.0
"""A new mesh for one deformed body of tetrahedra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import FilledBody, mesh_to_size
from presswork.remesh.space.inside import improve_cells, spread_moves
from presswork.remesh.space.notches import fill_notches, list_planes
from presswork.remesh.space.size_field import EdgeSizes, measure_sizes
from presswork.remesh.space.sliding import slide_on_tools
from presswork.remesh.space.surface import locate_on_skin, place_skin, restore_volume
from presswork.remesh.space.tetrahedra import measure_quality, nodal_areas

AWAY = 0.1
"""How far the new skin may leave the old one, taken as smooth, over the largest edge."""
LEAST_QUALITY, WANTED = 0.05, 0.25
"""Quality of the worst cell below which a mesh is refused, and quality below which inner nodes of cells look for a
better place."""
_ATTEMPTS, _FINER = 3, 0.8
"""Where no mesh can be made cells are made smaller by a factor, and it is tried again."""
_ROUNDS, _HALVINGS = 4, 8
"""Rounds in which the skin comes to its place where cells would turn inside out, and halvings of its displacement."""
_FILLINGS = 4
"""Most times that a mesh is made because the one before had notches."""
_PROGRESS = 0.05
"""Least gain in the quality of the worst cell: a round that gains less is the last."""
_BETTER, _LEAST_AT_ALL = 1.3, 0.01
"""Quality over that of the old mesh from which on a mesh with a flat cell is better than none; its least quality."""


def remesh_body(body: OldBody, sizes: EdgeSizes, *, part: float = 1.0) -> NewBody:
    """Return a new mesh of a body, with a part of the edges that its sizes ask for. Raises MeshError."""
    fault, best, quality = MeshError("", ""), None, -1.0
    for attempt in range(_ATTEMPTS):
        finer = part * _FINER**attempt
        try:
            new, worst = _try_mesh(body, replace(sizes, largest=finer * sizes.largest, smallest=finer * sizes.smallest))
        except MeshError as error:
            fault = error if attempt == 0 else fault
            continue
        if worst >= LEAST_QUALITY:
            return new
        if worst > quality:
            best, quality = new, worst
    if best is None:
        raise fault
    present = float(measure_quality(body.points, body.cells).min())
    if quality < max(_LEAST_AT_ALL, _BETTER * present):
        raise MeshError(f"a cell of the new mesh has a quality of {quality:.2g}", "smaller cells")
    return best


def _try_mesh(body: OldBody, sizes: EdgeSizes) -> tuple[NewBody, float]:
    """Return a mesh and the quality of its worst cell. Raises MeshError."""
    number, table = body.references
    size = measure_sizes(body, sizes)
    present, seams = FilledBody(body.points, body.cells, body.faces, number), [np.zeros((0, 3))]
    found: list[tuple[NewBody, float]] = []
    for _ in range(_ROUNDS):
        made, seam = _mesh_without_notches(body, present, size, sizes, keeps_skin=bool(found))
        seams.append(seam)
        points, in_plane = _keep_planes(body, made, table)
        skin = np.unique(made.faces)
        normals = nodal_areas(points, made.faces)[skin]
        places = locate_on_skin(body.points, body.faces, points[skin], normals)
        placed = place_skin(body, points, made.faces, in_plane, places)
        points = spread_moves(made.points, made.cells, skin, placed.points)
        points = improve_cells(points, made.cells, skin, WANTED)
        worst = float(measure_quality(points, made.cells).min())
        if worst < LEAST_QUALITY:
            points = slide_on_tools(points, made.cells, skin, placed.on_tool, in_plane, body.obstacles, LEAST_QUALITY)
            placed = restore_volume(body, points, made.faces, placed.on_tool, in_plane)
            points = improve_cells(placed.points, made.cells, skin, WANTED)
            worst = float(measure_quality(points, made.cells).min())
        first_set = len(body.planes)
        sets = {name: made.faces[table[made.number, first_set + column]] for column, name in enumerate(body.sets)}
        all_seams = np.concatenate(seams)
        new = NewBody(
            points, made.cells, made.faces, sets, placed.on_tool, skin, body.faces[places.face], places.share,
            placed.offset, all_seams,
        )  # fmt: skip
        slow = bool(found) and worst < found[-1][1] + _PROGRESS
        found.append((new, worst))
        if worst >= LEAST_QUALITY or slow:
            break
        # the skin goes as far as cells allow, and the rest of its displacement is made on a mesh of that
        points = improve_cells(retreat(made.points, points, made.cells), made.cells, skin, WANTED)
        present = FilledBody(points, made.cells, made.faces, made.number)
        size = measure_sizes(body, sizes, points)
    return max(found, key=lambda own: own[1])


def _mesh_without_notches(
    body: OldBody, present: FilledBody, size: FloatArray, sizes: EdgeSizes, *, keeps_skin: bool
) -> tuple[FilledBody, FloatArray]:
    """Return a mesh to size, its notches filled, and the corners of the faces that lie inside now (3 k, 3).

    A skin that overlaps itself where it has folded comes out with new notches, which are filled in turn.
    """
    planes, seams = list_planes(body), [np.zeros((0, 3))]
    for attempt in range(_FILLINGS):
        if not keeps_skin:
            filling = fill_notches(present, planes, body.obstacles)
            if attempt and not filling.added:
                break
            present = filling.body
            seams.append(filling.seam)
            size = measure_sizes(body, sizes, present.points) if attempt else size
        largest, away = float(size.max()), AWAY * sizes.largest
        present = mesh_to_size(
            present, size, smallest=sizes.smallest, largest=largest, away=away, keeps_skin=keeps_skin
        )
        if keeps_skin:
            break
    return present, np.concatenate(seams)


def _keep_planes(body: OldBody, made: FilledBody, table: BoolArray) -> tuple[FloatArray, BoolArray]:
    """Return the points with those in planes exactly there, and which coordinates planes hold (n, 3)."""
    points, in_plane = made.points.copy(), np.zeros(made.points.shape, dtype=bool)
    for column, (axis, level, _) in enumerate(body.planes):
        nodes = np.unique(made.faces[table[made.number, column]])
        points[nodes, axis] = level
        in_plane[nodes, axis] = True
    return points, in_plane


def retreat(start: FloatArray, end: FloatArray, cells: IndexArray) -> FloatArray:
    """Return nodes as far on their paths from start to end (n, 3) [mm] as leaves no cell flat or inside out.

    A cell that is flat at the start may lose half of its quality.
    """
    part, least = np.ones(len(start)), np.minimum(LEAST_QUALITY, 0.5 * measure_quality(start, cells))
    for _ in range(_HALVINGS):
        points = start + part[:, None] * (end - start)
        bad = measure_quality(points, cells) < least
        if not bad.any():
            return points
        part[np.unique(cells[bad])] *= 0.5
    return start
