# SPDX-License-Identifier: Apache-2.0
"""Tools in space that slide along each other with a clearance far below the size of cells.

As in the plane (case/tools/close_fits.py), the side of such a tool is moved past the wall, so that its face takes the
nodes at the wall along. A swept profile moves as a whole where the wall surrounds it, and stays exact. In a surface of
facets each corner of the side moves so far that all the planes of the side's facets there move by the same length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswork.case.space.tool_checks import mean_edge
from presswork.case.tools.close_fits import CLOSE, PARALLEL, PAST, find_middle, find_relative_direction, move_side
from presswork.geometry.pose import SpacePose, find_space_pose
from presswork.geometry.segments import X1
from presswork.geometry.swept_tool import triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.triangles import double_areas
from presswork.model import (
    BoolArray,
    FloatArray,
    Mesh,
    Plane,
    Profile,
    Stage,
    Surface,
    SweptProfile,
    Tool,
    Triangulation,
)

AHEAD = 0.5
"""Least component of a facet's normal along the tool's motion that makes it a part of the face: up to 60 degrees
aslant."""
FACES = -0.7
"""Product of the normals of wall and side below which they face each other."""
ROUND = 16
"""Places round each corner of a swept tool's plan."""
CHORD = 1e-3
"""How far facets that stand for a swept profile may lie off it, over the edge of cells."""


def close_fits_in_space(
    tools: Sequence[Tool], stages: Sequence[Stage], mesh: Mesh
) -> tuple[tuple[Tool, ...], list[str]]:
    """Return the tools with the clearances closed that cells cannot flow into, and a warning of each."""
    found, warnings = list(tools), []
    edge, middle = mean_edge(mesh) if len(tools) > 1 else 0.0, find_middle(mesh.points)
    for number, tool in enumerate(tools):
        for other in tools:
            if other is tool or isinstance(tool.surface, Plane):
                continue
            direction = find_relative_direction(tool, other, stages, 3)
            closed = (
                _close(found[number], _Wall(other, direction, middle, edge), direction, edge)
                if direction.any()
                else None
            )
            if closed is not None:
                shape, gap = closed
                found[number] = replace(found[number], shape=shape)
                warnings.append(
                    f"tools.{tool.name}: its side stands {gap:.3g} mm from tools.{other.name}, beside cells of "
                    f"{edge:.3g} mm that cannot flow into this gap: it is computed without clearance"
                )
    return tuple(found), warnings


class _Wall:
    """A tool along which another one slides."""

    def __init__(self, tool: Tool, direction: FloatArray, middle: FloatArray, edge: float) -> None:
        self._surface, self._pose = make_surface(tool.surface), find_space_pose(tool, np.zeros(3))
        self._direction, self._middle, self._reach = direction, middle, CLOSE * edge

    def look(self, places: FloatArray, outwards: FloatArray) -> tuple[BoolArray, FloatArray]:
        """Return which places of a side (n, 3) go along the wall towards the workpiece, and their gaps (n,) [mm].

        outwards: normals of the side (n, 3).
        """
        gap, normal, *_ = self._surface.nearest(np.ascontiguousarray(self._pose.to_frame(places)))
        normal = self._pose.turn(normal)
        faces = np.einsum("ni,ni->n", normal, outwards) < FACES
        comes = (self._middle - places) @ self._direction > 0.0
        return (np.abs(gap) <= self._reach) & (np.abs(normal @ self._direction) < PARALLEL) & faces & comes, gap


def _close(tool: Tool, wall: _Wall, direction: FloatArray, edge: float) -> tuple[Surface, float] | None:
    """Return a tool's shape with its side past a wall, and the gap that was [mm]; None where no side is close."""
    pose, shape = find_space_pose(tool, np.zeros(3)), tool.surface
    if isinstance(shape, SweptProfile):
        own_direction = pose.turn(np.eye(3)[2:])[0] @ direction
        swept = _close_swept(shape, wall, pose, own_direction, edge) if abs(own_direction) > 1.0 - PARALLEL**2 else None
        if swept is not None or not np.isfinite(shape.half_widths).all():
            return swept
        shape = Triangulation(*triangulate(shape, CHORD * edge), False)
    assert isinstance(shape, Triangulation)
    return _close_facets(shape, wall, pose, direction, edge)


def _close_swept(
    shape: SweptProfile, wall: _Wall, pose: SpacePose, own_direction: float, edge: float
) -> tuple[SweptProfile, float] | None:
    """Close a swept profile along whose side the wall goes all round; own_way: z of the tool's motion in its frame."""
    for corner, (s, z) in enumerate(shape.segments[:-1, X1]):
        places, outwards = _go_round(shape, s, z)
        for side in (1.0, -1.0):
            near, gap = wall.look(pose.carry(places), pose.turn(side * outwards))
            if not near.all():
                continue
            by, most = np.array([side, 0.0]), max(float(gap.max()), 0.0)
            moved = move_side(
                Profile(shape.segments), corner, np.array([0.0, own_direction]), (most + PAST * edge) * by
            )
            if moved is not None:
                return replace(shape, segments=moved.segments), most
    return None


def _go_round(shape: SweptProfile, s: float, z: float) -> tuple[FloatArray, FloatArray]:
    """Return places round the plan at a point of the profile (n, 3), and the plan's outward normals there (n, 3)."""
    angle = np.linspace(0.0, 2.0 * np.pi, 4 * ROUND, endpoint=False) + 1e-9
    outwards = np.column_stack([np.cos(angle), np.sin(angle)])
    widths = np.array([w if np.isfinite(w) else shape.corner_radius for w in shape.half_widths])
    places = (widths - shape.corner_radius) * np.sign(outwards) + (shape.corner_radius + s) * outwards
    return np.insert(places, 2, z, axis=1), np.insert(outwards, 2, 0.0, axis=1)


def _close_facets(
    shape: Triangulation, wall: _Wall, pose: SpacePose, direction: FloatArray, edge: float
) -> tuple[Triangulation, float] | None:
    """Close the side of a tool of facets where it meets the tool's face at the wall."""
    areas = pose.turn(double_areas(shape.points, shape.triangles))
    normals = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-300)
    of_face = np.zeros(len(shape.points), dtype=bool)
    of_face[shape.triangles[normals @ direction > AHEAD]] = True
    sides = np.flatnonzero((np.abs(normals @ direction) < PARALLEL) & of_face[shape.triangles].any(axis=1))
    if not len(sides):
        return None
    corners, outwards = shape.triangles[sides], np.repeat(normals[sides], 3, axis=0)
    near, gap = wall.look(pose.carry(shape.points[corners.ravel()]), outwards)
    near &= of_face[corners.ravel()]
    if not near.any():
        return None
    most = max(float(gap[near].max()), 0.0)
    own = near.reshape(-1, 3).any(axis=1)
    moving, normal = corners[own], normals[sides[own]]
    products, wanted = np.zeros((len(shape.points), 3, 3)), np.zeros((len(shape.points), 3))
    for corner in moving.T:
        np.add.at(products, corner, normal[:, :, None] * normal[:, None, :])
        np.add.at(wanted, corner, (most + PAST * edge) * normal)
    moves = np.unique(moving)
    by = np.einsum("nij,nj->ni", np.linalg.pinv(products[moves], rcond=1e-6, hermitian=True), wanted[moves])
    points = pose.carry(shape.points)
    points[moves] += by
    return replace(shape, points=np.ascontiguousarray(pose.to_frame(points))), most
