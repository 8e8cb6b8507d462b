# SPDX-License-Identifier: Apache-2.0
"""Slivers of a triangulated sheet done away with: short edges collapsed, diagonals flipped, as local changes.

After Hoppe, DeRose, Duchamp, McDonald & Stuetzle 1993 and Garland & Heckbert 1997 in their steps, not in their measure:
a change is made where the triangles that it touches then lack less of the quality asked for, so that the work ends,
and where the surface stays within a tolerance. Points are never moved: those that stay lie where they lay, on the
facets given; rims, holes and sharp edges stay because leaving them would leave the tolerance. In each round those
changes are made that touch none of a better rank, all at once; the result depends on the mesh alone.

MMG does not replace it: with options that leave no sliver it sets so many points anew that blanks are three times off
their tolerance, with others slivers stay (tests/unit/mesh/test_remesh.py, tests/verification/test_one_step.py).
"""

from __future__ import annotations

import numpy as np

from presswork.mesh.topology import edge_keys, find_boundary_edges, list_cell_edges
from presswork.mesh.triangles import distance_to_segments, distance_to_triangles, double_areas, triangle_quality
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray

POOR = 0.2
"""Quality below which a triangle is a sliver: one of sides 1 and 8.5 at a right angle has 0.2, of equal sides 1."""
SURFACE, RIM = 5e-3, 1e-3
"""Distances from the surface and from its rims that are allowed, over the size of elements."""
_DEAD = 0.05
"""Quality below which a triangle's own normal is unreliable."""
_TURN, _TURN_OF_DEAD = 0.9, 0.5
"""Least cosine between a triangle's normal before and after."""
_WORST = 0.1
"""Share of the least quality round a point that a collapse may leave while slivers beside it are still to go."""
_ROUNDS, _CUTS = 200, 4


def mend_slivers(
    points: FloatArray, triangles: IntArray, size: float, *, below: float = POOR, may_cut: bool = True
) -> tuple[FloatArray, IntArray, int, int]:
    """Collapse and flip until no triangle has a quality below that given, as far as the tolerances allow.

    points (n_points, 3), triangles (n, 3) wound alike, no edge with more than two. size: of elements [mm]; no edge
    is made longer than 4/3 of it unless it was. may_cut: where nothing else helps, longest edges are cut too. Returns
    points, triangles, the number of edges collapsed and that of diagonals flipped.
    """
    sheet = _Sheet(points, triangles, size, below)
    collapsed = flipped = cuts = 0
    for _ in range(_ROUNDS):
        if not sheet.is_poor.any():
            break
        for every_edge in (False, True):
            n_collapsed, n_flipped = sheet.collapse(every_edge=every_edge), sheet.flip()
            collapsed, flipped = collapsed + n_collapsed, flipped + n_flipped
            if n_collapsed + n_flipped:
                break
        else:
            if not may_cut or cuts == _CUTS:
                break
            cuts += 1
            sheet.cut()
    used, numbers = np.unique(sheet.triangles, return_inverse=True)
    return sheet.points[used], numbers.reshape(-1, 3).astype(np.int32), collapsed, flipped


