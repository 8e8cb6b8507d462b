# SPDX-License-Identifier: Apache-2.0
"""Values at points of an old mesh, found at points of a new one.

Integration points: quadratic moving least squares over the nearest points, from point to point without a detour over
the nodes, clipped to the range of the donors and of the linear fit (cpp/remesh/donors.hpp). Donors are looked for
along the mesh: what lies beyond a fold does not count.

Nodes: the shape functions of the old cell they lie in, its plane continued where they lie outside by a little.

Boundary: cubic Hermite polynomials along its arc, with slopes that keep monotone values monotone (Fritsch & Carlson
1980, with the means of Fritsch & Butland 1984) but for kinks, such as corners: linear values along a side stay so, and
those that are the same all along it to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from presswork import _core
from presswork.model import FloatArray, IndexArray, IntArray

KINK = 0.25
"""Slope on one side of a node of a line over that on the other, below which the line of values has a kink there."""
_MISSED = 1e-6
"""Part of a value that a fit may miss without a peak being lost."""


@dataclass(frozen=True)
class PointTransfer:
    """What every new point takes from which old points."""

    donor: IntArray
    """(n_new, n_donors), the nearest first, and again where there are fewer."""
    weight: FloatArray
    """Weight of the quadratic fit's value (n_new, n_donors)."""
    linear_weight: FloatArray
    """Weight of the linear fit's value (n_new, n_donors)."""

    def apply(self, values: FloatArray) -> FloatArray:
        """Return values (n_old, m) at the new points (n_new, m)."""
        return _core.apply_fit(self.donor, self.weight, self.linear_weight, np.ascontiguousarray(values))


@dataclass(frozen=True)
class OldPoints:
    """Points of an old mesh, from which values at new ones are found."""

    position: FloatArray
    """(n_old, 2) [mm]."""
    cell_of: IndexArray
    """The old cell of each (n_old,)."""
    cells: IndexArray
    """Nodes of the old cells (n_cells, 3 | 4)."""

    @cached_property
    def _donors(self) -> _core.Donors:
        return _core.Donors(np.ascontiguousarray(self.position), _to_int(self.cell_of), _to_int(self.cells))

    def find_transfer(self, new: FloatArray, home: IndexArray) -> PointTransfer:
        """Return how values at these points are found at new ones (n_new, 2) [mm].

        home: the old cell in or beside which each new point lies (n_new,).
        """
        return PointTransfer(*self._donors.fit(np.ascontiguousarray(new), _to_int(home)))

    def refit(self, new: FloatArray, like: PointTransfer) -> PointTransfer:
        """Return the transfer to new points (n_new, 2) [mm] from the donors of another one, which lies beside it."""
        position, places = np.ascontiguousarray(self.position), np.ascontiguousarray(new)
        return PointTransfer(like.donor, *_core.refit_donors(position, places, like.donor))

    def find_peaks(self, given: FloatArray) -> IndexArray:
        """Return the points whose value (n_old,) is above those of all their donors, and which the fit misses."""
        highest, own = np.full(len(self.cells), -np.inf), np.zeros(len(self.cells), dtype=np.intp)
        np.maximum.at(highest, self.cell_of, given)
        at_top = given == highest[self.cell_of]
        np.add.at(own, self.cell_of[at_top], 1)
        peaks = np.flatnonzero(at_top & (own[self.cell_of] == 1) & (given != 0.0))
        position, home = np.ascontiguousarray(self.position), _to_int(self.cell_of)
        peaks = peaks[self._donors.find_peaks(position, home, np.ascontiguousarray(given), _to_int(peaks))]
        fit = self.find_transfer(self.position[peaks], self.cell_of[peaks])
        missed = np.abs(given[peaks] - (fit.weight * given[fit.donor]).sum(axis=1))
        return np.asarray(peaks[missed > _MISSED * np.abs(given[peaks])])


class DonorsOfPoints(Protocol):
    """Which old points new ones take their values from, in the plane or in space."""

    @property
    def donor(self) -> IntArray:
        """(n_new, n_donors)."""


class PeakSource(Protocol):
    """Old points whose peaks new ones take over, in the plane or in space."""

    @property
    def position(self) -> FloatArray:
        """(n_old, 2 | 3) [mm]."""

    def find_peaks(self, given: FloatArray) -> IndexArray:
        """Return the points whose value (n_old,) is above those of all their donors, and which the fit misses."""


@dataclass(frozen=True)
class PeakTakers:
    """Old points whose values are peaks that a fit flattens, and the new point that takes each over."""

    peak: IndexArray
    """(n,)."""
    taker: IndexArray
    """(n,)."""

    def keep(self, given: FloatArray, found: FloatArray, volume: FloatArray) -> FloatArray:
        """Return a field found at new points (n_new,) with the peaks that it has at old points, `given` (n_old,).

        All other points lose as much by volume (n_new,) [mm3], in proportion, so that the integral stays.
        """
        result, is_peak = found.copy(), np.zeros(len(found), dtype=bool)
        np.maximum.at(result, self.taker, given[self.peak])
        is_peak[self.taker] = True
        added = float(((result - found) * volume).sum())
        rest = float((result * volume)[~is_peak].sum())
        if 0.0 < added < rest:
            result[~is_peak] *= 1.0 - added / rest
        return result


def find_peak_takers(given: FloatArray, old: PeakSource, new: FloatArray, fit: DonorsOfPoints) -> PeakTakers:
    """Return who takes over the peaks of a field at old points, `given` (n_old,).

    A least-squares fit flattens a peak of a single point. So the value of an old point that is above all its donors,
    and that the fit misses, goes to the new point nearest to it. Fields that the fit follows, those of the second
    order, stay as they are. new: places of the new points (n_new, 2) [mm]; fit: from the old ones to them.
    """
    peaks = old.find_peaks(given)
    wanted = np.zeros(len(given), dtype=bool)
    wanted[peaks] = True
    taker, which = np.nonzero(wanted[fit.donor])
    peak = fit.donor[taker, which].astype(np.intp)
    distance = np.linalg.norm(new[taker] - old.position[peak], axis=1)
    order = np.lexsort((taker, distance, peak))
    _, first = np.unique(peak[order], return_index=True)
    nearest = order[first]
    return PeakTakers(peak[nearest], taker[nearest])


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
    return Places(*_core.locate_in_cells(np.ascontiguousarray(points), _to_int(cells), np.ascontiguousarray(wanted)))


def _to_int(values: IndexArray) -> IntArray:
    return np.ascontiguousarray(values, dtype=np.int32)


def interpolate_along(points: FloatArray, values: FloatArray, part: FloatArray) -> FloatArray:
    """Return values (n, m) on a line, each at a fraction (n,) of the distance between the inner two of four points.

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
