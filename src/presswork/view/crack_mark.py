# SPDX-License-Identifier: Apache-2.0
"""Where damage first passed its critical value, on pictures of that damage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from presswork.model import FloatArray, IndexArray
from presswork.results import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def find_judged_damage(result: Result) -> list[str]:
    """Return the damage fields that have a critical value."""
    damage: Mapping[str, Any] = result.summary.get("damage", {})
    return [name for name, known in damage.items() if known["critical"] is not None and name in result.field_names]


def find_first_crack(result: Result, field: str) -> Mapping[str, Any] | None:
    """Return when and where a damage first passed its critical value; None if it did not, or another field is meant."""
    found: Mapping[str, Any] | None = result.summary.get("damage", {}).get(field, {}).get("first_exceeded")
    return found


def describe_first_crack(crack: Mapping[str, Any]) -> str:
    """Return a line with the stroke, or the time, of the first crack.

    >>> describe_first_crack({"strokes_mm": {"punch": 3.33}, "time_s": 0.4})
    'first crack (x) at punch 3.33 mm'
    """
    strokes = ", ".join(f"{tool} {stroke:.4g} mm" for tool, stroke in crack["strokes_mm"].items())
    time = f"{crack['time_s']:.4g} s"
    return f"first crack (x) at {strokes or time}"


def find_centre(points: FloatArray, blocks: Sequence[IndexArray], cell: int) -> FloatArray:
    """Return the centre of a cell (2 | 3,) [mm], counted through the blocks of connectivity."""
    for connectivity in blocks:
        if cell < len(connectivity):
            return np.asarray(points[connectivity[cell]].mean(axis=0))
        cell -= len(connectivity)
    raise IndexError("there is no such cell")


def place_first_crack(result: Result, crack: Mapping[str, Any], step: int, points: FloatArray) -> FloatArray | None:
    """Return the centre of the cell in which a crack first began, where it is at a step (2 | 3,) [mm]; None before.

    points: where the nodes are drawn. Where the mesh has changed the cell is not known: then where the crack began.
    """
    if result.times[step] < crack["time_s"] * (1 - 1e-9):
        return None
    mesh = result.mesh_at(step)
    if mesh is result.mesh_at(0) and mesh is result.mesh_at(-1):
        return find_centre(points, [block.connectivity for block in mesh.blocks], crack["cell"])
    return np.array(crack["at_mm"][: points.shape[1]])


def mark_first_crack(ax: Axes, result: Result, field: str, step: int) -> str:
    """Mark where a crack first began; return the line with the time, or an empty one before."""
    crack = find_first_crack(result, field)
    place = None if crack is None else place_first_crack(result, crack, step, result.points(step))
    if crack is None or place is None:
        return ""
    x, y = place[:2]
    for size, colour, line, order in ((120, "white", 4.0, 6), (90, "#d1001f", 2.2, 7)):
        ax.scatter([x], [y], s=size, marker="x", c=colour, linewidths=line, zorder=order, clip_on=False)
    return describe_first_crack(crack)
