# SPDX-License-Identifier: Apache-2.0
"""Wear of the surfaces of tools by Archard's law (1953), with powers of pressure and hardness.

    depth = coefficient * integral of p^a / H(T)^c over the path that metal slides past a place of the tool

Places lie on the tool's surface, half an edge of the workpiece apart. Between two instants each edge (in space face) of
the workpiece whose nodes touch at both is moved along its path in a few moves; a place takes what lies over it in a
move. T is the temperature of the tool's surface: that of its steel where it warms up or has a mesh, else
the mean of its own and the workpiece's, which two bodies of equal effusivity have between them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.instant import Instant
from presswork.geometry.pose import find_space_pose
from presswork.geometry.segments import sample_arc
from presswork.mesh.faces import split_faces
from presswork.model import BoolArray, FloatArray, IntArray, Mesh, Model, Plane, SweptProfile, Tool, ToolWear, find_cell
from presswork.observe.contract import History, Measure, Observed, Observer, Row

MOST_MOVES = 20
"""Most moves into which the path between two instants is divided."""
SHARE = 0.5
"""Distance of places, over the mean edge of the workpiece's surface."""
MOST_PLACES = 200_000
BESIDE = 0.1
"""Distance from the workpiece over that of places, up to which a place is under it: chords cut curves of a tool."""
MICROMETRE = 1e-3


@dataclass(frozen=True)
class Passed:
    """The workpiece on a tool at one instant, in the tool's frame."""

    places: FloatArray
    """(n_points, 2 | 3) [mm]"""
    rate: FloatArray
    """p^a / H^c at the nodes, 0 apart (n_points,)."""


class WornTool:
    """Wear of one tool at places of its surface, in its own frame."""

    def __init__(self, tool: Tool, mesh: Mesh) -> None:
        assert tool.wear is not None
        self.tool, self.wear = tool, tool.wear
        self._spacing = SHARE * _mean_edge(mesh)
        self.places, self.normals = place_on_surface(tool, mesh, self._spacing)
        """Places (n, 2 | 3) [mm], and the normals there, out of the tool's metal (n, 2 | 3)."""
        self.path = np.zeros(len(self.places))
        """Integral of p^a / H^c over the path that has slid past each place (n,)."""
        self.before: Passed | None = None

    @property
    def depth(self) -> FloatArray:
        """Return the depth that a part wears off (n,) [mm]."""
        return self.wear.coefficient * self.path

    def follow(self, now: Passed, pieces: IntArray) -> None:
        """Add what has slid since the last instant. pieces: edges (n, 2) or triangles (n, 3) of the surface."""
        before, self.before = self.before, now
        if before is None or len(before.rate) != len(now.rate):
            return
        touching = (before.rate > 0.0) & (now.rate > 0.0)
        sliding = pieces[touching[pieces].all(axis=1)]
        if not len(sliding):
            return
        slid = now.places - before.places
        length = np.linalg.norm(slid, axis=1)
        work = 0.5 * (before.rate + now.rate) * length
        moves = min(MOST_MOVES, max(1, math.ceil(float(length[sliding].max()) / self._spacing)))
        for move in range(moves):
            corners = before.places + (move + 0.5) / moves * slid
            near = self._find_near(corners[np.unique(sliding)])
            on, value = pass_over(self.places[near], corners, work, sliding, BESIDE * self._spacing)
            self.path[near[on]] += value[on] / moves

    def _find_near(self, nodes: FloatArray) -> IntArray:
        """Return the places in the box of nodes (n, 2 | 3) [mm]."""
        low, high = nodes.min(axis=0) - self._spacing, nodes.max(axis=0) + self._spacing
        return np.flatnonzero(((self.places >= low) & (self.places <= high)).all(axis=1)).astype(np.int32)

    def take_nodes(self, before: FloatArray, position: FloatArray) -> None:
        """Carry the last instant from the nodes of one mesh to those of another, which lie at (n, 2 | 3) [mm] now."""
        if self.before is None or not self.before.rate.any():
            self.before = None
            return
        from scipy.spatial import cKDTree

        touching = np.flatnonzero(self.before.rate)
        apart, nearest = cKDTree(before[touching]).query(position)
        old = touching[nearest]
        still = np.zeros(position.shape[1])
        moved = _to_frame(self.tool, position, still) - _to_frame(self.tool, before[old], still)
        rate = np.where(apart < 2.0 * self._spacing, self.before.rate[old], 0.0)
        self.before = Passed(self.before.places[old] + moved, rate)


