# SPDX-License-Identifier: Apache-2.0
"""How long edges of tetrahedra may be where: the least of what the tools' radii, ridges and slots and the thickness
of the metal ask for, growing from there by no more than the gradation, within a budget of cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray
from presswork.remesh.size_field import GRADATION, SizeSources, grade, join_sources
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.fill import expect_cells
from presswork.remesh.space.tetrahedra import area_vectors

OF_RADIUS = 0.4
OF_GAP = 0.25
OF_WIDTH = 0.5
"""Size over the width of a tool's ridge or slot: metal follows or enters it with two edges across."""
REACH = 2.0
"""Cells of the largest size ahead of contact over which a tool's radius counts."""
LEAST_ACROSS = 1.5
"""Cells across the metal below which a budget is too small."""
OF_SKIN = 0.02
"""Share of the skin's area that may be thinner."""
_OPPOSITE = 0.8
"""Least cosine between a face's normal and that of one opposite to it, reversed."""


@dataclass(frozen=True)
class EdgeSizes:
    """Bounds of the edges, and how many cells there may be."""

    largest: float
    """[mm]"""
    smallest: float
    """[mm]"""
    max_cells: int


def measure_sizes(body: OldBody, sizes: EdgeSizes, points: FloatArray | None = None) -> FloatArray:
    """Return the length of edges asked for at points (n, 3), or at the nodes of the body (n,) [mm].

    Where max_cells would be exceeded, all become longer. Raises MeshError where that leaves too few across the metal.
    """
    sources = [_ask_for_gaps(body, sizes)]
    for ask in (_ask_for_radii, _ask_for_widths):
        sources += [ask(body, tool, sizes) for tool in range(len(body.tools))]
    all_sources = join_sources(*sources)
    at_nodes = grade(body.points, all_sources, sizes.largest, sizes.smallest)
    factor = _find_factor(body, at_nodes, sizes)
    return factor * (at_nodes if points is None else grade(points, all_sources, sizes.largest, sizes.smallest))


def _find_factor(body: OldBody, size: FloatArray, sizes: EdgeSizes) -> float:
    """Return the factor on all sizes that keeps the budget."""
    factor = max(1.0, float(np.cbrt(expect_cells(body.points, body.cells, size) / sizes.max_cells)))
    if factor == 1.0:
        return factor
    thinnest = _find_thinnest(body, LEAST_ACROSS * factor * sizes.largest)
    if thinnest < LEAST_ACROSS * factor * max(OF_GAP * thinnest, sizes.smallest):
        raise MeshError(
            f"{sizes.max_cells} cells are too few: fewer than {LEAST_ACROSS} lie across metal of {thinnest:.3g} mm",
            "larger max_cells",
        )
    return factor


def _find_thinnest(body: OldBody, reach: float) -> float:
    """Return the thickness that OF_SKIN of the skin's area is thinner than [mm]; infinite beyond reach.

    Every sharp edge of a body is as thin as one likes, and no cells can lie across it.
    """
    thickness, area = measure_thickness(body, reach), np.linalg.norm(area_vectors(body.points, body.faces), axis=1)
    order = np.argsort(thickness)
    thin = np.cumsum(area[order]) > OF_SKIN * area.sum()
    return float(thickness[order[np.argmax(thin)]])


def measure_thickness(body: OldBody, reach: float) -> FloatArray:
    """Return how thick the metal is beneath each face (k,) [mm]; infinite beyond reach, and for faces in planes.

    The thickness is the distance along the normal of the nearest face with the opposite direction, or of its own image
    beyond a plane.
    """
    faces = np.flatnonzero(~body.in_plane)
    corners = body.points[body.faces[faces]]
    middle, normal = corners.mean(axis=1), body.normals[faces]
    radius = np.sqrt(((corners - middle[:, None]) ** 2).sum(axis=2)).max(axis=1)
    result = np.full(len(body.faces), np.inf)
    found = np.asarray(_core.measure_thickness(middle, normal, radius, reach=reach, opposite=_OPPOSITE))
    for axis, level, _ in body.planes:
        away = np.abs(middle[:, axis] - level)
        outwards = normal[:, axis] * np.sign(middle[:, axis] - level)
        own = (outwards > _OPPOSITE) & (2.0 * away < reach)
        found[own] = np.minimum(found[own], 2.0 * away[own])
    result[faces] = found
    return result


def _ask_for_gaps(body: OldBody, sizes: EdgeSizes) -> SizeSources:
    """Return a quarter of the metal's thickness at the middle and the corners of each face."""
    thickness = measure_thickness(body, sizes.largest / OF_GAP)
    known = np.isfinite(thickness)
    corners = body.points[body.faces[known]]
    place = np.concatenate([corners.mean(axis=1)[:, None], corners], axis=1)
    return SizeSources(place.reshape(-1, 3), np.repeat(OF_GAP * thickness[known], 4))


def _ask_for_radii(body: OldBody, tool: int, sizes: EdgeSizes) -> SizeSources:
    """Return a part of the radii of a tool's bends where the skin is near them."""
    place, radius = body.tools[tool].list_radii(sizes.smallest)
    return _ask_near_skin(body, place, OF_RADIUS * radius, sizes)


def _ask_for_widths(body: OldBody, tool: int, sizes: EdgeSizes) -> SizeSources:
    """Return a part of the widths of a tool's ridges and slots where the skin is near them."""
    widths = body.tools[tool].widths
    return _ask_near_skin(body, widths.place, OF_WIDTH * widths.width, sizes)


def _ask_near_skin(body: OldBody, place: FloatArray, size: FloatArray, sizes: EdgeSizes) -> SizeSources:
    """Return sizes asked for at places on a tool (n, 3) that the skin is near; those farther off may wait."""
    wanted = np.maximum(size, sizes.smallest)
    place, wanted = place[wanted < sizes.largest], wanted[wanted < sizes.largest]
    if not len(place):
        return SizeSources(place, wanted)
    distance, _ = body.skin_tree.query(place, distance_upper_bound=REACH * sizes.largest)
    near = np.isfinite(distance)
    growth = GRADATION * np.maximum(distance[near] - sizes.largest, 0.0)
    return SizeSources(place[near], wanted[near] + growth)