class _Sheet:
    """A triangulated sheet that changes, with how far it may have gone from where it was."""

    def __init__(self, points: FloatArray, triangles: IntArray, size: float, below: float) -> None:
        self.points = points
        self.triangles = triangles.astype(np.int32)
        self.error = np.zeros(len(points))
        """Largest possible distance from the original surface around each point (n_points,) [mm]."""
        self._size, self._below = size, below
        self._measure()

    def _measure(self) -> None:
        """Find what follows from the triangles."""
        t, n = self.triangles, len(self.points)
        self.quality = triangle_quality(self.points, t)
        self.is_poor = self.quality < self._below
        self._edges = list_cell_edges(t)
        """Half-edge 3 t + k runs from corner k of triangle t to the next."""
        self._keys = edge_keys(self._edges)
        order = np.argsort(self._keys, kind="stable")
        self._sorted_keys = self._keys[order]
        pairs = np.flatnonzero(self._sorted_keys[1:] == self._sorted_keys[:-1])
        self._twin = np.full(len(order), -1)
        self._twin[order[pairs]], self._twin[order[pairs + 1]] = order[pairs + 1], order[pairs]
        rim = find_boundary_edges([t])
        self._next, self._before = np.full(n, -1), np.full(n, -1)
        self._next[rim[:, 0]], self._before[rim[:, 1]] = rim[:, 1], rim[:, 0]
        self._rim_edges = np.bincount(rim.ravel(), minlength=n)
        self._of_point = np.argsort(t.ravel(), kind="stable")
        self._first = np.concatenate([[0], np.cumsum(np.bincount(t.ravel(), minlength=n))])

    def _is_edge(self, a: IntArray, b: IntArray) -> BoolArray:
        keys = edge_keys(np.stack([a, b], axis=1))
        at = np.minimum(np.searchsorted(self._sorted_keys, keys), len(self._sorted_keys) - 1)
        found: BoolArray = self._sorted_keys[at] == keys
        return found

    def _limit(self, longest: FloatArray) -> FloatArray:
        return np.asarray(np.maximum(4.0 / 3.0 * self._size, 1.01 * longest))

    def collapse(self, *, every_edge: bool) -> int:
        """Merge points of slivers into neighbours, over their shortest edges or over every edge; return how many."""
        poor = np.flatnonzero(self.is_poor)
        sides = self._edges[(3 * poor[:, None] + np.arange(3))]
        length = np.linalg.norm(self.points[sides[..., 0]] - self.points[sides[..., 1]], axis=2)
        ends = sides.reshape(-1, 2) if every_edge else sides[np.arange(len(poor)), np.argmin(length, axis=1)]
        ends = np.unique(np.concatenate([ends, ends[:, ::-1]]), axis=0)
        v, w = ends.T
        on_rim = (self._next[v] == w) | (self._before[v] == w)
        ends = ends[(self._rim_edges[v] == 0) | ((self._rim_edges[v] == 2) & on_rim)]
        if not len(ends):
            return 0
        v, w = ends.T
        count = self._first[v + 1] - self._first[v]
        starts = np.concatenate([[0], np.cumsum(count)[:-1]])
        row = np.repeat(np.arange(len(v)), count)
        corner = self._of_point[self._first[v][row] + np.arange(len(row)) - starts[row]]
        cell = corner // 3
        after, last = (self.triangles[cell, (corner + k) % 3] for k in (1, 2))
        kept = (after != w[row]) & (last != w[row])
        fits = self._keeps_topology(v, w, row, after)
        fits &= self._raises_quality(w, row, starts, cell, after, last, kept)
        error, is_near = self._deviation(v, w, row, starts, after, last, kept)
        fits &= is_near
        length = np.linalg.norm(self.points[v] - self.points[w], axis=1)
        rank = _rank(np.where(fits, np.round(np.log2(np.maximum(length, 1e-300))), np.inf))
        members = np.stack([v[row], after, last], axis=1)
        # what changes is alone in changing: its triangles; what is merged into, and the rings of what is merged
        of_cell, of_ring, of_goal = (np.full(n, len(v)) for n in (len(self.triangles), *2 * [len(self.points)]))
        ranks, of_fit = rank[row], fits[row]
        np.minimum.at(of_cell, cell[of_fit], ranks[of_fit])
        np.minimum.at(of_ring, members[of_fit], ranks[of_fit, None])
        np.minimum.at(of_goal, w[fits], rank[fits])
        alone = (of_cell[cell] == ranks) & (of_goal[members] >= ranks[:, None]).all(axis=1)
        chosen = fits & np.logical_and.reduceat(alone, starts) & (of_ring[w] >= rank)
        rows = chosen[row]
        np.maximum.at(self.error, members[rows], error[row[rows]][:, None])
        self.triangles[cell[rows], corner[rows] % 3] = w[row[rows]]
        stay = np.ones(len(self.triangles), dtype=bool)
        stay[cell[rows & ~kept]] = False
        self.triangles = self.triangles[stay]
        self._measure()
        return int(chosen.sum())

    def _keeps_topology(self, v: IntArray, w: IntArray, row: IndexArray, after: IntArray) -> BoolArray:
        """Return where the two ends have no neighbours in common but those across the edge (Dey et al. 1999)."""
        common = np.bincount(row, self._is_edge(after, w[row]) & (after != w[row]), len(v))
        before = self._before[v]  # the one neighbour of a point of the rim that no triangle names next
        common += (before >= 0) & (before != w) & self._is_edge(np.maximum(before, 0), w)
        on_rim = (self._next[v] == w) | (before == w)
        return np.asarray(common == np.where(on_rim, 1, 2), dtype=bool)

    def _raises_quality(
        self, w: IntArray, row: IndexArray, starts: IndexArray, cell: IndexArray, after: IntArray, last: IntArray,
        kept: BoolArray,
    ) -> BoolArray:  # fmt: skip
        """Return where triangles lack less of the quality asked for, none turns, and no edge grows too long."""
        x = self.points
        new = np.stack([w[row], after, last], axis=1)
        before, quality = self.quality[cell], np.where(kept, triangle_quality(x, new), np.inf)
        lack, lacked = (np.add.reduceat(np.maximum(self._below - q, 0.0), starts) for q in (quality, before))
        better = lack < lacked * (1.0 - 1e-6)
        better &= np.minimum.reduceat(quality, starts) > _WORST * np.minimum.reduceat(before, starts)
        then, now = double_areas(x, self.triangles[cell]), double_areas(x, new)
        around = np.add.reduceat(then, starts)[row]
        is_dead = self.quality[cell] < _DEAD
        cosine = _cosine(np.where(is_dead[:, None], around, then), now)
        turned = kept & (cosine < np.where(is_dead, _TURN_OF_DEAD, _TURN))
        corners = x[self.triangles[cell]]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        limit = self._limit(np.maximum.reduceat(longest, starts))[row]
        too_long = kept & (np.linalg.norm(x[after] - x[w[row]], axis=1) > limit)
        return np.asarray(better & ~np.logical_or.reduceat(turned | too_long, starts), dtype=bool)

    def _deviation(
        self, v: IntArray, w: IntArray, row: IndexArray, starts: IndexArray, after: IntArray, last: IntArray,
        kept: BoolArray,
    ) -> tuple[FloatArray, BoolArray]:  # fmt: skip
        """Return how far the points that go will be from the sheet, errors before included, and where that is near."""
        x = self.points
        distance = np.where(kept, distance_to_triangles(x[v[row]], x[w[row]], x[after], x[last]), np.inf)
        off = np.minimum.reduceat(distance, starts)
        on_rim = self._rim_edges[v] > 0
        beyond = np.where(self._next[v] == w, self._before[v], self._next[v])
        from_rim = np.where(on_rim, distance_to_segments(x[v], x[w], x[beyond]), 0.0)
        off = self.error[v] + np.where(np.isfinite(off), off, from_rim)
        near = (off <= SURFACE * self._size) & (~on_rim | (self.error[v] + from_rim <= RIM * self._size))
        return np.asarray(np.maximum(off, self.error[v] + from_rim)), near

    def flip(self) -> int:
        """Flip diagonals of slivers and their neighbours; return how many."""
        x = self.points
        half = (3 * np.flatnonzero(self.is_poor)[:, None] + np.arange(3)).ravel()
        half = half[self._twin[half] >= 0]
        half = np.unique(np.minimum(half, self._twin[half]))
        twin = self._twin[half]
        first, second = half // 3, twin // 3
        a, b = self._edges[half].T
        c, d = (self._edges[3 * (h // 3) + (h + 2) % 3, 0] for h in (half, twin))
        news = np.stack([np.stack([a, d, c], axis=1), np.stack([d, b, c], axis=1)])
        then = np.minimum(self.quality[first], self.quality[second])
        now = np.minimum(*(triangle_quality(x, new) for new in news))
        normal = double_areas(x, self.triangles[first]) + double_areas(x, self.triangles[second])
        across = np.cross(x[b] - x[a], x[d] - x[c])
        apart = np.abs(((x[c] - x[a]) * across).sum(axis=1)) / np.maximum(np.linalg.norm(across, axis=1), 1e-300)
        corners = np.stack([a, b, c, d], axis=1)
        error = self.error[corners].max(axis=1) + apart
        fits = (now > then * (1.0 + 1e-6)) & (error <= SURFACE * self._size) & ~self._is_edge(c, d)
        for new in news:
            fits &= _cosine(normal, double_areas(x, new)) > _TURN_OF_DEAD
        fits &= np.linalg.norm(x[c] - x[d], axis=1) <= self._limit(np.linalg.norm(x[a] - x[b], axis=1))
        fits = np.flatnonzero(fits)
        fits = fits[np.sort(np.unique(edge_keys(corners[fits, 2:]), return_index=True)[1])]
        cells = np.stack([first[fits], second[fits]], axis=1)
        chosen = fits[_are_first(cells, np.round(32.0 * (then - now)[fits]), len(self.triangles))]
        np.maximum.at(self.error, corners[chosen], error[chosen][:, None])
        self.triangles[first[chosen]], self.triangles[second[chosen]] = news[:, chosen]
        self._measure()
        return len(chosen)

    def cut(self) -> None:
        """Cut the longest edges of slivers where the corner across stands over them, as far as near the middle."""
        x = self.points
        poor = np.flatnonzero(self.is_poor)
        sides = self._edges[3 * poor[:, None] + np.arange(3)]
        length = np.linalg.norm(x[sides[..., 0]] - x[sides[..., 1]], axis=2)
        half = 3 * poor + np.argmax(length, axis=1)
        other = np.where(self._twin[half] >= 0, self._twin[half], half)
        half, at = np.unique(np.minimum(half, other), return_index=True)
        cells = np.stack([half, np.maximum(half, self._twin[half])], axis=1) // 3
        half = half[_are_first(cells, -np.round(length.max(axis=1)[at] / self._size), len(self.triangles))]
        a, b = self._edges[half].T
        c = self._edges[3 * (half // 3) + (half + 2) % 3, 0]
        foot = ((x[c] - x[a]) * (x[b] - x[a])).sum(axis=1) / ((x[b] - x[a]) ** 2).sum(axis=1)
        middle = len(x) + np.arange(len(half))
        self.points = np.concatenate([x, x[a] + np.clip(foot, 0.25, 0.75)[:, None] * (x[b] - x[a])])
        self.error = np.concatenate([self.error, np.maximum(self.error[a], self.error[b])])
        added = []
        for side, start in ((half, a), (self._twin[half], b)):
            inner = side >= 0
            cell, corner = side[inner] // 3, side[inner] % 3
            new = self.triangles[cell]
            new[np.arange(len(new)), corner] = middle[inner]  # from the middle to the edge's end
            self.triangles[cell, (corner + 1) % 3] = middle[inner]  # from its start to the middle
            assert (self.triangles[cell, corner] == start[inner]).all()
            added.append(new)
        self.triangles = np.concatenate([self.triangles, *added])
        self._measure()


def _cosine(a: FloatArray, b: FloatArray) -> FloatArray:
    sizes = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    return np.asarray((a * b).sum(axis=1) / np.maximum(sizes, 1e-300))


def _rank(order: FloatArray) -> IndexArray:
    """Return the place of each in the order; equals are shuffled, always alike, so that chains of them are not long."""
    shuffled = np.arange(len(order), dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    rank = np.empty(len(order), dtype=np.int64)
    rank[np.lexsort((shuffled, order))] = np.arange(len(order))
    return rank


def _are_first(members: IndexArray, order: FloatArray, n: int) -> BoolArray:
    """Return which rows share no member (of n) with a row of a better rank."""
    rank = _rank(order)
    best = np.full(n, len(order))
    np.minimum.at(best, members, rank[:, None])
    return np.asarray((best[members] == rank[:, None]).all(axis=1), dtype=bool)
