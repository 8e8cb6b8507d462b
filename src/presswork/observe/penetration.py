# SPDX-License-Identifier: Apache-2.0
"""How deep tools are in a body: in its nodes and in the edges between them, and how far their profiles reach into it;
how deep bodies are in each other.

A rib that is narrower than an edge cuts it deeply, yet no point of the edge is farther from the rib's face than half
its width; so the profile's own points are checked, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.geometry.polygon import contains, measure_distance
from presswork.mesh.edges import edge_shape_functions
from presswork.mesh.faces import find_face_middles, take_bearing
from presswork.model import FloatArray, IntArray, Mesh, take_corners
from presswork.observe.contract import History, Measure, Observed, Observer
from presswork.observe.doubts import find_never_touched

_BETWEEN = np.linspace(-1.0, 1.0, 10)[1:-1]
"""Where edges are checked."""
_SPACING = 0.25
"""Spacing of the places where profiles are checked, over the mean edge."""
_MOST_PLACES = 400
"""Most places on a piece of a profile."""
CUT_EDGE = 0.25
"""Part of its length by which a tool may cut into an edge without a warning."""
PENETRATION = "penetration"
"""Name in a checkpoint."""


@dataclass(frozen=True)
class _Cut:
    """Where a tool is in the workpiece, or a body in another."""

    tool: str
    depth: float
    """[mm]"""
    edge: float
    """Length at the start of the edge that it cuts [mm]."""
    place: FloatArray
    """(2,) or (3,) [mm]."""
    into: str = "the workpiece"

    def to_measure(self) -> Measure:
        """Return it as a limit counts it."""
        place = ", ".join(f"{x:.4g}" for x in self.place)
        fact = (
            f"{self.tool} has cut {self.depth:.3g} mm into {self.into} at ({place}) mm, through an edge that "
            f"was {self.edge:.3g} mm long"
        )
        return Measure("penetration", self.depth / self.edge, fact)


@dataclass
class Penetration:
    """The largest penetrations of the converged states so far."""

    node: float = 0.0
    """[mm]"""
    edge: float = 0.0
    """[mm]"""
    share: float = 0.0
    """Depth in an edge over its length at the start."""

    def note(
        self,
        mesh: Mesh,
        points: FloatArray,
        tools: Mapping[str, FloatArray],
        find_gaps: Callable[[FloatArray], FloatArray],
    ) -> Measure | None:
        """Measure a converged state, and return where a tool is deepest, by the length of the edge at the start.

        points: of the nodes now (n_points, 2) [mm]; tools: profiles where they are now (n_segments, 7). find_gaps: of
        places from each tool (n_tools, n) [mm].
        """
        edges = mesh.boundary_edges
        if not tools or not len(edges):
            return None
        along = np.concatenate([points[edges], _look_between(points, edges)], axis=1)
        depth = -find_gaps(along.reshape(-1, 2)).reshape(len(tools), *along.shape[:2])
        self.node = max(self.node, float(depth[:, :, : edges.shape[1]].max()))
        self.edge = max(self.edge, float(depth.max()))
        length = _measure_length(mesh, edges)
        share = np.maximum(depth, 0.0) / length[:, None]
        tool, edge, place = (int(i) for i in np.unravel_index(np.argmax(share), share.shape))
        self.share = max(self.share, float(share[tool, edge, place]))
        deep = float(max(depth[tool, edge, place], 0.0))
        cuts = [_Cut(f"the tool {list(tools)[tool]}", deep, float(length[edge]), along[edge, place])]
        cuts += _find_profiles_inside(along[:, [0, *range(edges.shape[1], along.shape[1]), 1]], length, tools)
        return max((cut.to_measure() for cut in cuts), key=lambda measure: measure.value)

    def note_in_space(
        self, mesh: Mesh, points: FloatArray, tools: Sequence[str], find_gaps: Callable[[FloatArray], FloatArray]
    ) -> Measure | None:
        """Do the same for a solid in space: at corners and in the middle of its boundary faces, by their longest edge.

        Faces of six nodes have their contact in the middle of their sides: their corners count as places between.

        points: of the nodes now (n_points, 3) [mm]; tools: names. find_gaps: of places from each tool
        (n_tools, n) [mm].
        """
        faces = mesh.boundary_faces
        if not tools or not len(faces):
            return None
        corners, touching = take_corners(faces), take_bearing(faces)
        between = [points[corners]] if not np.isin(corners, touching).all() else []
        along = np.concatenate([points[touching], *between, find_face_middles(points, faces)[:, None]], axis=1)
        depth = np.maximum(-find_gaps(along.reshape(-1, 3)).reshape(len(tools), *along.shape[:2]), 0.0)
        self.node = max(self.node, float(depth[:, :, : touching.shape[1]].max()))
        self.edge = max(self.edge, float(depth.max()))
        sides = mesh.points[corners] - mesh.points[np.roll(corners, -1, axis=1)]
        length = np.linalg.norm(sides, axis=2).max(axis=1)
        share = depth / length[:, None]
        tool, face, place = (int(i) for i in np.unravel_index(np.argmax(share), share.shape))
        self.share = max(self.share, float(share[tool, face, place]))
        cut = _Cut(f"the tool {tools[tool]}", float(depth[tool, face, place]), float(length[face]), along[face, place])
        return cut.to_measure()


class ToolCuts(Observer):
    """How deep tools are in solids, and bodies in each other."""

    def __init__(self) -> None:
        self._largest = Penetration()

    def measures(self, run: Observed) -> list[Measure]:
        """Return where a tool is deepest, and each pair of bodies."""
        gaps = run.tool_gaps()
        if gaps is None:
            return []
        mesh, points, largest = run.model.mesh, run.positions(), self._largest
        if run.model.dimension == 2:
            deepest = largest.note(mesh, points, gaps.profiles, gaps.find)
        else:
            deepest = largest.note_in_space(mesh, points, gaps.names, gaps.find)
        found = [deepest, *(measure_bodies(mesh, points, pair) for pair in gaps.pairs)]
        return [measure for measure in found if measure is not None]

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the largest penetrations of an implicit run."""
        gaps = run.tool_gaps()
        if gaps is None or gaps.tolerance is None:
            return {}
        return {
            "contact": {
                "tolerance_mm": gaps.tolerance,
                "largest_node_penetration_mm": self._largest.node,
                "largest_edge_penetration_mm": self._largest.edge,
                "largest_penetration_of_an_edge": self._largest.share,
                "tools_never_touched": find_never_touched(run.model, run.model.tools, history),
            }
        }

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return a warning where a tool has cut deep into an edge of an implicit run."""
        gaps, share = run.tool_gaps(), self._largest.share
        if gaps is None or gaps.tolerance is None or share <= CUT_EDGE:
            return []
        return [
            f"a tool has cut into an edge between two nodes by {share:.0%} of its length (no edge by more than "
            f"{self._largest.edge:.3g} mm): contact is at nodes, refine the mesh where tools are curved or narrow"
        ]

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the largest penetrations."""
        return {PENETRATION: np.array(astuple(self._largest))}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self._largest = Penetration(*(float(value) for value in arrays[PENETRATION]))


