# SPDX-License-Identifier: Apache-2.0
"""Surfaces laid flat with little distortion: the one-step solver's first guess.

Least-squares conformal map, then minimisation of the symmetric Dirichlet energy, which grows without bound as a
triangle collapses, so that none turns over. Levy et al. 2002; Rabinovich, Poranne, Panozzo & Sorkine-Hornung 2017.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.checks import MeshError
from presswork.mesh.triangles import double_areas
from presswork.model import FloatArray, IntArray

_ROUNDS = 6
"""Of minimisation: the distortion then falls by less than a hundredth each."""


def flatten(points: FloatArray, triangles: IntArray, outline: IntArray) -> FloatArray:
    """Lay a sheet flat; return its places (n_points, 2) [mm], the triangles counter-clockwise, in no chosen position.

    points (n_points, 3), triangles (n, 3); outline: the points along the outer rim in order. Raises MeshError.
    """
    try:
        import igl  # type: ignore[import-untyped]
    except ImportError as error:
        raise MeshError("laying a part flat needs the package libigl", "install it: pip install libigl") from error
    cells = np.ascontiguousarray(triangles, dtype=np.int64)
    far = len(outline) // 2
    span = float(np.linalg.norm(points[outline[0]] - points[outline[far]]))
    pins = np.array([outline[0], outline[far]], dtype=np.int64)
    conformal = igl.lscm(points, cells, pins, np.array([[0.0, 0.0], [span, 0.0]]))
    flat: FloatArray = np.asarray(conformal[0] if isinstance(conformal, tuple) else conformal)
    if _areas(flat, triangles).sum() < 0.0:
        flat = flat * np.array([1.0, -1.0])
    area = 0.5 * float(np.linalg.norm(double_areas(points, triangles), axis=1).sum())
    flat = flat * np.sqrt(area / _areas(flat, triangles).sum())
    turned = int((_areas(flat, triangles) <= 0.0).sum())
    if turned or not np.isfinite(flat).all():
        flat = _map_to_circle(igl, points, cells, outline, area)
    none = np.zeros(0, dtype=np.int32)
    energy = igl.MappingEnergyType.SYMMETRIC_DIRICHLET
    data = igl.slim_precompute(points, cells.astype(np.int32), flat, energy, none, np.zeros((0, 2)), 0.0)
    flat = np.asarray(igl.slim_solve(data, _ROUNDS))[:, :2]
    if not np.isfinite(flat).all() or (_areas(flat, triangles) <= 0.0).any():
        raise MeshError("the part cannot be laid flat without folding", "is it one sheet, without tunnels?")
    return np.ascontiguousarray(flat)


def _areas(flat: FloatArray, triangles: NDArray[np.integer[Any]]) -> FloatArray:
    a, b = (flat[triangles[:, k]] - flat[triangles[:, 0]] for k in (1, 2))
    return np.asarray(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))


def _map_to_circle(
    igl: Any, points: FloatArray, cells: NDArray[np.int64], outline: IntArray, area: float
) -> FloatArray:
    """Map onto a disc by Tutte's theorem, which no sheet without holes can fold."""
    order = outline.astype(np.int64)
    circle = igl.map_vertices_to_circle(points, order)
    flat = np.asarray(igl.harmonic(points, cells, order, circle, 1))
    if _areas(flat, cells).sum() < 0.0:
        flat = flat * np.array([1.0, -1.0])
    if (_areas(flat, cells) <= 0.0).any():
        raise MeshError("the part cannot be laid flat without folding", "mesh it with better shaped triangles")
    return np.asarray(flat * np.sqrt(area / np.pi))
