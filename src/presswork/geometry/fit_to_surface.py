# SPDX-License-Identifier: Apache-2.0
"""A formed sheet laid against the surface that it should become."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.geometry.best_fit import fit_rigidly
from presswork.geometry.foot_on_triangles import find_feet
from presswork.model import BoolArray, FloatArray, IntArray

_MOST = 100
_STILL = 1e-5
"""Movement [mm] below which the fit has come to rest."""


@dataclass(frozen=True)
class SurfaceFit:
    """Where nodes of a sheet's middle should be by a surface that was laid to it."""

    wanted: FloatArray
    """Places of the nodes (n, 3) [mm]."""
    is_over: BoolArray
    """Whether a node lies over the surface, not beyond its edge (n,)."""
    surface: FloatArray
    """Points of the surface where it was laid (m, 3) [mm]."""
    off: float
    """Root mean square distance of the nodes over it [mm]."""


def fit_to_surface(
    nodes: FloatArray,
    weight: FloatArray,
    points: FloatArray,
    triangles: IntArray,
    thickness: float,
    planes: tuple[bool, bool],
    beyond: float,
) -> SurfaceFit:
    """Lay a surface of triangles (k, 3) over points (m, 3) to the nodes (n, 3) of a sheet's middle as a rigid body.

    The surface is the middle of the wanted sheet or one of its faces, whichever fits best. weight: of each node (n,).
    planes: symmetry planes, which are kept. beyond: tangential distance from the surface's edge at which a node still
    lies over it [mm]. Nearest points in turn: Besl and McKay (1992), A method for registration of 3-D shapes.
    """
    fits = [_fit(nodes, weight, points, triangles, s * thickness, planes, beyond) for s in (0.0, 0.5, -0.5)]
    return min(fits, key=lambda fit: fit.off)


def _fit(
    nodes: FloatArray,
    weight: FloatArray,
    points: FloatArray,
    triangles: IntArray,
    offset: float,
    planes: tuple[bool, bool],
    beyond: float,
) -> SurfaceFit:
    """Lay a surface at a distance from the middle; the nodes go to it, and all goes back with them."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    laid = nodes
    for _ in range(_MOST):
        wanted, aside = _project(laid, points, triangles, normals, offset)
        over = aside <= beyond
        if not over.any():
            over[:] = True
        before, laid = laid, fit_rigidly(laid, wanted, np.where(over, weight, 0.0), planes)
        if np.abs(laid - before).max() < _STILL:
            break
    wanted, aside = _project(laid, points, triangles, normals, offset)
    over = aside <= beyond
    share = np.where(over, weight, 0.0) if over.any() else weight
    off = float(np.sqrt(((wanted - laid) ** 2).sum(axis=1) @ share / share.sum()))
    back = fit_rigidly(
        np.concatenate([laid, wanted, points]),
        np.concatenate([nodes, np.zeros_like(wanted), np.zeros_like(points)]),
        np.concatenate([weight, np.zeros(len(wanted) + len(points))]),
        planes,
    )
    n = len(nodes)
    return SurfaceFit(back[n : 2 * n], over, back[2 * n :], off)


def _project(
    x: FloatArray, points: FloatArray, triangles: IntArray, normals: FloatArray, offset: float
) -> tuple[FloatArray, FloatArray]:
    """Return places straight under or over x (n, 3) at the offset from the surface, and how far x lies beside it."""
    feet = find_feet(x, points, triangles)
    normal = normals[feet.triangle]
    away = x - feet.interpolate(points, triangles)
    height = (away * normal).sum(axis=1, keepdims=True)
    return x + (offset - height) * normal, np.linalg.norm(away - height * normal, axis=1)
