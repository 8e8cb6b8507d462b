# SPDX-License-Identifier: Apache-2.0
"""The tools of a stamping as triangles, bent by a map of space, and what is left to see to: gap, undercut, start."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from presswork.case import StampingCase
from presswork.geometry.foot_on_triangles import split_long
from presswork.geometry.rigid_warp import RigidWarp
from presswork.geometry.swept_tool import triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.mesh import MeshError
from presswork.mesh.make.surface_offset import cut_surface
from presswork.model import FloatArray, IntArray, Model, SweptProfile, ToolKind, Triangulation
from presswork.results import Result

WITHIN = 0.002
"""Largest distance of a drawn tool's triangles from its surface [mm]."""
_STRIP = 1.2
"""Length of a strip's tools over the blank's along y."""
_UNDER, _FADES = 1.4, 2.0
"""Thicknesses from a holder's corners up to which a die's are held by it, and over which the map fades beside it."""
_BESIDE, _WALL = 5.0, 10.0
"""Thicknesses by which tools reach beyond the flat blank, and so high walls of punch and holder are kept."""
_SLAMS, _WRAPS = 0.9, 1.05
"""Thicknesses of free travel before a force, from which on a holder is closed by distance, and the room it leaves."""
_LEANS = 0.1
"""Undercut that is no facets' noise [degree]."""
_PRESSES = 1.6
"""Gap over the thickness up to which a punch presses on the sheet."""
_UPRIGHT = 1e-3
"""Part of a facet's normal along the press [1], beyond which it faces away from the sheet."""


@dataclass(frozen=True)
class PressedTool:
    """A tool of triangles where it starts, and where it stands when the tools are closed."""

    name: str
    kind: ToolKind
    shape: Triangulation
    """Shape in its own frame."""
    position: FloatArray
    """Position of its origin at the start (3,) [mm]."""
    travel: FloatArray
    """Travel from there to the closed tools (3,) [mm]."""

    @property
    def upwards(self) -> float:
        """1 of a die, whose face looks up, else -1."""
        return 1.0 if self.kind == "die" else -1.0

    @property
    def closed(self) -> FloatArray:
        """Its points in the closed tools (n, 3) [mm]."""
        return self.shape.points + self.position + self.travel


@dataclass(frozen=True)
class Undercut:
    """Where the face of a tool leans over farthest."""

    tool: str
    angle: float
    """Angle of the face against the press's direction [degree]; 0: nowhere."""
    place: FloatArray
    """Place in the closed tools (3,) [mm]."""

    def explain(self) -> str:
        """Explain tools that lean over so far that others cannot pass; empty for no more than the noise of facets."""
        if self.angle < _LEANS:
            return ""
        x, y, z = self.place
        return (
            f"the correction needs an undercut of {self.angle:.2g} degrees in {self.tool} near ({x:.4g}, {y:.4g}, "
            f"{z:.4g}), which tools that move along the press cannot have: give the wall more draft; "
        )


def cut_into_triangles(model: Model, longest: float, thickness: float, stroke: float = 0.0) -> tuple[PressedTool, ...]:
    """Return the tools with drawn shapes cut into triangles, and triangles split to edges of this length [mm].

    They are where they start, without travel. What the sheet never comes to is left out: faces beyond the flat blank,
    walls high over a holder's face, and those of a punch that stay over the flange. thickness: of the sheet [mm];
    stroke: by which punch and die come together [mm].
    """
    length = _STRIP * float(np.ptp(model.mesh.points[:, 1])) * (2.0 if model.symmetry[1] else 1.0)
    found = []
    for tool in model.tools:
        shape = tool.shape
        if isinstance(shape, SweptProfile):
            points, triangles = triangulate(shape, WITHIN, length=length)
            shape = Triangulation(points, triangles, is_closed=False)
        assert isinstance(shape, Triangulation)
        assert tool.kind is not None
        position = np.array(tool.position)
        cut = _cut_near(shape, model, position[:2], _BESIDE * thickness + 2.0 * longest)
        points, triangles = split_long(cut.points, cut.triangles, 4.0 * longest)
        if tool.kind != "die":
            height = points[triangles].mean(axis=1)[:, 2] + position[2]
            least = stroke if tool.kind == "punch" else float(height.min())
            triangles = triangles[height < least + _WALL * thickness + 4.0 * longest]
        points, triangles = split_long(points, triangles, longest)
        found.append(
            PressedTool(tool.name, tool.kind, _mirror(points, triangles, model, position), position, np.zeros(3))
        )
    return tuple(found)