class WearOfTools(Observer):
    """Follows the wear of the tools that ask for it."""

    def __init__(self, model: Model) -> None:
        self._tools = [WornTool(tool, model.mesh) for tool in model.tools if tool.wear is not None]
        self._epoch: int | None = None
        """Mesh of the last instant; None: the next mesh is the one that it is carried to."""
        self._number: int | None = None
        """Increments or intervals at the last instant."""

    def columns(self, run: Observed) -> list[str]:
        """Return the deepest wear of each tool."""
        return [f"{worn.tool.name}.wear" for worn in self._tools]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the depth that the part has worn off so far, the deepest of each tool [mm]."""
        self._follow(run)
        return {f"{worn.tool.name}.wear": float(worn.depth.max()) for worn in self._tools}

    def measures(self, run: Observed) -> list[Measure]:
        """Follow the wear; it measures nothing of a limit."""
        self._follow(run)
        return []

    def _follow(self, run: Observed) -> None:
        """Add what has slid since the last instant, once an instant."""
        if not self._tools or self._number == run.number:
            return
        self._number, now = run.number, run.show()
        is_carried, self._epoch = self._epoch in (None, run.epoch), run.epoch
        moved, places = run.tool_displacements(), run.positions()
        pieces = list_pieces(run.mesh)
        for worn in self._tools:
            own = _to_frame(worn.tool, places, moved[worn.tool.name])
            worn.before = worn.before if is_carried else None
            worn.follow(Passed(own, find_rate(run, worn.tool, find_pressure(run, now, worn.tool, pieces))), pieces)

    def take_mesh(self, before: FloatArray, mesh: Mesh, position: FloatArray) -> None:
        """Carry the last instant to the nodes of another mesh."""
        self._epoch = None
        for worn in self._tools:
            worn.take_nodes(before, position)

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the deepest wear of each tool with its place, and the number of parts until the limit."""
        return {"wear": {worn.tool.name: _summarise(worn) for worn in self._tools}} if self._tools else {}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the tools that nothing has worn."""
        return [
            f"{worn.tool.name}: nothing slid along this tool under pressure, so its wear is zero: the metal sticks to "
            "it, or it never touched"
            for worn in self._tools
            if not worn.path.any()
        ]

    def files(self, run: Observed) -> dict[str, str]:
        """Return a table of the wear along each tool's surface."""
        return {f"wear_{worn.tool.name}.csv": write_wear(worn) for worn in self._tools}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the wear of each tool, and the workpiece on it at the last instant."""
        found: dict[str, NDArray[Any]] = {}
        for worn in self._tools:
            found[f"wear.{worn.tool.name}.path"] = worn.path
            if worn.before is not None:
                found[f"wear.{worn.tool.name}.places"] = worn.before.places
                found[f"wear.{worn.tool.name}.rate"] = worn.before.rate
        return found

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up the wear of each tool."""
        for worn in self._tools:
            begin = f"wear.{worn.tool.name}."
            worn.path = np.array(arrays.get(f"{begin}path", worn.path))
            if f"{begin}rate" in arrays:
                worn.before = Passed(np.array(arrays[f"{begin}places"]), np.array(arrays[f"{begin}rate"]))


def find_pressure(run: Observed, now: Instant, tool: Tool, pieces: IntArray) -> FloatArray:
    """Return the pressure of a tool on the nodes of the workpiece (n_points,) [MPa], 0 apart.

    Explicit runs know the force of all tools on a node: it counts as the nearest tool's, over the node's area.
    """
    if now.contact is not None and tool.name in now.contact.traction:
        return np.where(now.contact.traction[tool.name].any(axis=1), np.maximum(now.contact.pressure, 0.0), 0.0)
    gaps, places = run.tool_gaps(), run.positions()
    if now.tool_force is None or gaps is None:
        return np.zeros(len(places))
    area = find_areas(run.model, places, pieces)
    size = np.linalg.norm(area, axis=1)
    pushed = np.abs((now.tool_force * area).sum(axis=1))
    own = pushed > 0.0
    own[own] = np.argmin(np.abs(gaps.find(places[own])), axis=0) == list(gaps.names).index(tool.name)
    return np.asarray(np.divide(pushed, size**2, out=np.zeros_like(pushed), where=own & (size > 0.0)))


