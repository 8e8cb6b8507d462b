# SPDX-License-Identifier: Apache-2.0
"""outlines.png: the blanks and the flanges drawn from them, beside the target."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.view.style import COLOURS, save_picture

if TYPE_CHECKING:
    from presswork.study.blank_shape import Draw

PICTURE = "outlines.png"


def draw_outlines(draws: Sequence[Draw], target: FloatArray, folder: Path) -> Path | None:
    """Draw every blank and every flange in the order of the draws; None without matplotlib."""
    try:
        import matplotlib as mpl
        from matplotlib.figure import Figure
    except ImportError:
        return None
    figure = Figure(figsize=(10.5, 4.8), layout="constrained")
    blanks, flanges = figure.subplots(1, 2)
    colours = mpl.colormaps[COLOURS](np.linspace(0.0, 0.88, len(draws)))
    for draw, colour in zip(draws, colours, strict=True):
        label = f"draw {draw.number}: {draw.fit.worst:.2f} mm off"
        blanks.plot(*_close(draw.fit.blank), color=colour, linewidth=1.1)
        flanges.plot(*_close(draw.fit.drawn), color=colour, linewidth=1.1, label=label)
    flanges.plot(*_close(target), "k--", linewidth=0.9, label="target")
    for axes, title in ((blanks, "blanks"), (flanges, "flanges, from above")):
        axes.set_aspect("equal")
        axes.set_title(title, fontsize="medium")
        axes.set_xlabel("x [mm]")
    blanks.set_ylabel("y [mm]")
    flanges.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return save_picture(figure, folder / PICTURE)


def _close(loop: FloatArray) -> FloatArray:
    return np.concatenate([loop, loop[:1]]).T
