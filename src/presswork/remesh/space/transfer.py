# SPDX-License-Identifier: Apache-2.0
"""Values at points of old tetrahedra, found at points of new ones.

Integration points and nodes: quadratic moving least squares over the DONORS nearest points, from point to point, as in
the plane: weights max(1 - (d / 1.05 d_max)^2, 1e-3)^2, d_max the distance of the farthest, ten terms about the new
point; clipped to the range of the donors and of the linear fit. Donors lie in cells that share a node with the new
point's cell, or with such a cell: what lies beyond a fold does not count.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from presswork import _core
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray
from presswork.remesh.transfer import Places

DONORS = 20
_REACH, _LEAST_WEIGHT, _RIDGE = 1.05, 1e-3, 1e-15
_ENOUGH_FOR_SQUARES, _ENOUGH_FOR_LINES = 14, 6
_AT_ONCE = 2_000
_CANDIDATES = (4, 32)
"""Nearest cells that are asked whether they contain a point, then those of points that none of these contains."""
_FARTHER = 4
"""Factor on the number of points among which donors are searched where the nearest ones lie beyond a fold."""
_FIRST = 6
"""Donors that are looked at first where a peak is sought."""
_MISSED = 1e-6
"""Part of a value that a fit may miss without a peak being lost."""


@dataclass(frozen=True)
class FitInSpace:
    """What every new point takes from which old points."""

    donor: IntArray
    """(n_new, DONORS), the nearest first, and again where there are fewer."""
    weight: FloatArray
    """Weight of the quadratic fit's value (n_new, DONORS)."""
    linear_weight: FloatArray
    """Weight of the linear fit's value (n_new, DONORS)."""

    def apply(self, values: FloatArray) -> FloatArray:
        """Return values (n_old, m) at the new points (n_new, m); counted from the nearest, so that a constant stays."""
        result = np.empty((len(self.donor), values.shape[1]))
        for first in range(0, len(self.donor), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            donor = self.donor[part]
            given = values[donor] - values[donor[:, :1]]
            linear = np.einsum("nd,ndm->nm", self.linear_weight[part], given)
            low, high = np.minimum(linear, given.min(axis=1)), np.maximum(linear, given.max(axis=1))
            found = np.clip(np.einsum("nd,ndm->nm", self.weight[part], given), low, high)
            result[part] = values[donor[:, 0]] + found
        return result


@dataclass(frozen=True)
class PointsInSpace:
    """Points of an old mesh of tetrahedra, from which values at new ones are found."""

    position: FloatArray
    """(n_old, 3) [mm]."""
    cell_of: IndexArray
    """The old cell of each (n_old,)."""
    cells: IndexArray
    """Corners of the old cells (n_cells, 4)."""

    @cached_property
    def _tree(self) -> scipy.spatial.cKDTree:
        return scipy.spatial.cKDTree(self.position)

    def _are_near(self, home: IndexArray, cells: IndexArray) -> BoolArray:
        """Return which cells (n, k) share a node with home (n,), or with a cell that does."""
        return np.asarray(_core.find_near_cells(*(own.astype(np.int32) for own in (self.cells, home, cells))))

    def find_transfer(self, new: FloatArray, home: IndexArray) -> FitInSpace:
        """Return how values at these points are found at new ones (n_new, 3) [mm].

        home: the old cell in or beside which each new point lies (n_new,).
        """
        return self._fit(new, *self._find_donors(new, home))

    def refit(self, new: FloatArray, like: FitInSpace) -> FitInSpace:
        """Return the fit at new points (n_new, 3) [mm] from the donors of another one, which lies beside it."""
        donor = like.donor.astype(np.intp)
        is_donor = donor != donor[:, :1]
        is_donor[:, 0] = True  # the first one stands again where there are fewer
        distance = np.linalg.norm(self.position[donor] - new[:, None], axis=2)
        return self._fit(new, donor, distance, is_donor)

    def _find_donors(self, new: FloatArray, home: IndexArray) -> tuple[IndexArray, FloatArray, BoolArray]:
        """Return the donors of new points, how far they are [mm], and which of them count, each (n_new, n_donors)."""
        n_donors = min(DONORS, len(self.position))
        distance, donor = self._tree.query(new, k=n_donors)
        distance, donor = distance.reshape(len(new), -1), donor.reshape(len(new), -1)
        is_donor = self._are_near(home, self.cell_of[donor])
        lacking = np.flatnonzero(~is_donor.all(axis=1))
        if len(lacking):
            farther, more = self._tree.query(new[lacking], k=min(_FARTHER * n_donors, len(self.position)))
            good = self._are_near(home[lacking], self.cell_of[more])
            first = np.argsort(~good, axis=1, kind="stable")[:, :n_donors]
            row = np.arange(len(lacking))[:, None]
            donor[lacking], distance[lacking] = more[row, first], farther[row, first]
            is_donor[lacking] = good[row, first]
            is_donor[lacking, 0] = True
            donor[lacking] = np.where(is_donor[lacking], donor[lacking], donor[lacking, :1])
        return donor, distance, is_donor

    def _fit(self, new: FloatArray, donor: IndexArray, distance: FloatArray, is_donor: BoolArray) -> FitInSpace:
        """Return the fit over donors."""
        parts = [slice(i, i + _AT_ONCE) for i in range(0, len(new), _AT_ONCE)]
        weights = [_fit(self.position, new[part], donor[part], distance[part], is_donor[part]) for part in parts]
        quadratic, linear = (np.concatenate(w) for w in zip(*weights, strict=True))
        return FitInSpace(donor.astype(np.int32), quadratic, linear)

    def find_peaks(self, given: FloatArray) -> IndexArray:
        """Return the points whose value (n_old,) is above those of all their donors, and which the fit misses."""
        candidates: IndexArray = np.flatnonzero(given > 0.0)
        if not len(candidates):
            return candidates
        # the nearest of the donors alone leave few candidates
        _, nearest = self._tree.query(self.position[candidates], k=min(_FIRST, len(self.position)))
        nearest = nearest.reshape(len(candidates), -1)
        counts = self._are_near(self.cell_of[candidates], self.cell_of[nearest]) & (nearest != candidates[:, None])
        highest = np.where(counts, given[nearest], -np.inf).max(axis=1)
        candidates = candidates[given[candidates] > highest]
        if not len(candidates):
            return candidates
        donors = self._find_donors(self.position[candidates], self.cell_of[candidates])
        others = np.where(donors[0] != candidates[:, None], given[donors[0]], -np.inf)
        above = given[candidates] > others.max(axis=1, initial=-np.inf)
        top = np.asarray(candidates[above])
        if not len(top):
            return top
        fit = self._fit(self.position[top], *(of[above] for of in donors))
        missed = given[top] - fit.apply(given[:, None])[:, 0] > _MISSED * given[top]
        return np.asarray(top[missed])


def _fit(
    old: FloatArray, new: FloatArray, donor: IndexArray, distance: FloatArray, is_donor: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return the donors' weights in the value of the quadratic and of the linear fit, each (n_new, n_donors)."""
    reach = np.where(is_donor, distance, 0.0).max(axis=1)
    reach = np.where(reach > 0.0, reach, 1.0)
    weight = np.maximum(1.0 - (distance / (_REACH * reach[:, None])) ** 2, _LEAST_WEIGHT) ** 2 * is_donor
    x, y, z = np.moveaxis((old[donor] - new[:, None]) / reach[:, None, None], 2, 0)
    basis = np.stack([np.ones_like(x), x, y, z, x * x, x * y, x * z, y * y, y * z, z * z], axis=-1)
    weighted = basis * weight[..., None]
    moment = weighted.transpose(0, 2, 1) @ basis
    count = is_donor.sum(axis=1)
    linear = _solve(weighted[..., :4], moment[:, :4, :4])
    quadratic = _solve(weighted, moment)
    nearest = np.zeros_like(linear)
    nearest[:, 0] = 1.0
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


def locate_in_tetrahedra(points: FloatArray, cells: IndexArray, wanted: FloatArray) -> Places:
    """Find the tetrahedron (n_cells, 4) in which, or nearest to which, each wanted point (n, 3) lies."""
    tree = scipy.spatial.cKDTree(points[cells].mean(axis=1))
    best = np.full(len(wanted), -np.inf)
    cell, share = np.zeros(len(wanted), dtype=np.intp), np.zeros((len(wanted), 4))
    for count in _CANDIDATES:
        left = np.flatnonzero(best < 0.0)  # those that no cell looked at so far contains
        n_near = min(count, len(cells))
        _, near = tree.query(wanted[left], k=n_near)
        for candidate in near.reshape(len(left), n_near).T:
            open_ = best[left] < 0.0
            asked, own = left[open_], candidate[open_]
            found, rank = _measure_inside(points[cells[own]], wanted[asked])
            better = rank > best[asked]
            chosen = asked[better]
            best[chosen], cell[chosen], share[chosen] = rank[better], own[better], found[better]
    return Places(cell, cells[cell], share)


def _measure_inside(corners: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return barycentric coordinates (n, 4) of points in tetrahedra (n, 4, 3), and how far outside they lie [-mm].

    1: inside. A distance and no coordinate, so that flat tetrahedra do not win from afar.
    """
    u, v, w = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    away, across = wanted - corners[:, 0], np.cross(v, w)
    six = np.einsum("ni,ni->n", u, across)
    safe = np.where(np.abs(six) > 1e-300, six, 1e-300)
    r = np.einsum("ni,ni->n", away, across) / safe
    s = np.einsum("ni,ni->n", u, np.cross(away, w)) / safe
    t = np.einsum("ni,ni->n", u, np.cross(v, away)) / safe
    found = np.stack([1.0 - r - s - t, r, s, t], axis=1)
    inside = found.min(axis=1)
    rank = np.where(inside >= -1e-12, 1.0, inside * np.cbrt(np.abs(six)))
    return found, np.where(six > 0.0, rank, -np.inf)
