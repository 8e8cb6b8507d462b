# SPDX-License-Identifier: Apache-2.0
"""calibration.png: the calibration curves, the measured points and the curve that fits them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.view.style import COLOURS, clean_axes, save_picture

if TYPE_CHECKING:
    from presswork.study.calibrate import Calibration

PICTURE = "calibration.png"


def draw_calibration(calibration: Calibration) -> Path | None:
    """Draw change of the bore against height reduction [%]; None without matplotlib."""
    try:
        import matplotlib as mpl
        from matplotlib.figure import Figure
    except ImportError:
        return None
    curves, measured, fit = calibration.curves, calibration.measured, calibration.fit
    symbol = {"shear": "m", "coulomb": "μ"}[calibration.law]
    figure = Figure(figsize=(7.0, 4.8), layout="constrained")
    ax = figure.subplots()
    reduction = np.linspace(0.0, float(curves.height_reduction[-1]), 101)
    bore = curves.interpolate(reduction)
    for i, (value, colour) in enumerate(
        zip(curves.friction, mpl.colormaps[COLOURS](np.linspace(0, 0.92, len(curves.friction))), strict=True)
    ):
        line = 100 * (bore(value) - 1)
        ax.plot(100 * reduction, line, color=colour, linewidth=1.2)
        text = f"{symbol} = {value:g}" if i == 0 else f"{value:g}"
        ax.annotate(text, (100 * reduction[-1], line[-1]), (4, 0), textcoords="offset points", va="center", fontsize=8)
    ax.plot(100 * reduction, 100 * (bore(fit.friction) - 1), "k--", linewidth=1.6, label=_describe(calibration, symbol))
    ax.plot(100 * measured.height_reduction, 100 * (measured.bore_ratio - 1), "o", color="C3", label="measured")
    ax.axhline(0.0, color="0.5", linewidth=0.8)
    ax.set_xlabel("height reduction [%]")
    ax.set_ylabel("change of the bore [%]")
    ax.legend(frameon=False, loc="best")
    clean_axes(ax)
    return save_picture(figure, calibration.folder / PICTURE)


def _describe(calibration: Calibration, symbol: str) -> str:
    fit = calibration.fit
    low, high = fit.interval
    return f"{symbol} = {fit.friction:.3f}" + (f" (95 %: {low:.3f} to {high:.3f})" if np.isfinite(low) else "")
