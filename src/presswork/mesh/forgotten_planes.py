# SPDX-License-Identifier: Apache-2.0
"""Flat sides of a workpiece that look like symmetry planes, and on which nothing acts.

Such a side lies in a coordinate plane, or in a plane through the z axis, and the whole workpiece on one side of it.
It looks like a symmetry plane in three cases. A side that meets it at the origin is one. The program has meshed a
sector. A tool of finite extent is symmetric about it; or ends at it, and goes on far beyond the workpiece's other side.
It is none where such a tool reaches over it and has no mirror image of itself there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from presswork.geometry.blocked_motion import blocks_motion
from presswork.geometry.pose import find_space_pose, start_profile
from presswork.geometry.segments import sample_points
from presswork.geometry.tool_surface import list_extreme_points
from presswork.model import FloatArray, IntArray, Model, Plane, Profile, Stage, Tool, take_corners

FLAT = 1e-6
"""How far a side may lie off its plane, and that off the origin, over the size of the workpiece."""
ACROSS = 0.1
"""Part of a unit vector along a normal from which on it counts as going along it."""
OVER, BEYOND = 0.25, 0.5
"""Widths of the workpiece by which a tool may reach over the plane where it ends, and must reach beyond it inwards."""
ENDLESS = 4.0
"""Sizes of the workpiece beyond which, to both sides, a tool is drawn without end."""
MORE = 4.0
"""Distance that a tool must reach beyond the other side, over its reach over the plane."""


@dataclass(frozen=True)
class FlatSide:
    """A flat side of the workpiece."""

    normal: FloatArray
    """Unit vector out of the workpiece (d,)."""
    nodes: IntArray

    @property
    def axis(self) -> int | None:
        """The coordinate that is constant on it; None where it is slanted."""
        axis = int(np.argmax(np.abs(self.normal)))
        return axis if abs(self.normal[axis]) > 1.0 - 1e-9 else None

    def describe(self, mesh_sets: dict[str, IntArray]) -> str:
        """Name its place, and its node set where it has one."""
        names = [name for name, nodes in mesh_sets.items() if np.array_equal(np.sort(nodes), self.nodes)]
        place = f"the plane {'xyz'[self.axis]} = 0" if self.axis is not None else "a plane through the z axis"
        return place + (f" (set {names[-1]!r})" if names else "")


def find_forgotten_planes(model: Model) -> list[FlatSide]:
    """Return the flat sides that look like symmetry planes, and that nothing holds, loads or stands before."""
    if model.analysis == "shell" or (model.heat is not None and model.heat.alone) or model.formed is not None:
        return []
    sides = list(_list_sides(model))
    strokes = _list_strokes(model)
    bare = [side for side in sides if _is_bare(model, side) and not (np.abs(strokes @ side.normal) > ACROSS).any()]
    held = [side for side in sides if _is_held(model, side)]
    is_sector = "first_plane" in model.mesh.node_sets
    if is_sector:
        return bare
    return [
        side for side in bare if (_has_partner(side, held) or _has_tool(model, side)) and not _is_crossed(model, side)
    ]


def _list_sides(model: Model) -> Iterator[FlatSide]:
    """Yield the flat sides in coordinate planes and in planes through the z axis, all the mesh on one side of each."""
    points = model.mesh.points
    tolerance = FLAT * float(np.linalg.norm(np.ptp(points, axis=0)))
    for normal in _list_normals(model, tolerance):
        height = points @ normal
        if height.max() <= tolerance:
            nodes = np.flatnonzero(height >= -tolerance)
            yield FlatSide(normal, nodes.astype(np.int32))


def _list_normals(model: Model, tolerance: float) -> list[FloatArray]:
    """Return unit vectors along which flat sides through the origin may lie."""
    mesh, d = model.mesh, model.mesh.points.shape[1]
    axes = range(2) if model.analysis == "stamping" else range(d)
    found = [sign * np.eye(d)[axis] for axis in axes for sign in (-1.0, 1.0)]
    if model.analysis == "axisymmetric":
        found = [normal for normal in found if normal[0] == 0.0]  # nodes on the axis are held, or the case is refused
    if not len(mesh.boundary_faces):
        return [n for n in found if _has_area(mesh.points, mesh.boundary_edges[:, :2], n, tolerance)]
    corners = mesh.points[take_corners(mesh.boundary_faces)]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    through = np.abs(np.einsum("nki,ni->nk", corners, normals)).max(axis=1) <= tolerance
    slanted = normals[through & (np.abs(normals[:, 2]) < 1e-6) & (np.abs(normals).max(axis=1) < 1.0 - 1e-9)]
    for normal in slanted:
        if all(normal @ other < 1.0 - 1e-9 for other in found):
            found.append(normal)
    return [n for n in found if (through & (normals @ n > 1.0 - 1e-6)).any()]


def _has_area(points: FloatArray, edges: IntArray, normal: FloatArray, tolerance: float) -> bool:
    """Return whether boundary edges (n, 2) lie in the plane through the origin across a normal."""
    return bool((np.abs(points[edges] @ normal) <= tolerance).all(axis=1).any())


def _list_strokes(model: Model) -> FloatArray:
    """Return the unit vectors along which tools move or push (n, d)."""
    d, found = model.mesh.points.shape[1], []
    for motion in (motion for stage in model.stages for motion in stage.tool_motion.values()):
        direction = np.array(motion.push.direction if motion.push else motion.move)[:d]
        if direction.any():
            found.append(direction / np.linalg.norm(direction))
    return np.array(found).reshape(-1, d)


def _is_held(model: Model, side: FlatSide) -> bool:
    """Return whether supports hold the whole side along its normal, and no more than that: as a symmetry plane."""
    for support in model.supports:
        if not np.isin(side.nodes, model.mesh.node_sets[support.node_set]).all():
            continue
        if support.normal is not None and abs(np.dot(support.normal, side.normal)) > 1.0 - 1e-9:
            return True
        if support.normal is None and side.axis is not None and support.fix[side.axis]:
            others = [fixed for axis, fixed in enumerate(support.fix[: len(side.normal)]) if axis != side.axis]
            return not any(others)
    cyclic = model.cyclic
    sets = model.mesh.node_sets
    return cyclic is not None and any(np.array_equal(side.nodes, sets[name]) for name in (cyclic.first, cyclic.last))


def _is_bare(model: Model, side: FlatSide) -> bool:
    """Return whether nothing holds a node of a side along its normal, loads the side or lies before it."""
    mesh, sets = model.mesh, model.mesh.node_sets
    along = np.abs(side.normal) > ACROSS
    for support in model.supports:
        holds = support.normal is not None and abs(np.dot(support.normal, side.normal)) > ACROSS
        holds = holds or (support.normal is None and any(np.array(support.fix[: len(along)]) & along))
        if holds and _share_inside(side, sets[support.node_set], model):
            return False
    for stage in model.stages:
        for p in stage.prescribed:
            if p.component < len(along) and along[p.component] and _share_inside(side, sets[p.node_set], model):
                return False
        if any(np.isin(nodes, side.nodes).all() for nodes in _list_loaded(model, stage)):
            return False
    if model.cyclic is not None and any(
        np.array_equal(side.nodes, sets[name]) for name in (model.cyclic.first, model.cyclic.last)
    ):
        return False
    return not any(blocks_motion(tool, mesh.points[side.nodes], side.normal) for tool in model.tools)


def _share_inside(side: FlatSide, nodes: IntArray, model: Model) -> bool:
    """Return whether a held set has nodes of a side, those aside that it has for a side that meets this one."""
    common = np.intersect1d(side.nodes, nodes)
    if not len(common):
        return False
    places = model.mesh.points[nodes]
    size = float(np.linalg.norm(np.ptp(model.mesh.points, axis=0)))
    spread = float(np.ptp(places @ side.normal))
    return len(common) == len(nodes) or spread <= FLAT * size


def _list_loaded(model: Model, stage: Stage) -> Iterator[IntArray]:
    """Yield the nodes of the sets that a stage loads."""
    mesh = model.mesh
    yield from (mesh.node_sets[load.node_set] for load in stage.forces)
    edges = [*(p.edge_set for p in stage.pressures), *(f.edge_set for f in stage.edge_forces)]
    faces = [*(p.face_set for p in stage.face_pressures), *(f.face_set for f in stage.face_forces)]
    yield from (np.unique(mesh.edge_sets[name]) for name in edges)
    yield from (np.unique(mesh.face_sets[name]) for name in faces)


def _has_partner(side: FlatSide, held: list[FlatSide]) -> bool:
    """Return whether a symmetry plane meets a side at an angle that divides the whole turn."""
    for other in held:
        inside = np.degrees(np.pi - np.arccos(np.clip(side.normal @ other.normal, -1.0, 1.0)))
        parts = 360.0 / max(float(inside), 1e-3)
        is_upright = len(side.normal) == 2 or (abs(side.normal[2]) < ACROSS and abs(other.normal[2]) < ACROSS)
        if is_upright and 2.5 < parts < 100.0 and abs(parts - round(parts)) < 0.01 * parts:
            return True
    return False


def _has_tool(model: Model, side: FlatSide) -> bool:
    """Return whether a tool of finite extent is symmetric about a side's plane, or ends there and reaches inwards."""
    for low, over, width in _list_reaches(model, side):
        beyond = -width - low
        ends_there = -FLAT * width <= over <= OVER * width and beyond > max(BEYOND * width, MORE * over)
        if (_is_symmetric(low, over, width) and over > FLAT * width) or ends_there:
            return True
    return False


