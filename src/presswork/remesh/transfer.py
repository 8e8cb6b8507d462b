# SPDX-License-Identifier: Apache-2.0
"""Values at points of an old mesh, found at points of a new one.

Integration points: quadratic moving least squares over the DONORS nearest points (Lancaster & Salkauskas 1981), from
point to point without a detour over the nodes. Weights max(1 - (d / 1.05 d12)^2, 1e-3)^2, d12 the distance of the
farthest; basis 1, x, y, x^2, x y, y^2 about the new point. The result is clipped to the range of the donors and of the
linear fit, so that a linear field is kept beyond the outermost donors too. Donors are cells not farther than RINGS
neighbours along the mesh: what lies beyond a fold does not count.

Nodes: the shape functions of the old cell they lie in, its plane continued where they lie outside by a little.

Boundary: cubic Hermite polynomials along its arc, with slopes that keep monotone values monotone (Fritsch & Carlson
1980, with the means of Fritsch & Butland 1984) but for kinks, such as corners: linear values along a side stay so, and
those that are the same all along it to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from scipy.spatial import cKDTree

from presswork.model import BoolArray, FloatArray, IndexArray

DONORS, RINGS = 12, 4
KINK = 0.25
"""Slope on one side of a node of a line over that on the other, below which the line of values has a kink there."""
_REACH, _LEAST_WEIGHT, _RIDGE = 1.05, 1e-3, 1e-13
_MISSED = 1e-6
"""Part of a value that a fit may miss without a peak being lost."""
_ENOUGH_FOR_SQUARES, _ENOUGH_FOR_LINES = 8, 4
_AT_ONCE = 2_000
_CLOSEST = 4
"""Old points to each that are asked first whether they are above it: few points are left to be fitted."""
_CANDIDATES = (3, 16)
"""Nearest cells that are asked whether they contain a point, then those of points that none of these contains."""


@dataclass(frozen=True)
class PointTransfer:
    """What every new point takes from which old points."""

    donor: IndexArray
    """(n_new, DONORS); the closest one again where there are fewer."""
    is_donor: BoolArray
    """(n_new, DONORS)."""
    weight: FloatArray
    """Of the quadratic fit's value (n_new, DONORS)."""
    linear_weight: FloatArray
    """Of the linear fit's (n_new, DONORS)."""
    closest: IndexArray
    """Which donor is the nearest (n_new,): values are counted from its own, so that a constant stays one."""

    def apply(self, values: FloatArray) -> FloatArray:
        """Return values (n_old, m) at the new points (n_new, m)."""
        result = np.empty((len(self.donor), values.shape[1]))
        for first in range(0, len(self.donor), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            donor = self.donor[part]
            nearest = values[donor[np.arange(len(donor)), self.closest[part]]]
            given = values.take(donor, axis=0) - nearest[:, None]
            linear = np.einsum("nd,ndm->nm", self.linear_weight[part], given)
            low, high = linear.copy(), linear.copy()
            for own in np.moveaxis(given, 1, 0):
                np.minimum(low, own, out=low)
                np.maximum(high, own, out=high)
            result[part] = nearest + np.clip(np.einsum("nd,ndm->nm", self.weight[part], given), low, high)
        return result


class NearCells:
    """Pairs of cells that are at most RINGS neighbours apart."""

    def __init__(self, cells: IndexArray) -> None:
        """cells: connectivity (n_cells, 3 | 4)."""
        n_cells, n_corners = cells.shape
        row = np.repeat(np.arange(n_cells), n_corners)
        ones = np.ones(cells.size, dtype=np.int32)
        at_node = scipy.sparse.csr_array((ones, (row, cells.ravel())), shape=(n_cells, int(cells.max()) + 1))
        beside = at_node @ at_node.T
        half = beside
        for _ in range(RINGS // 2 - 1):
            half = half @ beside
        half.sort_indices()
        half.data[:] = 1
        self._n, self._half = n_cells, half
        self._keys = np.repeat(np.arange(n_cells, dtype=np.int64) * n_cells, np.diff(half.indptr)) + half.indices

    def are_near(self, home: IndexArray, cells: IndexArray) -> BoolArray:
        """Say which cells (n, k) are near those of home (n,)."""
        wanted = home[:, None].astype(np.int64) * self._n + cells
        at = np.minimum(np.searchsorted(self._keys, wanted), len(self._keys) - 1)
        near = np.asarray(self._keys[at] == wanted)
        first, second = np.divmod(wanted[~near], self._n)
        near[~near] = self._half[first].multiply(self._half[second]).sum(axis=1) > 0  # they meet half-way
        return near


@dataclass(frozen=True)
class OldPoints:
    """Points of an old mesh, from which values at new ones are found."""

    position: FloatArray
    """(n_old, 2) [mm]."""
    near: NearCells | None = None
    """Of the old mesh; None: every old point may be a donor."""
    cell_of: IndexArray | None = None
    """The old cell of each (n_old,)."""

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.position)

    @cached_property
    def _closest(self) -> tuple[IndexArray, BoolArray]:
        """A few old points nearest to each, and which of them are its donors, without itself (n_old, k) each."""
        n = len(self.position)
        _, donor = self._tree.query(self.position, k=min(_CLOSEST, n))
        donor = donor.reshape(n, -1)
        counts = donor != np.arange(n)[:, None]
        if self.near is not None and self.cell_of is not None:
            counts &= self.near.are_near(self.cell_of, self.cell_of[donor])
        return donor, counts

    def find_transfer(self, new: FloatArray, home: IndexArray | None = None) -> PointTransfer:
        """Return how values at these points are found at new ones (n_new, 2) [mm].

        home: the old cell in or beside which each new point lies (n_new,); without it every old point may be a donor.
        """
        old = self.position
        n_donors = min(DONORS, len(old))
        distance, donor = self._tree.query(new, k=n_donors)
        distance, donor = distance.reshape(len(new), -1), donor.reshape(len(new), -1)
        is_donor = np.ones(donor.shape, dtype=bool)
        if self.near is not None and self.cell_of is not None and home is not None:
            is_donor = self.near.are_near(home, self.cell_of[donor])
            lacking = np.flatnonzero(~is_donor.all(axis=1))
            if len(lacking):
                farther, more = self._tree.query(new[lacking], k=min(5 * n_donors, len(old)))
                good = self.near.are_near(home[lacking], self.cell_of[more])
                first = np.argsort(~good, axis=1, kind="stable")[:, :n_donors]
                row = np.arange(len(lacking))[:, None]
                donor[lacking], distance[lacking] = more[row, first], farther[row, first]
                is_donor[lacking] = good[row, first]
                none = lacking[~is_donor[lacking].any(axis=1)]
                is_donor[none, 0] = True
        weights = [
            _fit(old, new[part], donor[part], distance[part], is_donor[part])
            for part in (slice(i, i + _AT_ONCE) for i in range(0, len(new), _AT_ONCE))
        ]
        quadratic, linear = (np.concatenate(w) for w in zip(*weights, strict=True))
        closest = np.where(is_donor, distance, np.inf).argmin(axis=1)
        donor = np.where(is_donor, donor, donor[np.arange(len(new)), closest][:, None])
        return PointTransfer(donor, is_donor, quadratic, linear, closest)

    def find_peaks(self, given: FloatArray) -> IndexArray:
        """Return the points whose value (n_old,) is above those of all their donors, and which the fit misses."""
        donor, counts = self._closest
        peaks = np.flatnonzero(~(counts & (given[donor] >= given[:, None])).any(axis=1))
        if not len(peaks):
            return peaks
        fit = self.find_transfer(self.position[peaks], None if self.cell_of is None else self.cell_of[peaks])
        others = np.where(fit.is_donor & (fit.donor != peaks[:, None]), given[fit.donor], -np.inf)
        missed = given[peaks] - fit.apply(given[:, None])[:, 0]
        is_lost = (given[peaks] > others.max(axis=1)) & (missed > _MISSED * np.abs(given[peaks]))
        return np.asarray(peaks[is_lost])


def keep_peaks(
    given: FloatArray, found: FloatArray, volume: FloatArray, old: OldPoints, new: FloatArray, fit: PointTransfer
) -> FloatArray:
    """Return a field found at new points (n_new,) with the peaks that it has at old points, `given` (n_old,).

    A least-squares fit flattens a peak of a single point. So the value of an old point that is above all its donors,
    and that the fit misses, goes to the new point nearest to it; all others lose as much by volume (n_new,) [mm3], in
    proportion, so that the integral stays. Fields that the fit follows, those of the second order, stay as they are.
    new: places of the new points (n_new, 2) [mm]; fit: from the old ones to them.
    """
    peaks = old.find_peaks(given)
    result, is_peak = found.copy(), np.zeros(len(found), dtype=bool)
    wanted = np.zeros(len(given), dtype=bool)
    wanted[peaks] = True
    taker, which = np.nonzero(wanted[fit.donor] & fit.is_donor)
    peak = fit.donor[taker, which]
    distance = np.linalg.norm(new[taker] - old.position[peak], axis=1)
    order = np.lexsort((taker, distance, peak))
    _, first = np.unique(peak[order], return_index=True)
    nearest = order[first]
    np.maximum.at(result, taker[nearest], given[peak[nearest]])
    is_peak[taker[nearest]] = True
    added = float(((result - found) * volume).sum())
    rest = float((result * volume)[~is_peak].sum())
    if 0.0 < added < rest:
        result[~is_peak] *= 1.0 - added / rest
    return result


def _fit(
    old: FloatArray, new: FloatArray, donor: IndexArray, distance: FloatArray, is_donor: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return the donors' weights in the value of the quadratic and of the linear fit, each (n_new, n_donors)."""
    reach = np.where(is_donor, distance, 0.0).max(axis=1)
    reach = np.where(reach > 0.0, reach, 1.0)
    weight = np.maximum(1.0 - (distance / (_REACH * reach[:, None])) ** 2, _LEAST_WEIGHT) ** 2 * is_donor
    x, y = ((old[:, k].take(donor) - new[:, k, None]) / reach[:, None] for k in (0, 1))
    basis = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    weighted = basis * weight[..., None]
    moment = weighted.transpose(0, 2, 1) @ basis
    count = is_donor.sum(axis=1)
    linear = _solve(weighted[..., :3], moment[:, :3, :3])
    quadratic = _solve(weighted, moment)
    nearest = np.zeros_like(linear)
    closest = np.where(is_donor, distance, np.inf).argmin(axis=1)
    nearest[np.arange(len(new)), closest] = 1.0
    linear = np.where((count >= _ENOUGH_FOR_LINES)[:, None], linear, nearest)
    return np.where((count >= _ENOUGH_FOR_SQUARES)[:, None], quadratic, linear), linear


def _solve(weighted: FloatArray, moment: FloatArray) -> FloatArray:
    """Return the donors' weights in a weighted least-squares fit's value at the origin (n_new, n_donors).

    weighted: basis times weight (n_new, n_donors, k), moment: its product with the basis (n_new, k, k).
    """
    ridge = _RIDGE * np.maximum(np.trace(moment, axis1=1, axis2=2), 1e-300)
    diagonal = np.arange(moment.shape[-1])
    moment = moment.copy()
    moment[:, diagonal, diagonal] += ridge[:, None]
    unit = np.zeros((*moment.shape[:2], 1))
    unit[:, 0] = 1.0
    return np.asarray((weighted @ np.linalg.solve(moment, unit))[..., 0])


@dataclass(frozen=True)
class Places:
    """Where points lie in a mesh."""

    cell: IndexArray
    """(n,)."""
    nodes: IndexArray
    """Corners of the triangle of that cell (n, 3)."""
    share: FloatArray
    """Barycentric coordinates in it (n, 3); negative ones for points outside the mesh."""

    def interpolate(self, values: FloatArray) -> FloatArray:
        """Return values of the nodes (n_nodes, m) at the points (n, m)."""
        return np.asarray(np.einsum("na,nam->nm", self.share, values[self.nodes]))


def locate(points: FloatArray, cells: IndexArray, wanted: FloatArray) -> Places:
    """Find the cell (triangles or quadrilaterals) in which, or nearest to which, each wanted point (n, 2) lies."""
    tree = cKDTree(points[cells].mean(axis=1))
    best = np.full(len(wanted), -np.inf)
    cell, nodes = np.zeros(len(wanted), dtype=np.intp), np.zeros((len(wanted), 3), dtype=np.intp)
    share = np.zeros((len(wanted), 3))
    for count in _CANDIDATES:
        left = np.flatnonzero(best < 0.0)  # those that no cell looked at so far contains
        n_near = min(count, len(cells))
        _, near = tree.query(wanted[left], k=n_near)
        for candidate in near.reshape(len(left), n_near).T:
            for corners in ((0, 1, 2), (0, 2, 3))[: cells.shape[1] - 2]:
                open_ = best[left] < 0.0
                asked, own = left[open_], candidate[open_]
                triangle = cells[own][:, corners]
                found, rank = _measure_inside(points, triangle, wanted[asked])
                better = rank > best[asked]
                chosen = asked[better]
                best[chosen], cell[chosen] = rank[better], own[better]
                nodes[chosen], share[chosen] = triangle[better], found[better]
    return Places(cell, nodes, share)


def interpolate_along(points: FloatArray, values: FloatArray, part: FloatArray) -> FloatArray:
    """Return values (n, m) on a line, each at a part (n,) of the way from the second to the third of four points.

    points: of the line one after the other (n, 4, 2) [mm]; values: there (n, 4, m).
    """
    length = np.linalg.norm(np.diff(points, axis=1), axis=2)[..., None]
    rise = np.diff(values, axis=1) / length
    before, after = (_mean_slope(rise[:, i : i + 2], length[:, i : i + 2], 1 - i) * length[:, 1] for i in (0, 1))
    t = part[:, None]
    found = values[:, 1] + t**2 * (3.0 - 2.0 * t) * (values[:, 2] - values[:, 1])
    return np.asarray(found + t * (1.0 - t) ** 2 * before - t**2 * (1.0 - t) * after)


def _mean_slope(rise: FloatArray, length: FloatArray, own: int) -> FloatArray:
    """Return the slope (n, m) between two sides with slopes (n, 2, m) and lengths (n, 2, 1); at a kink that of one."""
    weight = length.sum(axis=1, keepdims=True) + length[:, ::-1]
    low, high = np.minimum(rise[:, 0], rise[:, 1]), np.maximum(rise[:, 0], rise[:, 1])
    is_smooth = (low > KINK * high) & (low > 0.0) | (high < KINK * low) & (high < 0.0)
    inverse = (weight / np.where(is_smooth[:, None], rise, 1.0)).sum(axis=1)
    return np.asarray(np.where(is_smooth, weight.sum(axis=1) / inverse, rise[:, own]))


def _measure_inside(points: FloatArray, triangle: IndexArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return barycentric coordinates (n, 3) of points in triangles, and how far outside they lie (n,) [-mm]; 1: inside.

    A distance and no coordinate, so that flat triangles do not win from afar.
    """
    a, b, c = points[triangle].transpose(1, 0, 2)
    u, v, w = b - a, c - a, wanted - a
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    safe = np.where(np.abs(double) > 1e-300, double, 1e-300)
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / safe
    t = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / safe
    found = np.stack([1.0 - s - t, s, t], axis=1)
    inside = np.minimum(np.minimum(found[:, 0], s), t)
    rank = np.where(inside >= -1e-12, 1.0, inside * np.sqrt(np.abs(double)))
    return found, np.where(double > 0.0, rank, -np.inf)