def measure_bodies(mesh: Mesh, points: FloatArray, edges: Mapping[str, IntArray]) -> Measure | None:
    """Return where two bodies are deepest in each other, by the length at the start of the edge that is cut.

    points: of the nodes now (n_points, 2) [mm]; edges: of the boundary of each body (n, 2 | 3). None if they are apart.
    """
    cuts = []
    for name, other in (tuple(edges), tuple(edges)[::-1]):
        own, cut = edges[name], edges[other]
        places = np.concatenate([points[own].reshape(-1, 2), _look_between(points, own).reshape(-1, 2)])
        along = np.concatenate([points[cut[:, :1]], _look_between(points, cut), points[cut[:, 1:2]]], axis=1)
        found = _find_deepest_inside(along, _measure_length(mesh, cut), places)
        if found:
            cuts.append(_Cut(f"the body {name}", *found, into=f"the body {other}"))
    return max((cut.to_measure() for cut in cuts), key=lambda measure: measure.value, default=None)


def _look_between(points: FloatArray, edges: IntArray) -> FloatArray:
    """Return places between the ends of edges (n_edges, m, 2) [mm]."""
    shapes = [edge_shape_functions(edges.shape[1], s)[0] for s in _BETWEEN]
    return np.stack([np.einsum("a,eai->ei", shape, points[edges]) for shape in shapes], axis=1)


def _measure_length(mesh: Mesh, edges: IntArray) -> FloatArray:
    """Return the lengths of edges at the start (n_edges,) [mm]."""
    return np.asarray(np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1))


def _find_profiles_inside(along: FloatArray, length: FloatArray, tools: Mapping[str, FloatArray]) -> list[_Cut]:
    """Return how deep each tool's profile reaches into the workpiece, if it does.

    along: places on the boundary edges in turn (n_edges, m, 2) [mm]; length: of the edges at the start (n_edges,) [mm].
    """
    spacing = _SPACING * float(length.mean())
    each = ((name, _find_deepest_inside(along, length, _trace(segments, spacing))) for name, segments in tools.items())
    return [_Cut(f"the tool {name}", *found) for name, found in each if found]


def _find_deepest_inside(
    along: FloatArray, length: FloatArray, places: FloatArray
) -> tuple[float, float, FloatArray] | None:
    """Return how deep the deepest of places (n, 2) is in a body, the length of the edge that it is nearest to, and it.

    along: places on the boundary edges in turn (n_edges, m, 2) [mm]; length: of the edges at the start (n_edges,) [mm].
    """
    sides = np.stack([along[:, :-1], along[:, 1:]], axis=2).reshape(-1, 2, 2)
    low, high = along.min(axis=(0, 1)), along.max(axis=(0, 1))
    places = places[((places > low) & (places < high)).all(axis=1)]
    places = places[contains(sides, places)]
    if not len(places):
        return None
    depth = measure_distance(sides, places)
    at = int(np.argmax(depth))
    edge = int(np.argmin(np.linalg.norm(along - places[at], axis=2).min(axis=1)))
    return float(depth[at]), float(length[edge]), places[at]


def _trace(segments: FloatArray, spacing: float) -> FloatArray:
    """Return places on a profile (n_segments, 7), about `spacing` apart (n, 2) [mm]."""
    places = []
    for x0, y0, x1, y1, cx, cy, turn in segments.tolist():
        start, end, centre = np.array([x0, y0]), np.array([x1, y1]), np.array([cx, cy])
        if turn == 0.0:
            n = min(int(np.linalg.norm(end - start) / spacing), _MOST_PLACES) + 2
            places.append(start + np.linspace(0.0, 1.0, n)[:, None] * (end - start))
            continue
        radius = float(np.linalg.norm(start - centre))
        first, last = (float(np.arctan2(*(p - centre)[::-1])) for p in (start, end))
        swept = turn * ((turn * (last - first)) % (2.0 * np.pi))
        angle = np.linspace(first, first + swept, min(int(abs(swept) * radius / spacing), _MOST_PLACES) + 6)
        places.append(centre + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.concatenate(places)
