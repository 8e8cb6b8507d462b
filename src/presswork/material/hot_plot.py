# SPDX-License-Identifier: Apache-2.0
"""Pictures of flow stress by strain, rate and temperature."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from presswork.case.material.library import NamedSheet
from presswork.material.compression import CompressionTest
from presswork.material.identify_hot import HotFit
from presswork.view.style import clean_axes, new_figure, save_picture

MOST_IN_A_ROW = 3
LARGEST_STRAIN = 1.0
"""Strain to which a law is drawn whose window has no such end."""


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
    return save_picture(figure, path)


def draw_hot_law(named: NamedSheet, path: Path) -> Path:
    """Draw a hot law over its window, at three temperatures and three rates. Raises ImportError without matplotlib."""
    hardening, law = named.material.to_model(named.key).hardening, named.material.build_law()
    assert hardening is not None, "a UMAT"
    assert hardening.window is not None, "not a hot law"
    (low, high), rates, temperatures = hardening.window
    figure = new_figure(11.0, 4.0)
    axes = figure.subplots(1, 3, sharey=True)
    strain = np.linspace(low, min(high, LARGEST_STRAIN), 200)
    for ax, degrees in zip(axes, np.linspace(temperatures[0], temperatures[1], 3), strict=True):
        for rate in np.geomspace(rates[0], rates[1], 3):
            stress = law.flow_stress(strain, np.full_like(strain, rate), np.full_like(strain, degrees))[0]
            ax.plot(strain, stress, label=f"{rate:.3g} 1/s")
        ax.set_title(f"{degrees:.0f} degrees C", fontsize="medium")
        ax.set_ylim(bottom=0.0)
        ax.set_xlim(left=0.0)
        ax.set_xlabel("plastic strain")
        clean_axes(ax)
    axes[0].set_ylabel("flow stress [MPa]")
    axes[0].legend(frameon=False, fontsize=8)
    figure.suptitle(f"{named.name}: {hardening.law} within its window")
    return save_picture(figure, path)
