# SPDX-License-Identifier: Apache-2.0
"""Tools whose edges and corners are rounded to a radius that cells can follow.

The signed distance is sampled on a lattice and read as the coefficients of cubic B-splines (de Boor 1978, A Practical
Guide to Splines). That field is twice continuously differentiable, exact where the tool is flat, and lies off the tool
by no more than a part of the lattice's spacing where it has an edge: edges that point into the metal lose their tip,
and edges that metal flows into get a fillet. The lattice is sampled where it is asked for, and no sample depends on the
order of the questions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork import _core
from presswork.model import BoolArray, FloatArray, IndexArray

BAND = 4.0
"""Distance from the tool over the spacing beyond which a point gets the distance of the tool as it is drawn. So does a
point beside the open rim of a tool, where samples find no tool."""
LEAST_STEEP = 0.1
"""Slope of the field along its own gradient below which the tool as it is drawn is used: halfway between the two walls
of a ridge the field does not show where the tool is."""
_BITS = 21
_OFFSETS = np.stack(np.meshgrid(*3 * [np.arange(4)], indexing="ij"), axis=-1).reshape(-1, 3)


class RoundedSurface:
    """A tool's surface with rounded edges, in the tool's own frame; answers as _core.ToolSurface does."""

    def __init__(
        self, surface: _core.ToolSurface, spacing: float, fold: Callable[[FloatArray], FloatArray] | None = None
    ) -> None:
        """Round a surface; spacing: of the lattice [mm]; fold: takes places beyond symmetry planes to this side."""
        self._surface, self._spacing, self._fold = surface, spacing, fold
        self._keys: IndexArray = np.zeros(0, dtype=np.int64)
        self._values: FloatArray = np.zeros(0)
        self._cubes: IndexArray = np.zeros(0, dtype=np.int64)
        """Numbers of the lattice's cubes whose samples have been gathered, in order."""
        self._gathered: FloatArray = np.zeros((0, len(_OFFSETS)))

    def nearest(self, points: FloatArray, reach: float = np.inf) -> tuple[FloatArray, FloatArray, None, None]:
        """Return the gap of points (n, 3) closer than reach [mm], infinite of others, and the normal there (n, 3)."""
        gap, normal, _, _ = self._surface.nearest(points, reach + self._spacing)
        near, samples = self._sample_near(points, gap)
        if len(near):
            value, slope = self._evaluate(points[near], samples, False)
            steepness = np.linalg.norm(slope, axis=1)
            is_steep = steepness > LEAST_STEEP
            near, value, slope, steepness = near[is_steep], value[is_steep], slope[is_steep], steepness[is_steep]
            gap[near], normal[near] = value / steepness, slope / steepness[:, None]
        gap[gap > reach] = np.inf
        return gap, normal, None, None

    def slopes(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the derivatives of gap (n, 3) and normal (n, 3, 3) [1/mm] to points (n, 3)."""
        rise, bend = self._surface.slopes(points)
        gap, *_ = self._surface.nearest(points, (BAND + 1.0) * self._spacing)
        near, samples = self._sample_near(points, gap)
        if len(near):
            value, slope, curve = self._evaluate(points[near], samples, True)
            steepness = np.linalg.norm(slope, axis=1)
            is_steep = steepness > LEAST_STEEP
            near, value, slope, curve = near[is_steep], value[is_steep], slope[is_steep], curve[is_steep]
            steepness = steepness[is_steep]
            normal = slope / steepness[:, None]
            along = np.eye(3) - normal[:, :, None] * normal[:, None, :]
            bend[near] = along @ curve / steepness[:, None, None]
            turning = np.einsum("ni,nij->nj", normal, curve)
            rise[near] = normal - (value / steepness**2)[:, None] * turning
        return rise, bend

    def _sample_near(self, points: FloatArray, gap: FloatArray) -> tuple[IndexArray, FloatArray]:
        """Return which points (n, 3) of a gap (n,) are near the tool, and the samples round them (m, 4, 4, 4)."""
        near = np.flatnonzero(np.abs(gap) < BAND * self._spacing)
        first = np.floor(points[near] / self._spacing).astype(np.int64)
        samples = self._gather(first)
        known = np.isfinite(samples).all(axis=1)
        return near[known], samples[known].reshape(-1, 4, 4, 4)

    def _evaluate(self, points: FloatArray, samples: FloatArray, curved: bool) -> tuple[FloatArray, ...]:
        """Return the field at points, its gradient and, where it is asked for as curved, its second derivatives."""
        within = points / self._spacing - np.floor(points / self._spacing)
        weights = [_weigh(within[:, axis]) for axis in range(3)]

        def contract(*orders: int) -> FloatArray:
            x, y, z = (weights[axis][order] for axis, order in enumerate(orders))
            total = np.einsum("nijk,ni,nj,nk->n", samples, x, y, z, optimize=["einsum_path", (0, 3), (0, 2), (0, 1)])
            return np.asarray(total / self._spacing ** sum(orders))

        value = contract(0, 0, 0)
        slope = np.stack([contract(*np.eye(3, dtype=int)[axis]) for axis in range(3)], axis=-1)
        if not curved:
            return value, slope
        curve = np.empty((len(points), 3, 3))
        for i in range(3):
            for j in range(i, 3):
                curve[:, i, j] = curve[:, j, i] = contract(*(np.eye(3, dtype=int)[i] + np.eye(3, dtype=int)[j]))
        return value, slope, curve

    def _gather(self, first: IndexArray) -> FloatArray:
        """Return the samples round cubes of the lattice (n, 64); first: numbers of their lowest corners (n, 3)."""
        keys = _number(first)
        wanted = np.unique(keys)
        missing = wanted[~_are_among(wanted, self._cubes)]
        if len(missing):
            found = self._sample(_find_places(missing)[:, None] + _OFFSETS - 1)
            cubes, gathered = np.concatenate([self._cubes, missing]), np.concatenate([self._gathered, found])
            order = np.argsort(cubes)
            self._cubes, self._gathered = cubes[order], gathered[order]
        return np.asarray(self._gathered[np.searchsorted(self._cubes, keys)])

    def _sample(self, numbers: IndexArray) -> FloatArray:
        """Return the signed distance at points of the lattice (n, 64, 3) (n, 64)."""
        wanted, place = np.unique(_number(numbers), return_inverse=True)
        missing = wanted[~_are_among(wanted, self._keys)]
        if len(missing):
            points: FloatArray = self._spacing * _find_places(missing).astype(float)
            found, *_ = self._surface.nearest(points if self._fold is None else self._fold(points))
            keys_now, values = np.concatenate([self._keys, missing]), np.concatenate([self._values, found])
            order = np.argsort(keys_now)
            self._keys, self._values = keys_now[order], values[order]
        return np.asarray(self._values[np.searchsorted(self._keys, wanted)][place].reshape(numbers.shape[:2]))


def _number(places: IndexArray) -> IndexArray:
    """Return one number for each point of the lattice (..., 3)."""
    shifted = places + (1 << (_BITS - 1))
    return np.asarray((shifted[..., 0] << 2 * _BITS) | (shifted[..., 1] << _BITS) | shifted[..., 2])


def _find_places(keys: IndexArray) -> IndexArray:
    """Return the points of the lattice (n, 3) that have numbers (n,)."""
    mask = (1 << _BITS) - 1
    return np.stack([keys >> 2 * _BITS, (keys >> _BITS) & mask, keys & mask], axis=-1) - (1 << (_BITS - 1))


def _are_among(wanted: IndexArray, keys: IndexArray) -> BoolArray:
    """Return which wanted numbers are among keys, both in order."""
    if not len(keys):
        return np.zeros(len(wanted), dtype=bool)
    return np.asarray(keys[np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)] == wanted)


def _weigh(t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the cubic B-splines of four neighbours at t (n,) from the second to the third, and their derivatives."""
    s = 1.0 - t
    value = np.stack([s**3, 3 * t**3 - 6 * t**2 + 4, 3 * s**3 - 6 * s**2 + 4, t**3], axis=-1) / 6.0
    slope = np.stack([-(s**2), 3 * t**2 - 4 * t, 4 * s - 3 * s**2, t**2], axis=-1) / 2.0
    curve = np.stack([s, 3 * t - 2, 3 * s - 2, t], axis=-1)
    return value, slope, curve