def _cut_near(shape: Triangulation, model: Model, position: FloatArray, beside: float) -> Triangulation:
    """Return what of a tool lies over the blank or so near it [mm], on the blank's side of symmetry planes alone."""
    low, high = (getattr(model.mesh.points[:, :2], end)(axis=0) for end in ("min", "max"))
    for axis in (0, 1):
        is_right = not model.symmetry[axis] or high[axis] > -low[axis]
        low[axis] = 0.0 if model.symmetry[axis] and is_right else low[axis] - beside
        high[axis] = high[axis] + beside if is_right else 0.0
    (x0, y0), (x1, y1) = low - position, high - position
    try:
        return cut_surface(shape, np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), inside=True)
    except MeshError:  # all of it lies there, or nothing, which the run will report
        return shape


def _mirror(points: FloatArray, triangles: IntArray, model: Model, position: FloatArray) -> Triangulation:
    """Return a tool with its mirror images beyond symmetry planes, joined: both sides are alike to the last facet."""
    points = points + position
    for axis in (0, 1):
        if model.symmetry[axis]:
            sign = np.where(np.arange(3) == axis, -1.0, 1.0)
            triangles = np.concatenate([triangles, triangles[:, ::-1] + len(points)])
            points = np.concatenate([points, points * sign])
    points, index = np.unique(np.round(points, 9) + 0.0, axis=0, return_inverse=True)
    used, numbers = np.unique(index.reshape(-1)[triangles], return_inverse=True)
    cells = np.ascontiguousarray(numbers.reshape(-1, 3), dtype=np.int32)
    return Triangulation(points[used] - position, cells, is_closed=False)


def find_closed(tools: Sequence[PressedTool], result: Result, step: int) -> tuple[PressedTool, ...]:
    """Return the tools and how far they had travelled at a saved step."""
    return tuple(replace(tool, travel=result.surface_displacement(tool.name, step)) for tool in tools)


def bend_tools(
    tools: Sequence[PressedTool], warp: RigidWarp, thickness: float, *, fix_holders: bool = False
) -> tuple[PressedTool, ...]:
    """Return the tools with their faces carried by a map of the closed tools' space.

    thickness: of the sheet [mm]. fix_holders: holders stay, and what lies under them: the map, which smooths over nodes
    on either side of their rims, fades towards these.
    """
    fixed = [tool for tool in tools if fix_holders and tool.kind == "holder"]
    bent = []
    for tool in tools:
        if fix_holders and tool.kind == "holder":
            bent.append(tool)
            continue
        moved = warp.carry(tool.closed) - tool.closed
        if fixed:
            moved *= _fade(tool.closed, fixed, thickness)[:, None]
        bent.append(replace(tool, shape=replace(tool.shape, points=tool.shape.points + moved)))
    return tuple(bent)


def _fade(places: FloatArray, holders: Sequence[PressedTool], thickness: float) -> FloatArray:
    """Return which part of a map holds at places of the closed tools (n,): none under holders, all off their rims."""
    away, _ = cKDTree(np.concatenate([holder.closed for holder in holders])).query(places)
    part = np.clip((away / thickness - _UNDER) / _FADES, 0.0, 1.0)
    return np.asarray(part**2 * (3.0 - 2.0 * part))