def _is_crossed(model: Model, side: FlatSide) -> bool:
    """Return whether a tool of finite extent reaches over a side's plane, and not as far as to the other side of it."""
    reaches = _list_reaches(model, side)
    return any(over > OVER * width and not _is_symmetric(low, over, width) for low, over, width in reaches)


def _is_symmetric(low: float, over: float, width: float) -> bool:
    return abs(low + over) < 1e-3 * width


def _list_reaches(model: Model, side: FlatSide) -> Iterator[tuple[float, float, float]]:
    """Yield from where to where each tool of finite extent reaches along a side's normal, and the workpiece's width."""
    if side.axis is None:
        return
    points = model.mesh.points
    heights, far = points @ side.normal, ENDLESS * float(np.linalg.norm(np.ptp(points, axis=0)))
    for reach in (_reach(tool, side.normal) for tool in model.tools):
        if reach is not None and (reach[0] > -far or reach[1] < far):
            yield *reach, float(np.ptp(heights))


def _reach(tool: Tool, normal: FloatArray) -> tuple[float, float] | None:
    """Return from where to where a tool reaches along a normal where it starts [mm]; None of a plane without end."""
    shape = tool.shape
    if isinstance(shape, Plane):
        return None
    if isinstance(shape, Profile):
        places = sample_points(start_profile(tool))
    else:
        places = find_space_pose(tool, np.zeros(3)).carry(list_extreme_points(shape))
    heights = places @ normal
    return (float(heights.min()), float(heights.max())) if np.isfinite(heights).all() else None
