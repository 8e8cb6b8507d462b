# SPDX-License-Identifier: Apache-2.0
"""The picture of a tool's wear: where on its surface, and in the plane how deep along its profile."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from presswork.results import Result
from presswork.view.style import COLOURS, bare_figure, begin_at_zero, clean_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MICROMETRES = 1e3
LABEL = "wear of a part [µm]"


def find_worn_tools(result: Result) -> list[str]:
    """Return the tools whose wear was followed."""
    return [name for name in result.summary.get("wear", {}) if (result.folder / f"wear_{name}.csv").is_file()]


def plot_wear(result: Result, tool: str) -> Figure:
    """Draw a tool's surface coloured by the depth that a part wears off; of a profile also the depth along it."""
    table = np.genfromtxt(result.folder / f"wear_{tool}.csv", delimiter=",", names=True)
    names = [name for name in ("x", "y", "z") if name in (table.dtype.names or ())]
    places = np.stack([table[name] for name in names], axis=1)
    depth = MICROMETRES * table["depth_per_part"]
    is_profile = len(names) == 2
    figure = bare_figure(7.6, 6.4 if is_profile else 5.2)
    if is_profile:
        upper, lower = figure.subplots(2, 1)
        if places[-1, 0] < places[0, 0]:
            places, depth = places[::-1], depth[::-1]
        gone = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)))
        lower.fill_between(gone, depth, color="tab:red", alpha=0.25, linewidth=0.0)
        lower.plot(gone, depth, color="tab:red")
        lower.set_xlabel("along the profile [mm]")
        lower.set_ylabel(LABEL)
        begin_at_zero(lower)
        clean_axes(lower)
    else:
        upper = figure.subplots()
    across, up = np.sort(np.argsort(-np.ptp(places, axis=0), kind="stable")[:2])
    order = np.argsort(depth, kind="stable")
    drawn = upper.scatter(places[order, across], places[order, up], c=depth[order], cmap=COLOURS, s=9.0)
    figure.colorbar(drawn, ax=upper, label=LABEL)
    upper.set_aspect("equal", "datalim")
    upper.set_xlabel(f"{names[across]}, as drawn [mm]")
    upper.set_ylabel(f"{names[up]}, as drawn [mm]")
    clean_axes(upper)
    figure.suptitle(
        "\n".join((str(result.info.get("title", "")).strip(), _describe(tool, result.summary["wear"][tool])))
    )
    return figure


def _describe(tool: str, found: Mapping[str, Any]) -> str:
    text = f"wear of {tool.replace('_', ' ')}: deepest {found['deepest_um_per_part']:.3g} µm a part"
    if found["parts"] > 1:
        text += f", {found['deepest_mm']:.3g} mm after {found['parts']} parts"
    if found.get("parts_until_limit") is not None:
        text += f"; {found['limit_mm']:g} mm after {found['parts_until_limit']}"
    return text
