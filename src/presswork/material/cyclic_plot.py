# SPDX-License-Identifier: Apache-2.0
"""Pictures of laws fitted to tests with reversals."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from presswork.material.cyclic import CyclicTest
from presswork.material.identify_cyclic import CyclicFit
from presswork.view.style import clean_axes, new_figure, save_picture


def draw_cyclic(test: CyclicTest, fits: Sequence[CyclicFit], title: str, path: Path) -> Path:
    """Draw measured stress over strain and the laws, and their errors along the path below.

    Raises ImportError without matplotlib.
    """
    figure = new_figure(7.4, 7.0)
    top, bottom = figure.subplots(2, 1, height_ratios=(3, 1.4))
    travelled, start = [], 0.0
    for branch in test.branches:
        length = abs(branch.strain - branch.strain[0])
        travelled.append(start + length)
        start += float(length[-1])
    for i, branch in enumerate(test.branches):
        label = "measured" if i == 0 else None
        top.plot(branch.strain, branch.stress, "o", markersize=3, color="0.6", label=label)
    for k, fit in enumerate(fits):
        fitted, predicted = fit.find_error(fitted=True), fit.find_error(fitted=False)
        label = f"{fit.law}: {fitted:.1f} MPa" + (f", predicted {predicted:.1f}" if predicted == predicted else "")
        for i, (branch, stress, at) in enumerate(zip(test.branches, fit.stress, travelled, strict=True)):
            colour = f"C{k}"
            top.plot(branch.strain, stress, color=colour, linewidth=1.3, label=label if i == 0 else None)
            bottom.plot(at, stress - branch.stress, color=colour, linewidth=1.1)
    if fits[0].fitted_path < start:
        bottom.axvspan(fits[0].fitted_path, start, color="0.93", zorder=0)
        bottom.annotate("predicted", (0.99, 0.04), xycoords="axes fraction", ha="right", color="0.4", fontsize=9)
    bottom.axhline(0.0, color="0.5", linewidth=0.6)
    bottom.set_xlim(0.0, start)
    top.set_xlabel("true strain")
    top.set_ylabel("true stress [MPa]")
    bottom.set_xlabel("path of the strain")
    bottom.set_ylabel("law less test [MPa]")
    top.set_title(title, fontsize="medium")
    top.legend(frameon=False, fontsize=8)
    for ax in (top, bottom):
        clean_axes(ax)
    return save_picture(figure, path)
