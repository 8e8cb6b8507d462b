# SPDX-License-Identifier: Apache-2.0
"""Measurements of a ring test, from the results of a run: bore, outer diameter, height, neutral radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IntArray
from presswork.results import Result, ResultError

_NEAR = 1e-6


@dataclass(frozen=True)
class RingMeasures:
    """A ring at its saved steps, the first undeformed; all shape (n_steps,). Ratios are over the first value."""

    height_reduction: FloatArray
    """Fraction of the first height."""
    bore_mean: FloatArray
    """Bore ratio, radius averaged over the present height."""
    bore_mid: FloatArray
    """Bore ratio at mid-height."""
    outer_mean: FloatArray
    outer_mid: FloatArray
    neutral_radius: FloatArray
    """Radius [mm] that the flow, averaged over the height, parts at; less than the bore if all flows outwards.

    From the bore alone: R_n^2 = R_i^2 + T d(R_i^2)/dT, with R_i^2 averaged over the height T (steps by differences).
    """
    initial_bore: float
    """Diameter [mm]."""


def measure_ring(result: Result) -> RingMeasures:
    """Measure an axisymmetric ring of rectangular section between platens, modelled whole or as one half.

    Its half is known by its tools: with a platen on one side only, the other side is the middle plane. Raises
    ResultError if it is no such ring.
    """
    points = result.mesh.points
    low, high = points.min(axis=0), points.max(axis=0)
    if result.info.get("analysis") != "axisymmetric" or low[0] <= _NEAR * high[0]:
        raise ResultError(f"{result.folder} is not a ring: an axisymmetric body with a bore is needed")
    bore, outside = (_side(result, x) for x in (low[0], high[0]))
    middle = _find_middle(result, float(low[1]), float(high[1]))
    heights, squares, rows = [], [], []
    for step in range(len(result.times)):
        deformed = result.points(step)
        heights.append(np.ptp(deformed[:, 1]))
        squares.append(_average(deformed[bore], 2))
        rows.append(
            [f for side in (bore, outside) for f in (_average(deformed[side], 1), _at(points, deformed, side, middle))]
        )
    height, square = np.array(heights), np.array(squares)
    ratios = np.array(rows) / np.array(rows)[0]
    parting = square + height * np.gradient(square, height) if len(height) > 1 else np.full(1, np.nan)
    return RingMeasures(
        height_reduction=1 - height / height[0],
        bore_mean=ratios[:, 0],
        bore_mid=ratios[:, 1],
        outer_mean=ratios[:, 2],
        outer_mid=ratios[:, 3],
        neutral_radius=np.sqrt(np.maximum(parting, 0.0)),
        initial_bore=2.0 * float(low[0]),
    )


def _side(result: Result, radius: float) -> IntArray:
    """Return the nodes at a radius of the undeformed ring, from the bottom to the top of the section."""
    points = result.mesh.points
    extent = np.ptp(points, axis=0)
    nodes = np.flatnonzero(np.abs(points[:, 0] - radius) < _NEAR * extent[0])
    nodes = nodes[np.argsort(points[nodes, 1])]
    if len(nodes) < 2 or np.ptp(points[nodes, 1]) < (1 - _NEAR) * extent[1]:
        raise ResultError(f"{result.folder}: the ring's section is not rectangular at the radius of {radius:g} mm")
    return np.asarray(nodes, dtype=np.int32)


def _find_middle(result: Result, low: float, high: float) -> float:
    """Return the undeformed height of the ring's middle plane."""
    near = _NEAR * (high - low)
    above = any(tool[:, [1, 3]].min() >= high - near for tool in result.tools.values())
    below = any(tool[:, [1, 3]].max() <= low + near for tool in result.tools.values())
    if not (above or below):
        raise ResultError(f"{result.folder} is not a ring compression: there is no flat tool above or below the ring")
    return 0.5 * (low + high) if above and below else low if above else high


def _average(line: FloatArray, power: int) -> float:
    """Return the mean over the height of the radius to a power, along a line of nodes (n, 2) [mm]."""
    rise = np.diff(line[:, 1])
    r, s = line[:-1, 0], line[1:, 0]
    mean = 0.5 * (r + s) if power == 1 else (r * r + r * s + s * s) / 3
    return float((mean * rise).sum() / rise.sum())


def _at(points: FloatArray, deformed: FloatArray, side: IntArray, height: float) -> float:
    """Return the present radius where the undeformed height was this."""
    return float(np.interp(height, points[side, 1], deformed[side, 0]))
