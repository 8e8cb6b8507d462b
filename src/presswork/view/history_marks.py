# SPDX-License-Identifier: Apache-2.0
"""Marks on a force-stroke curve: the largest force, and where a sheet first lay above its forming limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from presswork.results import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_ROOM = 0.3
"""Part of the width that the words of a peak take."""


def mark_peak(ax: Axes, x: float, y: float) -> None:
    """Mark a force [kN] at a stroke [mm]; its words stand on the side that has room, once all curves are drawn."""
    low, high = ax.get_xlim()
    is_left = x - low < _ROOM * (high - low)
    ax.plot([x], [y], "o", color="0.2", markersize=4, zorder=4)
    ax.annotate(
        f"{y:.4g} kN at {x:.4g} mm", (x, y), xytext=(6 if is_left else -6, 6), textcoords="offset points",
        ha="left" if is_left else "right", fontsize="small",
    )  # fmt: skip


def mark_history(ax: Axes, result: Result, drawn: Sequence[tuple[str, str]]) -> None:
    """Mark the largest of the forces drawn, and the stroke of the first crack.

    drawn: pairs of columns of the history, abscissa and ordinate; forces in N, of which the picture shows kN.
    """
    history = result.history
    forces = [(x, y) for x, y in drawn if y.endswith(".force") and x.endswith(".stroke") and len(history[y])]
    if not forces:
        return
    stroke, force = max(forces, key=lambda pair: float(np.abs(history[pair[1]]).max()))
    at = int(np.argmax(np.abs(history[force])))
    x, y = float(history[stroke][at]), 1e-3 * float(history[force][at])
    if y:
        mark_peak(ax, x, y)
    tool = stroke.removesuffix(".stroke")
    crack = result.summary.get("first_crack", {}).get("strokes_mm", {}).get(tool)
    if crack is not None:
        ax.axvline(crack, color="#c8102e", linestyle="--", linewidth=1.0)
        ax.annotate(
            f"first crack, {crack:.4g} mm", (crack, 0.03), xycoords=("data", "axes fraction"), xytext=(-4, 0),
            textcoords="offset points", ha="right", rotation=90, va="bottom", fontsize="small", color="#c8102e",
        )  # fmt: skip