def find_undercut(
    tools: Sequence[PressedTool],
    drawn: Sequence[PressedTool],
    part: FloatArray,
    reach: float,
    planes: tuple[bool, bool] = (False, False),
    *,
    uprights: bool = True,
) -> Undercut:
    """Return where a bent tool leans over farthest among the facets that face the sheet as they were drawn.

    Only facets within `reach` [mm] of the part in the closed tools as drawn (n, 3) count: backs and ends of tools that
    no sheet touches follow the bend, too. planes: symmetry planes normal to x and y, beyond which the part goes on.
    uprights: whether a punch's faces along the press count: above the part's wall they may lean over.
    """
    worst, mirrored = Undercut("", 0.0, np.zeros(3)), np.array([*planes, False])
    sheet = cKDTree(np.where(mirrored, np.abs(part), part))
    for tool, before in zip(tools, drawn, strict=True):
        least = -_UPRIGHT if uprights or tool.kind == "die" else _UPRIGHT
        faces = tool.upwards * _unit_normals(before.shape)[:, 2] > least
        middle = before.closed[before.shape.triangles].mean(axis=1)
        faces &= np.isfinite(sheet.query(np.where(mirrored, np.abs(middle), middle), distance_upper_bound=reach)[0])
        lean = -tool.upwards * _unit_normals(tool.shape)[:, 2]
        lean[~faces] = -1.0
        k = int(np.argmax(lean))
        angle = math.degrees(math.asin(min(float(lean[k]), 1.0)))
        if lean[k] > _UPRIGHT and angle > worst.angle:
            worst = Undercut(tool.name, angle, tool.closed[tool.shape.triangles[k]].mean(axis=0))
    return worst


def find_gap_change(
    tools: Sequence[PressedTool],
    drawn: Sequence[PressedTool],
    part: FloatArray,
    reach: float,
    planes: tuple[bool, bool] = (False, False),
) -> float:
    """Return the largest change of the distance between punch or holder and die where the sheet lies [mm].

    It is taken at corners of punch and holder nearer than `reach` [mm] to the die and to the part in the closed tools
    as drawn (n, 3). planes: symmetry planes normal to x and y, beyond which the part goes on.
    """
    largest, mirrored = 0.0, np.array([*planes, False])
    sheet = cKDTree(np.where(mirrored, np.abs(part), part))
    for upper, upper_drawn in zip(tools, drawn, strict=True):
        places = np.where(mirrored, np.abs(upper_drawn.closed), upper_drawn.closed)
        is_on_sheet = np.isfinite(sheet.query(places, distance_upper_bound=reach)[0])
        for lower, lower_drawn in zip(tools, drawn, strict=True):
            if upper.kind == "die" or lower.kind != "die":
                continue
            before = _measure_gap(upper_drawn, lower_drawn, reach)
            near = is_on_sheet & (np.abs(before) < reach)
            after = _measure_gap(upper, lower, 2.0 * reach)[near] if near.any() else np.zeros(0)
            change = np.abs(after - before[near])
            largest = max(largest, float(change[np.isfinite(change)].max(initial=0.0)))
    return largest


def find_room(tools: Sequence[PressedTool], drawn: Sequence[PressedTool], thickness: float, height: float) -> float:
    """Return the least distance of the punch from the die on the last part of its stroke, over the thickness.

    It is taken at the corners of the punch that press on the sheet in the closed tools. height: of that part [mm].
    """
    die, die_drawn = (next(tool for tool in each if tool.kind == "die") for each in (tools, drawn))
    surface, least, reach = make_surface(die.shape), np.inf, 2.0 * thickness
    for punch, punch_drawn in zip(tools, drawn, strict=True):
        if punch.kind != "punch":
            continue
        presses = np.abs(_measure_gap(punch_drawn, die_drawn, reach)) < _PRESSES * thickness
        places = punch.closed[presses] - die.position - die.travel
        for rise in np.arange(0.0, height, 0.5 * thickness):
            gap, *_ = surface.nearest(np.ascontiguousarray(places + np.array([0.0, 0.0, rise])), reach)
            least = min(least, float(gap[np.isfinite(gap)].min(initial=np.inf)))
    return least / thickness


