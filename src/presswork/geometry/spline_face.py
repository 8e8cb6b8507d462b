# SPDX-License-Identifier: Apache-2.0
"""A cubic B-spline face fitted to scattered points whose two parameters are known.

Least squares over clamped knots at equal distances, with a small penalty on second differences of the control points,
which continues the face smoothly where there are no points. Each point's parameters are then those of its foot on the
face (Hoschek 1988, Intrinsic parametrization for approximation, CAGD 5, 27). The spacing of the knots is halved until
the face is within a tolerance (Piegl and Tiller 1997, The NURBS Book, 9.4).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import splu

from presswork.model import FloatArray

DEGREE = 3
_PENALTY = 1e-5
"""Weight of second differences over that of a point."""
_MOST_CONTROLS = 40_000
"""Control points of a face at most."""
_CORRECTIONS = 2
"""Corrections of the parameters for each set of knots."""


@dataclass(frozen=True)
class SplineFace:
    """A tensor product of cubic B-splines."""

    controls: FloatArray
    """Control points (n_u, n_v, 3) [mm]."""
    knots: tuple[FloatArray, FloatArray]
    """Clamped knots along u and v, each inner one once."""
    off: float
    """Largest distance of the points from the face [mm]."""

    def evaluate(self, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return places at parameters (n,) each (n, 3) [mm]."""
        return np.asarray(_design(u, v, self.knots) @ self.controls.reshape(-1, 3))


def fit_face(points: FloatArray, parameters: FloatArray, spacing: float, within: float) -> SplineFace:
    """Return the face over the rectangle of the parameters.

    points: (n, 3) [mm]; parameters: of each, about (n, 2) [mm]; spacing: of the first knots [mm]; within: the largest
    distance from the points that is sought [mm]. The best face is returned where none is so near.
    """
    low, high = parameters.min(axis=0), parameters.max(axis=0)
    best: SplineFace | None = None
    while True:
        counts = [max(1, int(np.ceil(size / spacing))) for size in high - low]
        if best is not None and (counts[0] + DEGREE) * (counts[1] + DEGREE) > _MOST_CONTROLS:
            return best
        knots = [_make_knots(low[k], high[k], counts[k]) for k in (0, 1)]
        for _ in range(_CORRECTIONS):
            face = _fit(points, parameters, (knots[0], knots[1]))
            parameters, off = _find_feet(face, points, parameters)
            if best is None or off < best.off:
                best = replace(face, off=off)
            if off <= within:
                return best
        spacing *= 0.5


def _make_knots(low: float, high: float, count: int) -> FloatArray:
    return np.concatenate([np.full(DEGREE, low), np.linspace(low, high, count + 1), np.full(DEGREE, high)])


def _fit(points: FloatArray, parameters: FloatArray, knots: tuple[FloatArray, FloatArray]) -> SplineFace:
    n_u, n_v = (len(each) - DEGREE - 1 for each in knots)
    design = _design(parameters[:, 0], parameters[:, 1], knots)
    bend_u, bend_v = (_second_differences(n) for n in (n_u, n_v))
    smooth = sparse.kron(bend_u, sparse.identity(n_v)) + sparse.kron(sparse.identity(n_u), bend_v)
    rhs = design.T @ points
    found = splu((design.T @ design + _PENALTY * smooth).tocsc()).solve(np.ascontiguousarray(rhs))
    return SplineFace(np.asarray(found).reshape(n_u, n_v, 3), knots, np.inf)


def _find_feet(face: SplineFace, points: FloatArray, parameters: FloatArray) -> tuple[FloatArray, float]:
    """Return the parameters of the feet of points on a face (n, 2), and their largest distance from it [mm]."""
    low, high = (np.array([knots[k] for knots in face.knots]) for k in (0, -1))
    step = 1e-4 * (high - low)
    for _ in range(2):
        place = face.evaluate(*parameters.T)
        along = [(face.evaluate(*(parameters + d).T) - face.evaluate(*(parameters - d).T)) for d in np.diag(step)]
        slope = np.stack(along, axis=2) / np.maximum(np.minimum(parameters + step, high) - np.maximum(
            parameters - step, low), 1e-300)[:, None]  # fmt: skip
        square = np.einsum("nia,nib->nab", slope, slope) + 1e-9 * np.identity(2)
        move = np.linalg.solve(square, np.einsum("nia,ni->na", slope, points - place)[..., None])[..., 0]
        parameters = np.clip(parameters + move, low, high)
    return parameters, float(np.linalg.norm(face.evaluate(*parameters.T) - points, axis=1).max())


def _design(u: FloatArray, v: FloatArray, knots: tuple[FloatArray, FloatArray]) -> sparse.csr_array:
    """Return the values of all products of splines at parameters (n, n_u n_v)."""
    one, other = (
        BSpline.design_matrix(np.clip(x, each[0], each[-1]), each, DEGREE)
        for x, each in zip((u, v), knots, strict=True)
    )
    width, n_v = DEGREE + 1, other.shape[1]
    rows = np.repeat(np.arange(len(u)), width**2)
    columns = one.indices.reshape(-1, width, 1) * n_v + other.indices.reshape(-1, 1, width)
    values = one.data.reshape(-1, width, 1) * other.data.reshape(-1, 1, width)
    return sparse.csr_array((values.ravel(), (rows, columns.ravel())), shape=(len(u), one.shape[1] * n_v))


def _second_differences(n: int) -> sparse.csr_array:
    """Return D'D of second differences of n values."""
    d = sparse.diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(max(n - 2, 0), n))
    return sparse.csr_array(d.T @ d)
