# SPDX-License-Identifier: Apache-2.0
"""Pictures of flow stress by strain, rate and temperature."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from presswork.material.compression import CompressionTest
from presswork.material.identify_hot import HotFit
from presswork.view.style import DPI, clean_axes, new_figure

MOST_IN_A_ROW = 3


def draw_hot_fit(tests: Sequence[CompressionTest], fits: Sequence[HotFit], title: str, path: Path) -> Path:
    """Draw measured points and the best law, a panel for each temperature. Raises ImportError without matplotlib."""
    starts = sorted({test.start for test in tests})
    columns = min(len(starts), MOST_IN_A_ROW)
    rows = -(-len(starts) // columns)
    figure = new_figure(1.0 + 3.6 * columns, 0.8 + 3.0 * rows)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
    rates = sorted({test.rate for test in tests})
    best = fits[0]
    for ax, start in zip(axes, starts, strict=False):
        for test in (test for test in tests if test.start == start):
            colour = f"C{rates.index(test.rate)}"
            every = max(1, len(test.strain) // 25)
            ax.plot(test.strain[::every], test.stress[::every], ".", markersize=4, color=colour)
            fitted = best.stress(test.strain, test.rate, test.temperature)
            ax.plot(test.strain, fitted, color=colour, label=f"{test.rate:g} 1/s")
        ax.set_title(f"{start:g} degrees C", fontsize="medium")
        ax.set_ylim(bottom=0.0)
        ax.set_xlim(left=0.0)
        ax.set_xlabel("strain")
        ax.set_ylabel("flow stress [MPa]")
        clean_axes(ax)
    axes[0].legend(frameon=False, fontsize=8)
    for ax in axes[len(starts) :]:
        ax.set_axis_off()
    scatter = f"{best.scatter:.2f} MPa ({100 * best.relative:.2f} %)"
    figure.suptitle(f"{title}: points measured, lines {best.law}, {scatter}")
    figure.savefig(path, format="png", dpi=DPI)
    return path


def draw_hot_law(title: str, fit: HotFit, path: Path) -> Path:
    """Draw a law over its window: by strain at three temperatures and three rates. Raises ImportError likewise."""
    low, high = fit.temperature_window
    slow, fast = fit.rate_window
    figure = new_figure(11.0, 4.0)
    axes = figure.subplots(1, 3, sharey=True)
    strain = np.linspace(fit.strain_window[0], min(fit.strain_window[1], 2.0), 200)
    for ax, degrees in zip(axes, np.linspace(low, high, 3), strict=True):
        for rate in np.geomspace(slow, fast, 3):
            stress = fit.stress(strain, float(rate), np.full_like(strain, degrees))
            ax.plot(strain, stress, label=f"{rate:.3g} 1/s")
        ax.set_title(f"{degrees:.0f} degrees C", fontsize="medium")
        ax.set_ylim(bottom=0.0)
        ax.set_xlim(left=0.0)
        ax.set_xlabel("strain")
        clean_axes(ax)
    axes[0].set_ylabel("flow stress [MPa]")
    axes[0].legend(frameon=False, fontsize=8)
    figure.suptitle(f"{title}, {fit.law}, within its window")
    figure.savefig(path, format="png", dpi=DPI)
    return path
