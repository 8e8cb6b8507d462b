# SPDX-License-Identifier: Apache-2.0
"""One picture of a sheet material: yield locus, yield stress and r-value by direction, flow stress."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.case.material.library import NamedSheet
from presswork.material.predict import predict_shear, predict_tension, trace_locus
from presswork.view.style import clean_axes, new_figure, save_picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LARGEST_STRAIN = 0.6


def draw_sheet(sheet: NamedSheet, path: Path) -> Path:
    """Draw yield locus, directional tension and hardening into a PNG. Raises ImportError without matplotlib."""
    figure = new_figure(12.0, 4.2)
    axes = figure.subplots(1, 3)
    _draw_locus(axes[0], sheet)
    _draw_directions(axes[1], sheet)
    _draw_hardening(axes[2], sheet)
    figure.suptitle(sheet.name)
    return save_picture(figure, path)


def _draw_locus(ax: Axes, sheet: NamedSheet) -> None:
    function = sheet.material.yield_function.build()
    largest = predict_shear(function)
    for i, part in enumerate((0.0, 0.5, 0.8, 0.95)):
        points = trace_locus(function, part * largest)
        ax.plot(points[:, 0], points[:, 1], color=f"C{i}", label=f"{part * largest:.2f}")
    ax.axhline(0.0, color="0.5", linewidth=0.8)
    ax.axvline(0.0, color="0.5", linewidth=0.8)
    ax.set_aspect("equal")
    ax.set_xlabel("σxx / flow stress")
    ax.set_ylabel("σyy / flow stress")
    ax.legend(title="σxy / flow stress", frameon=False, fontsize=8, title_fontsize=8)
    clean_axes(ax)


def _draw_directions(ax: Axes, sheet: NamedSheet) -> None:
    tension = predict_tension(sheet.material.yield_function.build(), np.linspace(0.0, 90.0, 91))
    ax.plot(tension.angle, tension.r, color="C0", label="r-value")
    ax.plot(tension.angle, tension.stress, color="C3", label="yield stress / flow stress")
    ax.set_xlabel("angle from the rolling direction [°]")
    ax.set_xticks(range(0, 91, 15))
    ax.set_ylim(bottom=0.0)
    ax.legend(frameon=False, fontsize=8)
    clean_axes(ax)


def _draw_hardening(ax: Axes, sheet: NamedSheet) -> None:
    strain = np.linspace(0.0, _LARGEST_STRAIN, 301)
    ax.plot(strain, sheet.material.build_law().flow_stress(strain)[0], color="C0")
    ax.set_xlabel("equivalent plastic strain")
    ax.set_ylabel("flow stress [MPa]")
    ax.set_ylim(bottom=0.0)
    clean_axes(ax)
