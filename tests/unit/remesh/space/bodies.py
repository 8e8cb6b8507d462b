# SPDX-License-Identifier: Apache-2.0
"""Deformed bodies of tetrahedra between rigid tools, as a run would have them."""

import numpy as np

from presswork.geometry.pose import SpacePose
from presswork.geometry.tool_surface import cut_plane, make_surface
from presswork.interaction.space.space_touch import PlacedSurface
from presswork.model import Plane
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.tetrahedra import find_skin
from presswork.remesh.space.tools import PlacedTool, find_bends

SIX = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]


def mesh_box(counts, size):
    """Nodes and tetrahedra of a box at the origin."""
    lines = [np.linspace(0.0, length, n + 1) for length, n in zip(size, counts, strict=True)]
    points = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape([n + 1 for n in counts])
    ends = [(i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    corners = [number[tuple(slice(a, a + n) for a, n in zip(end, counts, strict=True))] for end in ends]
    hexahedra = np.stack(corners, axis=-1).reshape(-1, 8)
    return points, hexahedra[:, SIX].reshape(-1, 4)


def place(surface, position, corners, triangles):
    """A tool that stands at a position."""
    pose = SpacePose(np.zeros(3), np.array(position, dtype=float), np.zeros(3), None)
    return PlacedTool(PlacedSurface(surface, pose), find_bends(corners, triangles).carry(pose))


def place_plane(normal, position):
    """A plane without end."""
    plane = Plane(normal)
    drawn = cut_plane(plane, 50.0)
    return place(make_surface(plane, smooth=True), position, drawn.points, drawn.triangles)


def upset_block():
    """A quarter of a block of 24 x 24 x 10 mm, upset to 7 mm and barrelled, between two flat tools."""
    start, cells = mesh_box((10, 10, 8), (12.0, 12.0, 10.0))
    z = start[:, 2] / 10.0
    points = start * [1.0, 1.0, 0.7]
    points[:, :2] *= (1.0 + 0.6 * z * (1.0 - z))[:, None]
    held = np.zeros(points.shape, dtype=bool)
    held[start[:, 0] == 0.0, 0] = held[start[:, 1] == 0.0, 1] = True
    faces, _ = find_skin(cells)
    sets = {"left": faces[(start[faces, 0] == 0.0).all(axis=1)], "bottom": faces[(start[faces, 1] == 0.0).all(axis=1)]}
    tools = [place_plane((0.0, 0.0, 1.0), (0, 0, 0)), place_plane((0.0, 0.0, -1.0), (0, 0, 7.0))]
    return OldBody(points, cells, np.stack([z == 0.0, z == 1.0]), held, sets, tools)


def draw_block(low, high):
    """Corners and triangles of a box, seen from outside counter-clockwise."""
    corners = np.array([[(low, high)[(k >> a) & 1][a] for a in range(3)] for k in range(8)], dtype=float)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)


def place_block(low, high):
    """A tool with sharp edges."""
    corners, triangles = draw_block(low, high)
    from presswork.model import Triangulation

    surface = make_surface(Triangulation(corners, triangles, True), smooth=True)
    return place(surface, (0, 0, 0), corners, triangles)


def indented_block(depth=1.5, edge=5.35):
    """A block of 12 x 4 x 8 mm into whose top the sharp edge of a tool has sunk, on a mesh that does not follow it.

    The tool's edge is the line x = edge, z = 8 - depth; metal lies on its lower face and on its wall.
    """
    start, cells = mesh_box((24, 8, 16), (12.0, 4.0, 8.0))
    points, top = start.copy(), start[:, 2] == 8.0
    beside, wall = np.abs(start[:, 0] - 5.0) < 1e-9, np.abs(start[:, 0] - 5.5) < 1e-9
    points[beside, 0], points[wall, 0] = edge - 0.1, edge
    sunk = np.where(start[:, 0] < 5.4, depth, np.where(wall, 0.5 * depth, 0.0))  # half-way up the wall
    points[:, 2] -= sunk * start[:, 2] / 8.0
    on_tool = (top & (start[:, 0] < 5.6))[None]
    held = np.zeros(points.shape, dtype=bool)
    held[:, 1] = (start[:, 1] == 0.0) | (start[:, 1] == 4.0)
    tools = [place_block((-20.0, -20.0, 8.0 - depth), (edge, 20.0, 30.0))]
    return OldBody(points, cells, on_tool, held, {}, tools)


def ball_on_block():
    """A block of 10 x 10 x 6 mm, dented by a ball of radius 8 mm: a quarter, the ball's axis at the origin's corner."""
    from presswork.geometry.swept_tool import draw_hemispherical_punch, triangulate

    start, cells = mesh_box((12, 12, 8), (10.0, 10.0, 6.0))
    ball = draw_hemispherical_punch(8.0, 20.0)
    corners, triangles = triangulate(ball, 0.02, size=0.5)
    tool = place(make_surface(ball, smooth=True), (0.0, 0.0, 4.5), corners, triangles)
    points = start.copy()
    top = start[:, 2] == 6.0
    radius = np.hypot(start[:, 0], start[:, 1])
    under = np.minimum(12.5 - np.sqrt(np.maximum(64.0 - radius**2, 0.0)), 6.0)
    points[:, 2] *= under / 6.0
    held = np.zeros(points.shape, dtype=bool)
    held[start[:, 0] == 0.0, 0] = held[start[:, 1] == 0.0, 1] = True
    gap, _ = tool.touch(points, 1.0)
    return OldBody(points, cells, (top & (np.abs(gap) < 1e-9))[None], held, {}, [tool])
