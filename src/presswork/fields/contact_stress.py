# SPDX-License-Identifier: Apache-2.0
"""Contact stress from nodal forces: a field whose integral is the force, and that the material can carry.

The field is linear between neighbouring nodes of the boundary; a quadratic edge counts as two halves. The surface in
contact consists of the edges (halves) both of whose nodes are held. Where it ends, the traction falls to zero within
the next edge, sooner the faster that edge leaves the tool; a held node without a held neighbour takes both edges beside
it whole. A node's area A_a is the integral of its hat function over that surface, so sum_a A_a t_a is the integral.

1. A mid-side node's force is shared with its edge's ends, so that a uniform traction gives the nodes their areas.
2. Nodal forces alternate from node to node in many elements, so they are smoothed: an edge's mean stress is that of its
   nodes' parts of the forces, and a node takes the mean of its edges' stresses, weighted by its parts of their areas.
   What that has taken off is smoothed and put back (Tukey's twicing): an alternation is gone, and a stress that is
   cubic along equal edges stays as it is. The sum of the forces stays too. Nothing is carried round corners of the
   surface, or from one tool to another.
3. `confine` moves what exceeds a bound to the nearest nodes along the boundary that have room.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.edges import edge_shape_functions
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Model, find_cell

LEAVES = 2.0
"""An edge beside the contact counts by 1 - LEAVES gap / length of its free node: not at all from 30 degrees on."""
CORNER = np.cos(np.radians(30.0))
"""Cosine of the turn between edges above which their node is a corner."""


@dataclass(frozen=True)
class ContactForces:
    """Forces of tools on the nodes that they hold: one entry for each pair of node and tool, n in all."""

    nodes: IntArray
    """(n,); a node that two tools hold comes twice."""
    tool: IndexArray
    """Index into Model.plane_tools (n,)."""
    segment: IntArray
    """Segment of the tool's profile that the node touches (n,); in an inner corner that of the first face."""
    normal: FloatArray
    """Normal of the tool, into the workpiece (n, 2); in an inner corner that of the first face."""
    in_corner: BoolArray
    """Whether two faces hold the node (n,)."""
    push: FloatArray
    """Force of contact along the normal into the workpiece (n,) [N]; in an inner corner of a tool the sum over both
    faces."""
    drag: FloatArray
    """Friction along the tangent, a quarter turn on from the normal (n,) [N]; none in an inner corner."""
    force: FloatArray
    """The whole force (n, 2) [N]."""
    status: NDArray[np.int8]
    """Contact of every node (n_points,): 0 apart, 1 held along the normal, 2 held in both directions."""
    gap: FloatArray
    """Distance of every node from the nearest tool (n_points,) [mm]; NaN inside the body and where there is none."""
    factor: FloatArray | None = None
    """Factor on m and mu, by speed, path and temperature (n,); None: one."""


@dataclass(frozen=True)
class BodyTraction:
    """What deformable bodies do to each other, at the nodes."""

    pressure: FloatArray
    """(n_points,) [MPa]."""
    shear: FloatArray
    """Shear along the boundary, body on the right (n_points,) [MPa]."""
    force: FloatArray
    """(n_points, 2) [N]."""


