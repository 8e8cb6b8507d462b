# SPDX-License-Identifier: Apache-2.0
"""Pictures of fits and of forming limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from presswork.formability import FormingLimitCurve
from presswork.material.identify import HardeningFit
from presswork.material.tensile import TensileTest
from presswork.view.style import clean_axes, new_figure, save_picture

_LARGEST_STRAIN = 0.8


def draw_fit(tests: Sequence[TensileTest], fits: Sequence[HardeningFit], young: float, path: Path) -> Path:
    """Draw measured points and fitted laws, dashed where they extrapolate. Raises ImportError without matplotlib."""
    figure = new_figure(7.0, 4.8)
    ax = figure.subplots()
    for test, shade in zip(tests, np.linspace(0.4, 0.8, len(tests)), strict=True):
        p = test.plastic_strain(young)
        label = f"measured, {test.angle:g}°"
        ax.plot(p[p >= 0], test.stress[p >= 0], ".", markersize=4, color=str(shade), label=label)
    for i, fit in enumerate(fits):
        inside = np.linspace(0.0, fit.largest_strain, 100)
        beyond = np.linspace(fit.largest_strain, _LARGEST_STRAIN, 100)
        text = f"{fit.law}: {fit.scatter:.2f} MPa ({100 * fit.relative:.2f} %)"
        ax.plot(inside, fit.stress(inside), color=f"C{i}", label=text)
        ax.plot(beyond, fit.stress(beyond), "--", color=f"C{i}", linewidth=1.0)
    ax.axvspan(fits[0].largest_strain, _LARGEST_STRAIN, color="0.95", zorder=0)
    ax.annotate("extrapolated", (0.99, 0.02), xycoords="axes fraction", ha="right", color="0.4", fontsize=9)
    ax.set_xlim(0.0, _LARGEST_STRAIN)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("plastic strain")
    ax.set_ylabel("true stress [MPa]")
    ax.legend(frameon=False, fontsize=8)
    clean_axes(ax)
    return save_picture(figure, path)


def draw_curves(curves: Mapping[str, FormingLimitCurve], title: str, path: Path, *, r: float = 1.0) -> Path:
    """Draw forming limit curves by name, and the strain path of tension in a sheet of the mean r-value r.

    Raises ImportError without matplotlib.
    """
    figure = new_figure(6.4, 4.8)
    ax = figure.subplots()
    for name, curve in curves.items():
        ax.plot(curve.minor, curve.major, label=f"{name} ({curve.method})" if name else curve.method)
    top = 1.15 * max(float(curve.major.max()) for curve in curves.values())
    tension = -(1 + r) / r
    for slope, text, side in ((tension, f"tension, r = {r:.3g}", "right"), (1.0, "balanced", "left")):
        ax.plot([0.0, top / slope], [0.0, top], color="0.7", linewidth=0.8)
        place = 0.4 * top if side == "right" else 0.9 * top
        ax.annotate(text, (place / slope, place), color="0.5", fontsize=8, ha=side)
    ax.set_xlim(min(-0.55, 1.02 / tension) * top, 1.0 * top)
    ax.set_ylim(0.0, top)
    ax.set_xlabel("minor true strain")
    ax.set_ylabel("major true strain")
    ax.set_title(title)
    ax.legend(frameon=False, fontsize=8)
    clean_axes(ax)
    return save_picture(figure, path)