def find_areas(model: Model, places: FloatArray, pieces: IntArray) -> FloatArray:
    """Return the area vectors that nodes of a surface stand for (n_points, 2 | 3) [mm2]; of rings the whole ring."""
    found = np.zeros_like(places)
    corners = places[pieces]
    if pieces.shape[1] == 2:
        along = corners[:, 1] - corners[:, 0]
        deep = (
            2.0 * np.pi * corners[:, :, 0] if model.analysis == "axisymmetric" else np.full(pieces.shape, model.depth)
        )
        across = np.stack([along[:, 1], -along[:, 0]], axis=1)
        # of a hat along an edge whose width grows linearly: a third of its own end's width and a sixth of the other's
        share = deep / 3.0 + deep[:, ::-1] / 6.0
        np.add.at(found, pieces, share[:, :, None] * across[:, None])
        return found
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 6.0
    np.add.at(found, pieces, across[:, None])
    return found


def find_rate(run: Observed, tool: Tool, pressure: FloatArray) -> FloatArray:
    """Return p^a / H^c of a tool at the nodes of the workpiece, of the pressure there (n_points,) [MPa]."""
    assert tool.wear is not None
    on = pressure > 0.0
    rate = np.zeros(len(on))
    hardness = find_hardness(tool.wear, _surface_temperature(run, tool, on))
    rate[on] = pressure[on] ** tool.wear.pressure_power / hardness**tool.wear.hardness_power
    return rate


def find_hardness(wear: ToolWear, temperature: FloatArray | None) -> FloatArray:
    """Return the hardness at temperatures (n,) [degrees C], held beyond the ends of its table [MPa]."""
    rows = np.array(wear.hardness)
    return np.asarray(rows[0, 1] if temperature is None else np.interp(temperature, rows[:, 0], rows[:, 1]))


def _surface_temperature(run: Observed, tool: Tool, on: NDArray[np.bool_]) -> FloatArray | None:
    """Return the temperature of a tool's surface where it touches (n,) [degrees C]; None without heat."""
    heat, own = run.body_heat(), None if run.model.heat is None else run.model.heat.tools.get(tool.name)
    if heat is None or own is None:
        return None
    forming, arrays = heat
    if own.steel is not None and len(arrays.columns):
        number = [each.name for each in run.model.tools].index(tool.name)
        return np.asarray(arrays.columns[number, on, 0])
    if own.die is not None:
        from scipy.spatial import cKDTree

        points = _to_frame(tool, run.positions()[on], run.tool_displacements()[tool.name])
        start = np.asarray(tool.position)[: points.shape[1]]
        profile = np.unique(own.die.profile)
        nearest = cKDTree(own.die.mesh.points[profile] - start).query(points)[1]
        return np.asarray(forming.die_temperatures(arrays)[tool.name][profile[nearest]])
    return np.asarray(0.5 * (arrays.temperature[on] + own.temperature))


def _to_frame(tool: Tool, points: FloatArray, moved: FloatArray) -> FloatArray:
    """Return points (n, 2 | 3) in the frame of a tool that has moved (2 | 3,) [mm]."""
    if points.shape[1] == 2:
        return np.asarray(points - np.asarray(tool.position[:2]) - moved)
    return find_space_pose(tool, moved).to_frame(points)


def list_pieces(mesh: Mesh) -> IntArray:
    """Return the edges (n, 2) or triangles (n, 3) of a body's surface; those of quadratic cells in their pieces."""
    sides, dimension = (mesh.boundary_faces, 2) if len(mesh.boundary_faces) else (mesh.boundary_edges, 1)
    cell = find_cell(dimension, sides)
    if dimension == 2 and not cell.is_quadratic:
        return split_faces(sides)
    return np.concatenate([sides[:, piece] for piece in cell.pieces]) if cell.is_quadratic else sides


def _mean_edge(mesh: Mesh) -> float:
    pieces = list_pieces(mesh)
    return float(np.linalg.norm(mesh.points[pieces[:, 0]] - mesh.points[pieces[:, 1]], axis=1).mean())


def pass_over(
    places: FloatArray, nodes: FloatArray, values: FloatArray, pieces: IntArray, beside: float
) -> tuple[BoolArray, FloatArray]:
    """Return which places (n, 2 | 3) [mm] lie under pieces of a surface, and what these have there (n,).

    nodes (n_points, 2 | 3) [mm]; values at them (n_points,); pieces: edges (m, 2) or triangles (m, 3). beside: distance
    from a piece up to which a place is under it [mm].
    """
    if not len(places):
        return np.zeros(0, dtype=bool), np.zeros(0)
    if pieces.shape[1] == 3:
        from presswork.geometry.foot_on_triangles import find_feet  # slow to load, as is scipy.spatial

        feet = find_feet(places, nodes, pieces)
        apart = np.linalg.norm(places - feet.interpolate(nodes, pieces), axis=1)
        return apart <= beside, feet.interpolate(values[:, None], pieces)[:, 0]
    start, along = nodes[pieces[:, 0]], nodes[pieces[:, 1]] - nodes[pieces[:, 0]]
    away = places[:, None] - start
    part = np.clip((away * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-300), 0.0, 1.0)
    apart = np.linalg.norm(away - part[..., None] * along, axis=2)
    nearest, row = np.argmin(apart, axis=1), np.arange(len(places))
    first, second = values[pieces[nearest]].T
    share = part[row, nearest]
    return apart[row, nearest] <= beside, np.asarray((1.0 - share) * first + share * second)