class ContactSurface:
    """The surface in contact at one instant, and the nodes' areas on it."""

    def __init__(
        self, edges: IntArray, points: FloatArray, held: BoolArray, gap: FloatArray, *, depth: float | None
    ) -> None:
        """Take boundary edges (n_edges, 2 | 3), deformed points (n_points, 2) [mm], which nodes are held and the gap
        of each (n_points,) [mm], NaN for none. depth [mm]; None: rings, in axisymmetry.
        """
        self._held = held
        halves, parts, whole = split_edges(edges, points, depth)
        self._middles, self._ends = _share_middles(edges, parts, whole, held)
        used = np.abs(parts).max(axis=1, initial=0.0) > 1e-9 * np.abs(parts).max(initial=0.0)  # not on the axis
        both = held[halves].all(axis=1)
        joined = np.zeros(len(points), dtype=bool)
        joined[halves[both & used]] = True
        counted = parts * _touching_part(halves, points, held, gap, joined)[:, None]
        counted[~held[halves]] = 0.0
        self._edges, self._parts = halves[both & used], parts[both & used]
        self._of_edge = np.tile(np.arange(len(edges)), len(halves) // max(len(edges), 1))[both & used]
        self._neighbours = halves[used]
        self._points = points
        self.nodal_area = np.zeros(len(points))
        """The integral of every node's hat function over the surface in contact (n_points,) [mm2]."""
        np.add.at(self.nodal_area, halves, counted)

    def corners(self) -> BoolArray:
        """Return the nodes (n_points,) at which the surface in contact turns sharply."""
        towards = np.zeros((2, len(self._points), 2))
        for side, sign in ((0, -1.0), (1, 1.0)):
            own, other = self._edges[:, side], self._edges[:, 1 - side]
            along = sign * (self._points[own] - self._points[other])
            towards[side, own] = along / np.linalg.norm(along, axis=1, keepdims=True)
        between = (towards[0] != 0).any(axis=1) & (towards[1] != 0).any(axis=1)
        return np.asarray(between & (np.einsum("ni,ni->n", *towards) < CORNER), dtype=bool)

    def share(self, force: FloatArray) -> FloatArray:
        """Return nodal forces (n_points,) [N], those of quadratic edges' mid-sides shared with the ends."""
        shared = force.copy()
        for end, part in self._ends:
            moved = part * force[self._middles]
            np.add.at(shared, end, moved)
            np.add.at(shared, self._middles, -moved)
        return shared

    def smooth(self, force: FloatArray, joins: BoolArray) -> FloatArray:
        """Return shared nodal forces (n_points,) [N] smoothed along the edges whose nodes all join (n_points,)."""
        once = self._average(force, joins)
        twice: FloatArray = 2 * once - self._average(once, joins)
        return twice

    def _average(self, force: FloatArray, joins: BoolArray) -> FloatArray:
        """Return nodal forces averaged over edges once: along equal edges the weights are 1/4, 1/2, 1/4."""
        kept = joins[self._edges].all(axis=1)
        edges, parts, of_edge = self._edges[kept], self._parts[kept], self._of_edge[kept]
        rate = self.stress_of(force)
        count = int(of_edge.max(initial=-1)) + 1
        own = parts * rate[edges]
        total, area = (np.bincount(of_edge, values.sum(axis=1), count) for values in (own, parts))
        mean = total / np.maximum(area, 1e-300)
        averaged: FloatArray = force.copy()
        np.add.at(averaged, edges, parts * mean[of_edge][:, None] - own)
        return averaged

    def stress_of(self, force: FloatArray) -> FloatArray:
        """Return the stress (n_points,) [MPa] of nodal forces [N]; zero where no area is."""
        return np.divide(force, self.nodal_area, out=np.zeros_like(force), where=self.nodal_area > 0)

    def chains(self, chosen: BoolArray) -> list[Chain]:
        """Return the chosen nodes (n_points,) that have an area, in order along each boundary."""
        chosen = chosen & (self.nodal_area > 0)
        return [
            Chain(loop[here], along[here], np.cumsum(np.diff(here, prepend=here[:1]) > 1))
            for loop, along in self._loops(chosen)
            if len(here := np.flatnonzero(chosen[loop]))
        ]

    def _loops(self, chosen: BoolArray) -> list[tuple[IntArray, FloatArray]]:
        """Return the boundaries' nodes in order and their arc lengths [mm]; closed ones from a node not chosen on."""
        following = dict(self._neighbours.tolist())
        starts = sorted(set(following) - set(following.values()))
        apart = sorted(node for node in following if not chosen[node])
        seen: set[int] = set()
        loops = []
        for start in [*starts, *apart, *sorted(following)]:
            loop = []
            node: int | None = start
            while node is not None and node not in seen:
                seen.add(node)
                loop.append(node)
                node = following.get(node)
            if loop:
                nodes = np.array(loop, dtype=np.int32)
                steps = np.linalg.norm(np.diff(self._points[nodes], axis=0), axis=1)
                loops.append((nodes, np.concatenate([[0.0], np.cumsum(steps)])))
        return loops


@dataclass(frozen=True)
class Chain:
    """Nodes in contact along one boundary."""

    nodes: IntArray
    """(n,)."""
    place: FloatArray
    """Arc length along the boundary (n,) [mm]."""
    patch: IndexArray
    """Number of the connected part that a node belongs to (n,)."""


def split_edges(edges: IntArray, points: FloatArray, depth: float | None) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the edges or their halves (m, 2), the integrals of both hats over each (m, 2), and those of the shape
    functions over whole edges (n_edges, 2 | 3) [mm2]. For quadratic edges all first halves come first.
    """
    if not find_cell(1, edges).is_quadratic:
        parts, whole = _integrate_hats(points, edges, depth, -1.0, 1.0)
        return edges, parts, whole
    first, of_first = _integrate_hats(points, edges, depth, -1.0, 0.0)
    second, of_second = _integrate_hats(points, edges, depth, 0.0, 1.0)
    halves = np.concatenate([edges[:, ends] for ends in find_cell(1, edges).pieces])
    return halves, np.concatenate([first, second]), of_first + of_second


def _share_middles(
    edges: IntArray, parts: FloatArray, whole: FloatArray, held: BoolArray
) -> tuple[IntArray, list[tuple[IntArray, FloatArray]]]:
    """Return the mid-sides of quadratic edges held whole, and the ends with the part of its force that each takes."""
    if not find_cell(1, edges).is_quadratic:
        return np.zeros(0, dtype=np.int32), []
    n = len(edges)
    own = held[edges].all(axis=1) & (whole[:, 2] > 0)
    edges, whole, first, last = edges[own], whole[own], parts[:n][own], parts[n:][own]
    taken = [(0, first[:, 0] - whole[:, 0]), (1, last[:, 1] - whole[:, 1])]
    return edges[:, 2], [(edges[:, i], area / whole[:, 2]) for i, area in taken]


def _touching_part(
    halves: IntArray, points: FloatArray, held: BoolArray, gap: FloatArray, joined: BoolArray
) -> FloatArray:
    """Return how far the contact reaches into each edge or half (m,), from 0 to 1."""
    count = held[halves].sum(axis=1)
    length = np.linalg.norm(points[halves[:, 1]] - points[halves[:, 0]], axis=1)
    place = np.arange(len(halves))
    inside = halves[place, np.where(held[halves[:, 0]], 0, 1)]
    outside = halves[place, np.where(held[halves[:, 0]], 1, 0)]
    opening = np.nan_to_num(np.abs(gap[outside]), nan=np.inf) / np.maximum(length, 1e-300)
    reach = np.where(joined[inside], np.clip(1 - LEAVES * opening, 0.0, 1.0), 1.0)
    part: FloatArray = np.select([count == 2, count == 1], [np.ones(len(halves)), reach], 0.0)
    return part


def confine(
    chain: Chain, stress: FloatArray, area: FloatArray, low: FloatArray, high: FloatArray, reach: int | None = None
) -> FloatArray:
    """Return a chain's stresses (n,), moved to within bounds with the same sum of stress times area.

    What a node has too much goes to the nearest nodes that have room, to those of its own patch first, `reach` nodes
    away at most. What finds no room stays.
    """
    force = stress * area
    least, most = low * area, high * area
    over = np.maximum(force - most, 0.0) + np.minimum(force - least, 0.0)
    for node in np.argsort(-np.abs(over), kind="stable"):
        sign = np.sign(over[node])
        if sign == 0:
            break
        bound = most if sign > 0 else least
        distance = np.abs(chain.place - chain.place[node])
        order = np.lexsort((distance, chain.patch != chain.patch[node]))
        for other in order if reach is None else order[np.abs(order - node) <= reach]:
            excess = sign * (force[node] - bound[node])
            moved = sign * min(excess, max(sign * (bound[other] - force[other]), 0.0))
            force[node] -= moved
            force[other] += moved
            if excess <= abs(moved):
                break
    confined: FloatArray = force / area
    return confined


def shares_by_edge(points: FloatArray, edges: IntArray, depth: float | None) -> FloatArray:
    """Return int N_a dA of every edge and node (n_edges, 2 | 3) [mm2]; depth [mm], or None for whole rings.

    Exact for straight edges; twelve points for quadratic ones, which are strongly curved where they fold onto a tool.
    """
    return _integrate_hats(points, edges, depth, -1.0, 1.0)[1]


def _integrate_hats(
    points: FloatArray, edges: IntArray, depth: float | None, start: float, end: float
) -> tuple[FloatArray, FloatArray]:
    """Return the integrals of the falling and the rising hat between s = start and end (n_edges, 2), and those of the
    shape functions there (n_edges, 2 | 3) [mm2].
    """
    n_nodes = edges.shape[1]
    x = points[edges]
    weight, rise, N, dN = _hats(n_nodes, start, end)
    area = 0.5 * (end - start) * weight * np.linalg.norm(np.einsum("sa,eai->esi", dN, x), axis=2)
    area *= 2 * np.pi * (x[:, :, 0] @ N.T) if depth is None else depth
    return area @ np.column_stack([1 - rise, rise]), area @ N


@cache
def _hats(n_nodes: int, start: float, end: float) -> tuple[FloatArray, ...]:
    """Return weights, the rising hat, shape functions and their slopes at the points of the rule between two places."""
    s, weight = _edge_rule(n_nodes)
    rise = 0.5 * (s + 1)
    at = start + (end - start) * rise
    N, dN = (np.array(v) for v in zip(*(edge_shape_functions(n_nodes, place) for place in at), strict=True))
    return weight, rise, N, dN


def _edge_rule(n_nodes: int) -> tuple[FloatArray, FloatArray]:
    """Return places and weights of the points by which an edge of 2 or 3 nodes is integrated."""
    s, weight = np.polynomial.legendre.leggauss({2: 2, 3: 12}[n_nodes])
    return s, weight


def edge_shares(model: Model, points: FloatArray, edges: IntArray, part: FloatArray | None = None) -> FloatArray:
    """Return int N_a dA of every node over the edges, (n_points,) [mm2]; whole rings in axisymmetry.

    part: of each edge that counts (n_edges,).
    """
    share = np.zeros(len(points))
    by_edge = shares_by_edge(points, edges, None if model.analysis == "axisymmetric" else model.depth)
    np.add.at(share, edges, by_edge if part is None else part[:, None] * by_edge)
    return share
