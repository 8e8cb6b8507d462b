# SPDX-License-Identifier: Apache-2.0
"""Neutral radius of a ring or a disc: the radius where the flow along a tool changes its direction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.post.interface import trace_interface
from presswork.results import Result, ResultError

_STUCK = 0.02
"""Part of the largest slip below which a node sticks."""

_NO_FRICTION = 1e-3
"""Part of the largest pressure below which shear is what the iteration leaves."""


@dataclass(frozen=True)
class NeutralRadius:
    """Radii on the contact surface at which the flow parts [mm]; NaN where there is none."""

    by_slip: float
    """Where the material's velocity along the tool is that of the tool, in the middle of the zone that hardly slips
    (less than 2 % of the fastest). It is what Avitzur's neutral radius means; NaN where everything sticks."""
    stick_width: float
    """Width of that zone, by which by_slip is uncertain [mm]: with much friction it spans cells."""
    by_shear: float
    """Where the contact shear changes its sign, as friction does with the slip. Under constant shear friction it jumps
    there, so it is found to half a cell; it is there on a sticking tool too, and not without friction."""


def find_neutral_radius(result: Result, step: int = -1, tool: str | None = None) -> NeutralRadius:
    """Return where the flow parts on the contact surface of an axisymmetric run.

    The slip is that between the saved steps on both sides (one-sided at the first and the last step), of the nodes in
    contact at all of them; so save steps close together. A surface that flows in one direction has none: in a ring with
    little friction all of it flows outwards. If there are several, as on a wavy surface, the innermost is returned.
    Raises ResultError for another kind of run, an unknown step or an unknown tool, or if several tools leave the
    choice.
    """
    if result.info.get("analysis") != "axisymmetric":
        raise ResultError(f"{result.folder} is not axisymmetric: it has no radius")
    names = [tool] if tool is not None else list(result.tools)
    if len(names) != 1:
        raise ResultError(f"{result.folder} has several tools; name one of: {', '.join(sorted(names))}")
    count = len(result.times)
    result.field("displacement", step)  # checks the step
    at = step % count
    trace = trace_interface(result, names[0], at)
    tangent = _tangents(trace.points, trace.patch)
    radius = trace.points[:, 0]

    first, last = max(at - 1, 0), min(at + 1, count - 1)
    lasting = np.isin(trace.nodes, trace_interface(result, names[0], last).nodes)
    lasting &= np.isin(trace.nodes, trace_interface(result, names[0], first).nodes) | (first == 0)
    moved = result.points(last) - result.points(first)
    carried = result.tool_displacement(names[0], last) - result.tool_displacement(names[0], first)
    slip = np.einsum("ni,ni->n", tangent, moved[trace.nodes] - carried)
    still = np.abs(slip).max(initial=0.0) <= 1e-6 * np.linalg.norm(carried)
    same = trace.patch[1:] == trace.patch[:-1]
    part = _find_parting(radius, slip, same & lasting[1:] & lasting[:-1]) if not still else None
    pressure, shear = (np.abs(values).max(initial=0.0) for values in (trace.contact_pressure, trace.contact_shear))
    has_friction = shear > _NO_FRICTION * pressure
    turn = _find_parting(radius, trace.contact_shear, same, share=0.0) if has_friction else None
    return NeutralRadius(
        by_slip=float(np.mean(part)) if part else np.nan,
        stick_width=part[1] - part[0] if part else np.nan,
        by_shear=turn[0] if turn else np.nan,
    )


def _tangents(points: FloatArray, patch: NDArray[np.int64]) -> FloatArray:
    """Return unit vectors along each part of the contact surface (n, 2), by differences."""
    tangent = np.zeros_like(points)
    for part in np.unique(patch):
        line = points[patch == part]
        if len(line) > 1:
            along = np.gradient(line, axis=0)
            tangent[patch == part] = along / np.linalg.norm(along, axis=1, keepdims=True)
    return tangent


def _find_parting(
    radius: FloatArray, value: FloatArray, joined: NDArray[np.bool_], share: float = _STUCK
) -> tuple[float, float] | None:
    """Return the innermost zone in which the value, linear between neighbours that are joined, changes its sign.

    The zone (from, to) is where the value is less than `share` of the largest; None if it does not change its sign.
    """
    level = share * np.abs(value).max(initial=0.0)
    sign = np.where(np.abs(value) > level, np.sign(value), 0.0)
    (moving,) = np.nonzero(sign)
    zones = []
    for p, q in pairwise(moving.tolist()):
        if sign[p] == sign[q] or not joined[p:q].all():
            continue
        leaves, arrives = _reach(radius, value, p, sign[p] * level), _reach(radius, value, q - 1, sign[q] * level)
        zones.append((min(leaves, arrives), max(leaves, arrives)))
    return min(zones, default=None)


def _reach(radius: FloatArray, value: FloatArray, i: int, level: float) -> float:
    """Return the radius between nodes i and i + 1 at which the value is this."""
    return float(radius[i] + (radius[i + 1] - radius[i]) * (level - value[i]) / (value[i + 1] - value[i]))
