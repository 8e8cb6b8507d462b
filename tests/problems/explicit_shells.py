# SPDX-License-Identifier: Apache-2.0
"""Meshes, materials and static tools for the verification of explicit shells."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.shells import ExplicitShells, ShellOptions

Array = npt.NDArray[np.float64]
YOUNG, POISSON, DENSITY = 207e3, 0.3, 7.85e-9


def mises(hardening: str = "linear", parameters: tuple[float, ...] = (1e9, 0.0), **other: float) -> _core.SheetLaw:
    """Von Mises with a hardening law; without arguments elastic."""
    young, poisson = other.get("young", YOUNG), other.get("poisson", POISSON)
    function = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
    return _core.SheetLaw(young, poisson, function, _core.HardeningLaw[hardening], list(parameters))


def grid(nx: int, ny: int, length: float, width: float, *, distort: float = 0.0) -> tuple[Array, npt.NDArray[np.int32]]:
    """Rectangle in the x-y plane; inner nodes moved at random by at most `distort` of a side."""
    x, y = np.meshgrid(np.linspace(0, length, nx + 1), np.linspace(0, width, ny + 1))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    inner = (points[:, 0] > 0) & (points[:, 0] < length) & (points[:, 1] > 0) & (points[:, 1] < width)
    move = np.random.default_rng(4).uniform(-distort, distort, (inner.sum(), 2))
    points[inner, :2] += move * [length / nx, width / ny]
    first = (np.arange(nx)[None, :] + (nx + 1) * np.arange(ny)[:, None]).ravel()
    return points, np.stack([first, first + 1, first + nx + 2, first + nx + 1], axis=1).astype(np.int32)


def triangles(cells: npt.NDArray[np.int32], part: npt.NDArray[np.bool_] | None = None) -> npt.NDArray[np.int32]:
    """Quadrilaterals (n, 4), those of `part` (default: all) halved: triangles have their last node twice."""
    cut = np.ones(len(cells), dtype=bool) if part is None else part
    halves = [cells[~cut], cells[cut][:, [0, 1, 2, 2]], cells[cut][:, [0, 2, 3, 3]]]
    return np.concatenate(halves)


def stiffness(shells: ExplicitShells, size: float = 1e-7) -> Array:
    """Tangent (6 n, 6 n) of the internal force, column by column by differences; for small meshes."""
    n = len(shells.position)
    columns = []
    for column in range(6 * n):
        increment = np.zeros(6 * n)
        increment[column] = size
        ahead, behind = shells.trial_force(increment.reshape(n, 6)), shells.trial_force(-increment.reshape(n, 6))
        columns.append((ahead - behind).ravel() / (2 * size))
    return np.stack(columns, axis=1)


def solve_static(matrix: Array, free: npt.NDArray[np.bool_], load: Array) -> Array:
    """Displacements (n, 6) of the freedoms marked free (n, 6); freedoms without stiffness stay where they are."""
    inside = np.flatnonzero(free.ravel())
    solution = np.zeros(matrix.shape[0])
    solution[inside] = np.linalg.lstsq(matrix[np.ix_(inside, inside)], load.ravel()[inside], rcond=1e-13)[0]
    return solution.reshape(free.shape)


def elastic_options(**changes: object) -> ShellOptions:
    """Two points through the thickness are exact for an elastic shell; without warping terms stiffness control."""
    control = {"hourglass": "stiffness"} if changes.get("warping") is False or "coefficients" in changes else {}
    return ShellOptions(**({"n_points": 2} | control | changes))  # type: ignore[arg-type]
