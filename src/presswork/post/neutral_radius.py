# SPDX-License-Identifier: Apache-2.0
"""Where the flow along a tool parts: the neutral radius of a ring or a disc."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray
from presswork.post.interface import trace_interface
from presswork.results import Result, ResultError


@dataclass(frozen=True)
class NeutralRadius:
    """Radii on the contact surface at which the flow parts [mm]; NaN where there is none."""

    by_slip: float
    """Where the material's velocity along the tool is that of the tool. It is what Avitzur's neutral radius means, and
    it is found within a cell, since the slip varies smoothly. None where everything sticks."""
    by_shear: float
    """Where the contact shear changes its sign, as friction does with the slip. Under constant shear friction it jumps
    there, so it is found to the size of a cell; it is there on a sticking tool too, and not without friction."""


def find_neutral_radius(result: Result, step: int = -1, tool: str | None = None) -> NeutralRadius:
    """Return where the flow parts on the contact surface of an axisymmetric run.

    The slip is that between the saved steps on both sides (one-sided at the first and the last step), of the nodes in
    contact at all of them; so save steps close together. A surface that flows one way has none: in a ring with little
    friction all of it flows outwards. Of several, as on a wavy surface, the innermost is returned. Raises ResultError
    for another kind of run, an unknown step or an unknown tool, or if several tools leave the choice.
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
    slides = np.abs(slip).max(initial=0.0) > 1e-6 * np.linalg.norm(carried)
    same = trace.patch[1:] == trace.patch[:-1]
    return NeutralRadius(
        by_slip=_first_crossing(radius, slip, same & lasting[1:] & lasting[:-1]) if slides else np.nan,
        by_shear=_first_crossing(radius, trace.contact_shear, same),
    )


def _tangents(points: FloatArray, patch: np.ndarray) -> FloatArray:
    """Return unit vectors along each part of the contact surface (n, 2), by differences."""
    tangent = np.zeros_like(points)
    for part in np.unique(patch):
        line = points[patch == part]
        if len(line) > 1:
            along = np.gradient(line, axis=0)
            tangent[patch == part] = along / np.linalg.norm(along, axis=1, keepdims=True)
    return tangent


def _first_crossing(radius: FloatArray, value: FloatArray, joined: np.ndarray) -> float:
    """Return the smallest radius at which the value, linear between neighbours that are joined, changes its sign."""
    a, b = value[:-1], value[1:]
    (places,) = np.nonzero((a * b < 0) & joined)
    crossings = radius[places] + (radius[places + 1] - radius[places]) * a[places] / (a[places] - b[places])
    return float(crossings.min(initial=np.inf)) if len(places) else float("nan")
