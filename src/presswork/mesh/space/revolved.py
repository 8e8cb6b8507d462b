# SPDX-License-Identifier: Apache-2.0
"""Hexahedra of a plane mesh of quadrilaterals that is turned about z, whole or a sector."""

from __future__ import annotations

import math

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.make.box import SIDES, corner_volumes, finish_mesh
from presswork.mesh.space.disc import point_at, reach_of_kite
from presswork.model import BoolArray, FloatArray, IntArray, Mesh, SpaceElement

ON_AXIS = 1e-9
"""How far nodes on the axis may lie off it, over the size of the plane mesh."""
_OF_BOX = {name for pair in SIDES for name in pair} | {"all", "boundary"}


def mesh_revolved(plane: Mesh, *, angle: float, around: int, element: SpaceElement, material: int = 0) -> Mesh:
    """Turn a plane mesh of quadrilaterals in r and z about the z axis, from the x axis towards y.

    angle [degrees], at most 360. around: number of cells, on a body with an axis a multiple of 2 in each 90 degrees.
    There two neighbours become one cell with four sides, whose outer corner moves outwards. Sets beside those of a
    box: first_plane and last_plane of a sector, and the plane mesh's own groups. Raises MeshError.
    """
    points, on_axis = _find_axis(plane)
    quads = np.concatenate([block.connectivity for block in plane.blocks])
    touches = on_axis[quads].any(axis=1)
    at_axis = _begin_on_axis(points, quads[touches], on_axis)
    least = 2 * math.ceil(angle / 90.0 - 1e-9)
    if len(at_axis) and around % least:
        fault = f"{around} cells around {angle:g} degrees of a body that touches the axis"
        raise MeshError(fault, f"give a multiple of {least}")
    closed = angle > 360.0 * (1 - 1e-12)
    count = np.where(on_axis, 1, around if closed else around + 1)
    column = np.arange(around + 1) % count[:, None]
    number = column + (np.cumsum(count) - count)[:, None]  # (n, around + 1)
    radius = np.repeat(points[:, :1], around + 1, axis=1)
    radius[np.unique(at_axis[:, 2:]), 1::2] *= reach_of_kite(math.radians(2.0 * angle / around))
    degrees = np.broadcast_to(angle * np.arange(around + 1) / around, radius.shape)
    made = np.empty((int(count.sum()), 3))
    keep = slice(None, -1) if closed else slice(None)
    plan = point_at(radius.ravel(), degrees.ravel()).reshape(*radius.shape, 2)
    made[number[:, keep], :2] = plan[:, keep]
    made[number, 2] = points[:, 1:]
    cells = _turn(quads[~touches], number)
    if len(at_axis):
        cells = np.concatenate([cells, _turn_at_axis(at_axis, number)])
    if corner_volumes(made, cells).min() <= 0.0:
        raise MeshError(f"cells at the axis fold with {around} cells around {angle:g} degrees", "give more around")
    sets = {name: number[nodes] for name, nodes in plane.node_sets.items() if name not in _OF_BOX}
    if not closed:
        sets |= {"first_plane": number[:, 0], "last_plane": number[:, -1]}
    named = {name: np.unique(nodes).astype(np.int32) for name, nodes in sets.items()}
    return finish_mesh(made, cells.astype(np.int32), named, element, material)


def _find_axis(plane: Mesh) -> tuple[FloatArray, BoolArray]:
    """Return points (n, 2) in r and z, and which lie on the axis (n,). Raises MeshError."""
    points = plane.points.copy()
    tolerance = ON_AXIS * float(np.linalg.norm(np.ptp(points, axis=0)))
    if points[:, 0].min() < -tolerance:
        raise MeshError("the section has nodes at x < 0", "draw the half at x >= 0; x is the radius, y the height")
    on_axis = points[:, 0] <= tolerance
    points[on_axis, 0] = 0.0
    return points, on_axis


def _begin_on_axis(points: FloatArray, quads: IntArray, on_axis: BoolArray) -> IntArray:
    """Return quadrilaterals (m, 4) that touch the axis, each beginning with its edge there. Raises MeshError."""
    marks = on_axis[quads]
    along = marks & np.roll(marks, -1, axis=1)
    wrong = np.flatnonzero((marks.sum(axis=1) != 2) | ~along.any(axis=1))
    if len(wrong):
        r, z = points[quads[wrong[0]]].mean(axis=0)
        fault = f"the cell near ({r:.6g}, {z:.6g}) touches the axis, and not by one edge"
        raise MeshError(fault, "mesh the section so that cells at the axis have one edge there")
    turned = (np.argmax(along, axis=1)[:, None] + np.arange(4)) % 4
    return np.take_along_axis(quads, turned, axis=1)


def _turn(quads: IntArray, number: IntArray) -> IntArray:
    """Return the hexahedra (n, 8) between the columns of quadrilaterals beside the axis."""
    here, there = number[quads, :-1], number[quads, 1:]  # (m, 4, around)
    return np.concatenate([there, here], axis=1).transpose(0, 2, 1).reshape(-1, 8)


def _turn_at_axis(quads: IntArray, number: IntArray) -> IntArray:
    """Return the hexahedra (n, 8) of quadrilaterals that begin with an edge on the axis; each spans two columns."""
    top, bottom, outer_bottom, outer_top = number[quads].transpose(1, 0, 2)
    levels = [
        np.stack([axis[:, :-1:2], outer[:, :-1:2], outer[:, 1::2], outer[:, 2::2]], axis=-1)
        for axis, outer in ((bottom, outer_bottom), (top, outer_top))
    ]
    return np.concatenate(levels, axis=-1).reshape(-1, 8)
