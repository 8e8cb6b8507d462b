# SPDX-License-Identifier: Apache-2.0
"""What is checked of tools in space before anything is computed: facets, symmetry, and cells against radii."""

from __future__ import annotations

import logging

import numpy as np

from presswork.case.errors import Problem
from presswork.geometry.asymmetry import HalfSpace, find_asymmetry
from presswork.geometry.crossing_facets import find_crossing_facets
from presswork.geometry.mirrored import WITHIN, complete_tool
from presswork.geometry.pose import SpacePose, find_space_pose
from presswork.geometry.segments import CENTRE, TURN, X0
from presswork.geometry.swept_tool import triangulate
from presswork.geometry.tool_radius import find_least_radius
from presswork.geometry.tool_surface import make_surface
from presswork.geometry.tool_widths import find_widths
from presswork.mesh.triangles import find_rims
from presswork.model import (
    FloatArray,
    IndexArray,
    Mesh,
    Plane,
    SweptProfile,
    Tool,
    Triangulation,
    find_cell,
    take_corners,
)

logger = logging.getLogger(__name__)

HOLE = 2.0
"""Width of a rim over a cell's edge below which it is a hole where facets are missing; no nodes pass through it."""
OPEN = 0.5
"""Width of a rim over the tool's own size above which the surface ends there, however small the tool."""
UNLIKE = 1e-3
"""How far the two halves of a tool that a symmetry plane cuts may differ, over the size of the workpiece."""
OVER = 0.1
"""How far a tool that is no mirror image of itself may reach over the plane, over the size of the workpiece."""
COARSE = 0.75
"""Edge of a cell over a tool's radius above which the edge is too long: it turns by more than 43 degrees."""
EDGES = 5.0
"""Cells along a radius from which on it counts."""
ENOUGH = 0.5
"""Edge of a cell over a tool's radius that is short enough: it turns by 29 degrees."""
LOOKS = (-0.6, 0.0, 0.6)
"""Where faces are looked at beside their corners, from -1 to 1."""


def mean_edge(mesh: Mesh) -> float:
    """Return the mean length of the edges of boundary faces [mm]."""
    corners = mesh.points[take_corners(mesh.boundary_faces)]
    return float(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).mean())


def look_inside_faces(mesh: Mesh) -> tuple[FloatArray, IndexArray]:
    """Return places inside the boundary faces, and on their edges (n, 3) [mm], and the face of each (n,)."""
    corners = mesh.points[take_corners(mesh.boundary_faces)]
    edges = 0.5 * (corners + np.roll(corners, -1, axis=1))
    face = np.arange(len(corners))
    places, faces = [edges.reshape(-1, 3), corners.mean(axis=1)], [np.repeat(face, corners.shape[1]), face]
    if not find_cell(2, mesh.boundary_faces).is_simplex:
        for r in LOOKS:
            for s in LOOKS:
                weights = 0.25 * np.array([(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)])
                places.append(np.einsum("k,nki->ni", weights, corners))
                faces.append(face)
    return np.concatenate(places), np.concatenate(faces)


def check_facets(name: str, path: str, shape: Triangulation, edge: float) -> Problem | None:
    """Return a problem of facets that cross or lie on each other, or that are missing; edge: of cells [mm]."""
    crossing = find_crossing_facets(shape.points, shape.triangles)
    if crossing is not None:
        place = ", ".join(f"{x:.4g}" for x in crossing.place)
        fault = f"facets pass through each other or lie on each other, the first two at ({place}) mm"
        remedy = "join the bodies in the CAD program, and export their outer surface alone"
        return Problem(f"tools.{name}.path", fault, remedy, path)
    rims = [] if shape.is_closed else find_rims(shape.points, shape.triangles)
    largest = min(HOLE * edge, OPEN * float(np.linalg.norm(np.ptp(shape.points, axis=0))))
    holes = [rim for rim in rims if np.linalg.norm(np.ptp(shape.points[rim], axis=0)) < largest]
    if holes:
        place = ", ".join(f"{x:.4g}" for x in shape.points[holes[0]].mean(axis=0))
        fault = f"facets are missing: {len(holes)} holes are narrower than two cells, the first at ({place}) mm"
        return Problem(f"tools.{name}.path", fault, "close the holes in the CAD program", path)
    return None