def place_tools(
    case: StampingCase, data: Mapping[str, Any], tools: Sequence[PressedTool], drawn: Sequence[PressedTool],
    paths: Mapping[str, str], *, slams: float = _SLAMS,
) -> tuple[dict[str, Any], FloatArray]:  # fmt: skip
    """Return the case's data with tools from files, and by how much they close lower than as drawn (3,) [mm].

    A tool that reaches farther towards the blank than it did starts so much earlier, and strokes are as much longer. A
    die that stands still is lowered with everything else. paths: of the files by name. slams: free travel over the
    thickness, from which on a holder is closed by distance before a force.
    """
    ahead = {}
    for tool, before in zip(tools, drawn, strict=True):
        reach = [float((tool.upwards * t.shape.points[:, 2]).max()) for t in (tool, before)]
        ahead[tool.name] = max(reach[0] - reach[1], 0.0)
    moves = {name for stage in case.stages for name, action in stage.tools.items() if action.stroke}
    down = max((ahead[t.name] for t in tools if t.kind == "die" and t.name not in moves), default=0.0)
    given = {key: value for key, value in data.items() if key not in ("tools", "stages")}
    given["tools"] = {}
    for tool in tools:
        stands = tool.kind == "die" and tool.name not in moves
        height = tool.position[2] - (down if stands else tool.upwards * ahead[tool.name])
        kept = {key: value for key, value in data["tools"][tool.name].items() if key in ("kind", "mu", "heat")}
        position = [float(tool.position[0]), float(tool.position[1]), float(height)]
        given["tools"][tool.name] = {**kept, "shape": "file", "path": paths[tool.name], "position": position}
    given["stages"] = [dict(stage) for stage in data["stages"]]
    for tool in tools:
        if tool.name not in moves:
            continue
        number = next(i for i, s in enumerate(case.stages) if tool.name in s.tools and s.tools[tool.name].stroke)
        stroke = (case.stages[number].tools[tool.name].stroke or 0.0) + ahead[tool.name] - tool.upwards * down
        stage = given["stages"][number]
        stage["tools"] = {**stage["tools"], tool.name: {**stage["tools"][tool.name], "stroke": stroke}}
    given["stages"] = _close_first(case, given["stages"], {name: rise + down for name, rise in ahead.items()}, slams)
    return given, np.array([0.0, 0.0, -down])


def _close_first(
    case: StampingCase, stages: list[dict[str, Any]], extra: Mapping[str, float], slams: float
) -> list[dict[str, Any]]:
    """Return the stages, and before the first force of a holder that was bent one that closes it on the blank.

    extra: by how much farther from the die each tool starts than as drawn [mm]; a force would slam it.
    """
    thickness, found, placed = case.blank.thickest, [], set[str]()
    for stage, data in zip(case.stages, stages, strict=True):
        pushed = [name for name, action in stage.tools.items() if action.force and case.tools[name].kind == "holder"]
        far = [name for name in pushed if name not in placed and extra[name] > slams * thickness]
        if far and case.procedure != "implicit":
            closing = {"name": f"{stage.name}_closing", "tools": {n: {"close": _WRAPS * thickness} for n in far}}
            found.append(closing | {key: data[key] for key in ("velocity",) if key in data})
        found.append(data)
        placed |= set(stage.tools)
    return found


def _measure_gap(upper: PressedTool, lower: PressedTool, reach: float) -> FloatArray:
    offset = lower.position + lower.travel
    gap, *_ = make_surface(lower.shape).nearest(np.ascontiguousarray(upper.closed - offset), reach)
    return np.asarray(gap)


def _unit_normals(shape: Triangulation) -> FloatArray:
    corners = shape.points[shape.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))
