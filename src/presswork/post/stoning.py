# SPDX-License-Identifier: Apache-2.0
"""Stoning: where a straight stone that is drawn over a panel would not touch it.

The panel is sampled on a grid of its plan. A stone of length L lies along x or y on any two points of a section at most
L apart; the gap of a place is the largest that any such chord leaves over it, normal to the chord. So a dent of depth A
shorter than the stone has the gap A, a hollow of radius R the gap L^2/(8 R), and a bulge none. The middle surface
stands for the outer one, and walls steeper than STEEPEST are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswork.model import FloatArray, IntArray
from presswork.post.springback import find_formed_step
from presswork.results import Result, ResultError, ResultMesh

STEEPEST = 1.0
"""Slope of a panel's wall beyond which no stone is drawn over it."""
MOST_POINTS = 200
"""Points of a stone, at most."""
MOST_PLACES = 4_000_000
"""Places of a grid, at most."""
ROUNDING = 1e-9
"""Part of the stone's length that rounding may take."""
INSIDE = -1e-9
"""Barycentric coordinate down to which a place belongs to a triangle."""


@dataclass(frozen=True)
class Stoning:
    """Gaps between a stone and a panel on a grid of its plan."""

    x: FloatArray
    """Coordinates along x (n,) [mm]."""
    y: FloatArray
    """Coordinates along y (m,) [mm]."""
    gap: FloatArray
    """Gap at each place (n, m) [mm]; nan where there is no panel, or a wall."""

    @property
    def worst(self) -> tuple[float, float, float]:
        """Largest gap, and its place x, y [mm]."""
        at = np.unravel_index(int(np.nanargmax(self.gap)), self.gap.shape)
        return float(self.gap[at]), float(self.x[at[0]]), float(self.y[at[1]])


def stone(
    result: Result,
    *,
    length: float = 100.0,
    direction: Literal["x", "y"] = "x",
    side: Literal["top", "bottom"] = "top",
    spacing: float = 2.0,
    step: int = -1,
    less_formed: bool = False,
    mirror: str = "",
) -> Stoning:
    """Draw a stone over a sheet at a saved step.

    length: of the stone [mm]; side: on which it is drawn, top is that of larger z; spacing: of the grid [mm];
    less_formed: take off the gaps of the part as it was formed, before springback. mirror: axes, "x", "y" or "xy",
    whose symmetry planes through the origin cut the part, beside those of a stamping, which are known. Raises
    ResultError for a part that is no sheet, for a stone or grid that does not fit it, and without a step before
    springback where one is asked for.
    """
    if not result.is_shell:
        raise ResultError(f"{result.folder} has no sheet: stoning is for panels")
    if not 0.0 < spacing <= 0.1 * length:
        raise ResultError(f"spacing = {spacing:g} mm: give at most a tenth of the stone's length, {0.1 * length:g} mm")
    if length > MOST_POINTS * spacing:
        most = f"{MOST_POINTS} times the spacing, {MOST_POINTS * spacing:g} mm"
        raise ResultError(f"length = {length:g} mm: give at most {most}")
    axes = sorted({*mirror, *str(result.info.get("symmetry", ""))})
    triangles = _triangulate(result.mesh_at(step))
    sign = 1.0 if side == "top" else -1.0
    points, triangles = _mirror(result.points(step), triangles, axes)
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    if (extent := float((high - low).max())) < length:
        raise ResultError(f"length = {length:g} mm: the part measures {extent:.4g} mm; take a shorter stone")
    x, y = (np.arange(a, b + 1e-9 * spacing, spacing) for a, b in zip(low, high, strict=True))
    if len(x) * len(y) > MOST_PLACES:
        raise ResultError(f"spacing = {spacing:g} mm: the grid would have {len(x) * len(y)} places; take a wider one")
    found = _find_gaps(points, triangles, (x, y), sign, length, spacing, direction)
    if less_formed:
        before = find_formed_step(result, step)
        formed, _ = _mirror(result.points(before), _triangulate(result.mesh_at(before)), axes)
        found = found - _find_gaps(formed, triangles, (x, y), sign, length, spacing, direction)
    return Stoning(x, y, found)


