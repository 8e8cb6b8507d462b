# SPDX-License-Identifier: Apache-2.0
"""Lines and arcs where a plane through the origin cuts a CAD model in STEP, or that are drawn in the plane."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from presswork.case.tools.profile import RELATIVE_TOLERANCE
from presswork.case.units import LENGTH
from presswork.geometry.biarc import Curve, CurveError, fit_biarcs
from presswork.geometry.chain import Piece, ProfileFileError
from presswork.mesh.checks import MeshError
from presswork.mesh.files.cad import call_cad, open_cad
from presswork.model import FloatArray

Plane = Literal["xy", "xz", "yz"]

_SAMPLES = 9
"""Number of points on an edge that show whether it is straight."""
_STRAIGHT = 1e-7
"""Distance of these from the chord, as a part of its length."""
_AXES: Mapping[str, tuple[int, int]] = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
"""Numbers of the axes that span each plane."""


def read_section(path: Path, plane: Plane, tolerance: float | None, *, is_half: bool) -> tuple[list[Piece], float]:
    """Return the pieces of a section in mm, its axes those that the plane names, and the tolerance [mm].

    tolerance: of arcs that follow other curves, by default RELATIVE_TOLERANCE of the section's extent. is_half: leave
    out what lies at negative values of the first axis. Raises ProfileFileError.
    """
    try:
        found: tuple[list[Piece], float] = call_cad(f"{__name__}:cut_section", path, plane, tolerance, is_half)
    except MeshError as error:
        raise ProfileFileError(error.fault, error.remedy) from None
    return found


def cut_section(path: Path, plane: Plane, tolerance: float | None, is_half: bool) -> tuple[list[Piece], float]:
    """Do what `read_section` does, in this process. Raises MeshError, too."""
    order = _AXES[plane]
    edges = _cut(open_cad(path).shape, order, is_half)
    if not edges:
        remedy = "take another plane, and see that the model is a solid"
        raise ProfileFileError(f"the plane {plane} through the origin cuts nothing of the model", remedy)
    samples = [_sample(edge, order) for edge in edges]
    extent = float(np.linalg.norm(np.ptp(np.concatenate(samples), axis=0)))
    if not extent <= LENGTH.largest:
        raise ProfileFileError(f"coordinates up to {extent:.4g} mm", "check the model and its unit")
    within = RELATIVE_TOLERANCE * extent if tolerance is None else tolerance
    drawn = [pair for pair in zip(edges, samples, strict=True) if np.ptp(pair[1], axis=0).max() > _STRAIGHT * extent]
    return [_make_piece(edge, points, order, within) for edge, points in drawn], within


def _cut(shape: Any, order: tuple[int, int], is_half: bool) -> list[Any]:
    """Return the edges of the section in the plane of two axes, of its half where the first is positive; in space."""
    from netgen import occ

    if not len(shape.faces):
        return list(shape.edges)
    size = 4.0 * max(abs(value) for corner in shape.bounding_box for value in corner)
    first, second = np.eye(3)[list(order)]
    corner = -0.5 * size * (second if is_half else first + second)
    axes = occ.Axes(tuple(corner), n=occ.Dir(*np.cross(first, second)), h=occ.Dir(*first))
    return list((shape * occ.WorkPlane(axes).Rectangle(size, size).Face()).edges)


def _sample(edge: Any, order: tuple[int, int]) -> FloatArray:
    start, end = edge.parameter_interval
    return _point(edge, np.linspace(start, end, _SAMPLES), order)


def _point(edge: Any, parameters: FloatArray, order: tuple[int, int]) -> FloatArray:
    found = np.array([[*edge.Value(float(parameter))] for parameter in parameters], dtype=np.float64)
    return found[:, order]


def _make_piece(edge: Any, points: FloatArray, order: tuple[int, int], tolerance: float) -> Piece:
    chord = points[-1] - points[0]
    length = float(np.linalg.norm(chord))
    away = (points - points[0]) @ np.array([-chord[1], chord[0]]) / max(length, 1e-300)
    if length > 0.0 and np.abs(away).max() <= _STRAIGHT * length:
        return Piece("line", (np.array([*points[0], *points[-1], 0.0, 0.0, 0.0]),))
    start, end = edge.parameter_interval

    def tangent(at: float, _: float) -> FloatArray:
        slope = edge.Tangent(at)
        found = np.array([slope.x, slope.y, slope.z], dtype=np.float64)[list(order)]
        return np.asarray(found / np.linalg.norm(found))

    try:
        segments = fit_biarcs(Curve(lambda at: _point(edge, at, order), tangent), start, end, tolerance)
    except CurveError as error:
        raise ProfileFileError(str(error), "draw it smoother") from error
    return Piece("curve", tuple(segments))