def check_mirrors(
    name: str, tool: Tool, start: SpacePose, mirrors: tuple[FloatArray, ...], cut: tuple[bool, ...], nodes: FloatArray
) -> Problem | None:
    """Return a problem where a symmetry plane cuts a tool whose halves differ beside the workpiece.

    A tool that ends at the plane, or a little beyond, has no other half, and is taken for the half of one.
    """
    shape = tool.surface
    if isinstance(shape, Plane):  # an inclined one is half of a notch
        return None
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    surface, window = make_surface(shape), (nodes.min(axis=0) - size, nodes.max(axis=0) + size)
    places = start.carry(_sample(shape, UNLIKE * size))

    def measure(at: FloatArray) -> FloatArray:
        return np.asarray(surface.nearest(np.ascontiguousarray(start.to_frame(at)))[0])

    for axis in np.flatnonzero(cut):
        plane = float(mirrors[axis][0])
        half = HalfSpace(int(axis), plane, 1.0 if nodes[:, axis].mean() > plane else -1.0)
        found = find_asymmetry(places, measure, half, window, OVER * size, UNLIKE * size)
        if found is not None:
            return Problem(
                f"tools.{name}",
                f"the symmetry plane {'xyz'[axis]} = {plane:g} cuts this tool, but {found.describe()}",
                "move the tool so that the plane halves it, end the tool at it, or model the whole workpiece",
            )
    return None


def _sample(shape: SweptProfile | Triangulation, tolerance: float) -> FloatArray:
    """Return points on a surface (n, 3) [mm]."""
    if isinstance(shape, SweptProfile):
        points, triangles = triangulate(shape, tolerance)
    else:
        points, triangles = shape.points, shape.triangles
    return np.concatenate([points, points[triangles].mean(axis=1)])


def warn_of_radius(name: str, segments: FloatArray, edge: float, key: str) -> None:
    """Warn where cells with such edges [mm] are too coarse for the smallest radius of a tool's profile (n, 7).

    key: what they are.
    """
    arcs = segments[segments[:, TURN] != 0.0]
    radii = np.linalg.norm(arcs[:, X0] - arcs[:, CENTRE], axis=1)
    _warn_of_sharp_radius(name, float(radii.min(initial=np.inf)), edge, key)


def warn_of_facets(name: str, tool: Tool, mesh: Mesh, edge: float, key: str) -> None:
    """Warn where cells with such edges [mm] are too coarse for radii of a tool of facets beside the workpiece.

    Sharp edges have none, and a radius along less than EDGES such edges does not count. key: what they are.
    """
    if not isinstance(tool.surface, Triangulation):
        return
    nodes, corners = mesh.points, find_space_pose(tool, np.zeros(3)).carry(tool.surface.points)
    reach = 0.5 * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    beside = ((corners > nodes.min(axis=0) - reach) & (corners < nodes.max(axis=0) + reach)).all(axis=1)
    own = tool.surface.triangles[beside[tool.surface.triangles].all(axis=1)]
    _warn_of_sharp_radius(name, find_least_radius(corners, own, EDGES * edge, sharp_counts=False), edge, key)


def _warn_of_sharp_radius(name: str, radius: float, edge: float, what: str) -> None:
    if edge > COARSE * radius:
        logger.warning(
            "tools.%s: its smallest radius is %.3g mm, and %s of %.3g mm, too coarse to follow it; cells of %.2g mm "
            "would do",
            name,
            radius,
            what,
            edge,
            ENOUGH * radius,
        )


def warn_of_widths(name: str, tool: Tool, mirrors: tuple[FloatArray, ...], mesh: Mesh, edge: float, key: str) -> None:
    """Warn where ridges or slots of a tool of facets are narrower than the smallest cells [mm]; key: what they are.

    mirrors: positions of the symmetry planes normal to x, y and z [mm].
    """
    if not isinstance(tool.surface, Triangulation):
        return
    cut = [axis for axis in range(3) if tool.mirrored_across[axis]]
    levels = [(axis, float(mirrors[axis][0])) for axis in cut]
    middle = mesh.points.mean(axis=0)
    planes = [(axis, level, float(np.sign(middle[axis] - level))) for axis, level in levels]
    widths = find_widths(complete_tool(tool, planes, WITHIN * edge), edge, edge)
    for kind, own, fate in (("ridge", widths.is_ridge, "follow it"), ("slot", ~widths.is_ridge, "flow into it")):
        if not own.any():
            continue
        width, places = widths.width[own], widths.place[own]
        typical = float(np.median(width))
        where = find_space_pose(tool, np.zeros(3)).carry(places[[np.argmin(np.abs(width - typical))]])[0]
        logger.warning(
            "tools.%s: a %s about %.2g mm wide near (%s), and %s of %.3g mm, too coarse to %s; %.2g mm would do",
            name,
            kind,
            typical,
            ", ".join(f"{x:.4g}" for x in where),
            key,
            edge,
            fate,
            ENOUGH * typical,
        )