def _triangulate(mesh: ResultMesh) -> IntArray:
    """Return the shells of a mesh as triangles (n, 3)."""
    cells = [block.connectivity for block in mesh.blocks]
    corners = [(0, 1, 2), (0, 2, 3)]
    return np.concatenate([of[:, list(at)] for of in cells for at in corners if max(at) < of.shape[1]]).astype(np.int32)


def _mirror(points: FloatArray, triangles: IntArray, axes: Sequence[str]) -> tuple[FloatArray, IntArray]:
    """Return points and triangles with their images in planes normal to axes through the origin."""
    for axis in axes:
        image = points.copy()
        image[:, "xy".index(axis)] *= -1.0
        triangles = np.concatenate([triangles, triangles + np.int32(len(points))])
        points = np.concatenate([points, image])
    return points, triangles


def _find_gaps(
    points: FloatArray,
    triangles: IntArray,
    grid: tuple[FloatArray, FloatArray],
    sign: float,
    length: float,
    spacing: float,
    direction: str,
) -> FloatArray:
    """Return the gaps on a grid (n, m) [mm]."""
    heights = find_heights(points * [1.0, 1.0, sign], triangles, *grid)
    if direction == "x":
        return find_gaps(heights.T, length, spacing).T
    return find_gaps(heights, length, spacing)


def find_heights(points: FloatArray, triangles: IntArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the largest z of triangles (k, 3) of points (p, 3) over a grid (n, m) [mm]; nan beside them."""
    heights = np.full((len(x), len(y)), -np.inf)
    corners = points[triangles]
    first = np.searchsorted(x, corners[:, :, 0].min(axis=1)), np.searchsorted(y, corners[:, :, 1].min(axis=1))
    last = (
        np.searchsorted(x, corners[:, :, 0].max(axis=1), side="right"),
        np.searchsorted(y, corners[:, :, 1].max(axis=1), side="right"),
    )
    for (a, b, c), i, j, i_end, j_end in zip(corners, *first, *last, strict=True):
        across = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if across == 0.0 or i == i_end or j == j_end:
            continue
        u, v = x[i:i_end, None] - a[0], y[None, j:j_end] - a[1]
        of_b = (u * (c[1] - a[1]) - v * (c[0] - a[0])) / across
        of_c = (v * (b[0] - a[0]) - u * (b[1] - a[1])) / across
        inside = (of_b >= INSIDE) & (of_c >= INSIDE) & (of_b + of_c <= 1.0 - INSIDE)
        z = a[2] + of_b * (b[2] - a[2]) + of_c * (c[2] - a[2])
        part = heights[i:i_end, j:j_end]
        part[inside] = np.maximum(part[inside], z[inside])
    return np.where(np.isfinite(heights), heights, np.nan)


def find_gaps(heights: FloatArray, length: float, spacing: float) -> FloatArray:
    """Return the gap under a stone on sections (k, n), a row each, of heights at a spacing [mm]; nan stays nan.

    length: of the stone [mm], which lies on two places of the grid at most so far apart.

    >>> dent = np.where(np.arange(41) == 20, -0.1, 0.0)[None]
    >>> find_gaps(dent, 10.0, 1.0)[0, 18:23].round(6).tolist()
    [0.0, 0.0, 0.1, 0.0, 0.0]
    """
    n, most = heights.shape[1], int(length / spacing * (1.0 + ROUNDING))
    gap = np.zeros_like(heights)
    for before in range(1, most):
        for behind in range(1, min(most - before, n - before - 1) + 1):
            left, middle = heights[:, : n - before - behind], heights[:, before : n - behind]
            span, rise = (before + behind) * spacing, heights[:, before + behind :] - left
            stretch = np.hypot(1.0, rise / span)
            chord = (left + rise * (before / (before + behind)) - middle) / stretch
            chord[span * stretch > length * (1.0 + ROUNDING)] = 0.0
            under = gap[:, before : n - behind]
            np.fmax(under, chord, out=under)
    slope = np.abs(np.gradient(heights, spacing, axis=1))
    return np.where(np.isfinite(heights) & ~(slope > STEEPEST), gap, np.nan)
