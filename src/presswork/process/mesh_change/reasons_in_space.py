# SPDX-License-Identifier: Apache-2.0
"""Why the mesh of a body of tetrahedra should not go on, and what a new one could not mend."""

from __future__ import annotations

from dataclasses import astuple, dataclass, replace

from presswork.geometry.mirrored import WITHIN, complete_tool, find_mirrors
from presswork.geometry.tool_widths import find_widths
from presswork.model import FloatArray, Limits, Model, Remeshing, Tool, Triangulation
from presswork.process.mesh_change.mesh_reasons import LAST_CUT
from presswork.process.space_surfaces import draw_tool
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.notches import SHARP, measure_notch
from presswork.remesh.space.size_field import OF_WIDTH, EdgeSizes
from presswork.remesh.space.tetrahedra import measure_quality
from presswork.remesh.space.tools import ToolShape, find_bends
from presswork.remesh.space.triggers import (
    TOO_DEEP,
    TOO_LONG,
    WORSE,
    find_cut_edge,
    find_cut_face,
    find_flat_cell,
    find_long_edge,
    find_notch,
    find_stretched_cut,
    measure_cut,
    measure_cut_face,
    measure_edge,
)

BEFORE_LIMIT, AT_LIMIT = 0.6, 0.8
"""Penetration over limits.penetration above which a mesh is replaced at once: the first value, or more where the last
mesh has left as much, up to AT_LIMIT."""
LEFT = "left"
"""Name in a checkpoint."""
CHORD = 0.05
"""How far the triangles that stand for a tool may lie off it, over the smallest edge of cells."""


@dataclass(frozen=True)
class Left:
    """What a new mesh could not mend."""

    cut: float = 0.0
    """Depth of a tool in an edge, over its length."""
    any_cut: float = 0.0
    """The same, sharp edges of tools included."""
    face: float = 0.0
    """Depth of a tool in a face, over its longest side."""
    quality: float = 1.0
    """Quality of the worst cell."""
    edge: float = 0.0
    """Longest edge of the skin over the size wanted there, where another mesh was refused."""
    notch: float = 180.0
    """Sharpest void that a mesh would fill [degrees]."""

    def worsen(self, other: Left) -> Left:
        """Return the worse of both in each respect."""
        worse = [max(own, its) for own, its in zip(astuple(self), astuple(other), strict=True)]
        return replace(Left(*worse), quality=min(self.quality, other.quality), notch=min(self.notch, other.notch))


def measure_left(body: OldBody, settings: Remeshing, moves: FloatArray | None = None) -> Left:
    """Return what is wrong with a new mesh, or with one that stays.

    moves: of the latter in an increment like the last (n, 3) [mm]: its cells after that and its long edges count, too.
    """
    cuts = measure_cut(body, settings.smallest_size), measure_cut(body, sharp_counts=True), measure_cut_face(body)
    then = [body.points] if moves is None else [body.points, body.points + moves]
    quality = min(float(measure_quality(points, body.cells).min()) for points in then)
    longest = 0.0 if moves is None else measure_edge(body, list_sizes(settings))
    return Left(*cuts, quality, longest, measure_notch(body)[0])


def find_reason(
    old: OldBody, moves: FloatArray, settings: Remeshing, wait: float, *, left: Left | None = None
) -> str | None:
    """Return why a body's mesh should not go on.

    wait: factor on the triggers. left: what was wrong with the mesh when it was made: only worse counts.
    """
    left = left or Left()
    return (
        find_notch(old, min(SHARP, left.notch / WORSE) / wait)
        or find_flat_cell(old, moves, min(settings.quality, left.quality / WORSE) / wait)
        or find_cut_edge(old, deepest=wait * max(TOO_DEEP, WORSE * left.cut), smallest=settings.smallest_size)
        or find_cut_edge(old, deepest=wait * max(LAST_CUT, WORSE * left.any_cut), sharp_counts=True)
        or find_long_edge(old, list_sizes(settings), longest=wait * max(TOO_LONG, WORSE * left.edge))
    )


def find_breach(old: OldBody, limits: Limits, *, left: Left, start: FloatArray | None = None) -> str | None:
    """Describe where a tool penetrates so deeply that limits.penetration would stop the run soon.

    start: where the nodes were when the mesh was made (n, 3) [mm]; None: where they are.
    """

    def allow(part: float) -> float:
        return max(BEFORE_LIMIT * limits.penetration, min(WORSE * part, AT_LIMIT * limits.penetration))

    cut = find_cut_face(old, allow(left.face))
    return cut or find_stretched_cut(old, old.points if start is None else start, allow(left.any_cut))


def draw_shape(tool: Tool, model: Model, settings: Remeshing) -> ToolShape:
    """Return what new meshes must know of a tool; ridges and slots that symmetry planes halve are wide as they are."""
    corners, triangles = draw_tool(tool, model.mesh.points, CHORD * settings.smallest_size)
    widest = settings.size / OF_WIDTH
    shape = Triangulation(corners, triangles, False)
    if isinstance(tool.surface, Triangulation):
        shape = complete_tool(tool, find_mirrors(tool, model), WITHIN * settings.smallest_size)
    widths = find_widths(shape, widest, settings.smallest_size)
    return ToolShape(find_bends(corners, triangles), widths)


def list_sizes(settings: Remeshing) -> EdgeSizes:
    """Return the sizes that settings ask for."""
    return EdgeSizes(settings.size, settings.smallest_size, settings.max_cells)