def place_on_surface(tool: Tool, mesh: Mesh, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Return places on a tool's surface in its own frame (n, 2 | 3) [mm], and normals out of its metal (n, 2 | 3)."""
    if mesh.points.shape[1] == 2:
        return _place_on_profile(tool.profile.segments, spacing)
    from presswork.geometry.foot_on_triangles import split_long
    from presswork.geometry.swept_tool import triangulate

    size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    shape = tool.surface
    if isinstance(shape, Plane):
        points, triangles = _lay_square(np.array(shape.normal), 4.0 * size)
    elif isinstance(shape, SweptProfile):
        points, triangles = triangulate(shape, 0.1 * spacing, length=4.0 * size)
    else:
        points, triangles = shape.points, shape.triangles
    spacing = max(spacing, math.sqrt(_find_area(points, triangles) / MOST_PLACES))
    points, triangles = split_long(points, triangles, spacing)
    first, second, third = points[triangles.T]
    normal = np.cross(second - first, third - first)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return points[triangles].mean(axis=1), normal / np.where(length > 0.0, length, 1.0)


def _find_area(points: FloatArray, triangles: IntArray) -> float:
    first, second, third = points[triangles.T]
    return float(0.5 * np.linalg.norm(np.cross(second - first, third - first), axis=1).sum())


def _lay_square(normal: FloatArray, half: float) -> tuple[FloatArray, IntArray]:
    """Return a square about the origin across a normal (3,)."""
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    corners = half * np.array([-first - second, first - second, first + second, second - first])
    return corners, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def _place_on_profile(segments: FloatArray, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Return the middles of pieces of a profile (n, 2) [mm], and their normals to the left (n, 2)."""
    length = sum(float(np.linalg.norm(np.diff(sample_arc(s, 0.01 * spacing), axis=0), axis=1).sum()) for s in segments)
    spacing = max(spacing, length / MOST_PLACES)
    places, normals = [], []
    for segment in segments:
        line = sample_arc(segment, 0.01 * spacing)
        gone = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
        n = max(1, math.ceil(gone[-1] / spacing))
        ends = np.linspace(0.0, gone[-1], 2 * n + 1)
        trace = np.stack([np.interp(ends, gone, line[:, axis]) for axis in range(2)], axis=1)
        along = trace[2::2] - trace[:-2:2]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        places.append(trace[1::2])
        normals.append(np.stack([-along[:, 1], along[:, 0]], axis=1))
    return np.concatenate(places), np.concatenate(normals)


def _summarise(worn: WornTool) -> dict[str, Any]:
    """Return the deepest wear with its place where the tool starts, and what it means for a number of parts."""
    depth = worn.depth
    worst = int(np.argmax(depth))
    start = worn.places[worst] + np.asarray(worn.tool.position)[: worn.places.shape[1]]
    if worn.places.shape[1] == 3:
        start = find_space_pose(worn.tool, np.zeros(3)).carry(worn.places[[worst]])[0]
    found: dict[str, Any] = {
        "deepest_um_per_part": float(depth[worst]) / MICROMETRE,
        "deepest_at_mm": [float(x) for x in start],
        "parts": worn.wear.parts,
        "deepest_mm": float(depth[worst]) * worn.wear.parts,
    }
    if worn.wear.limit is not None:
        found["limit_mm"] = worn.wear.limit
        found["parts_until_limit"] = math.floor(worn.wear.limit / depth[worst]) if depth[worst] > 0.0 else None
    return found


def write_wear(worn: WornTool) -> str:
    """Return the table: places as drawn, depth of one part and of all parts, and the worn surface [mm]."""
    names = "xyz"[: worn.places.shape[1]]
    depth = worn.depth
    surface = worn.places - (depth * worn.wear.parts)[:, None] * worn.normals
    header = [*names, "depth_per_part", "depth", *(f"worn_{name}" for name in names)]
    rows = np.column_stack([worn.places, depth, depth * worn.wear.parts, surface])
    return "\n".join([",".join(header), *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n"
