# SPDX-License-Identifier: Apache-2.0
"""What a hem has become: where its edge lies, how thick it is, how far its flange opens.

The rim is cut across its fold into strips of the undeformed sheet. In each the edge is the outermost place of the outer
face near the panel. Nodes of a strip that lie beyond its outermost one, seen in the undeformed sheet, belong to the
flange, those before it to the panel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.model import FloatArray, Hem, IntArray

STRIPS = 20
"""Largest number of strips."""
NEAR = 2.5
"""Thicknesses over or under the panel within which the edge is looked for: a wall that leans out has its tip further
out."""
BEHIND = 8.0
"""Thicknesses from the edge at which the panel's height counts."""
FOLDED = 60.0
"""Degrees below which the flange covers the panel, so that the hem has a thickness."""


@dataclass(frozen=True)
class HemShape:
    """A hem by its strips, NaN where the flange does not cover the panel."""

    edge: FloatArray
    """How far out its outer face lies (n,) [mm]."""
    thickest: FloatArray
    """Largest thickness over the flange, its fold included, which stands up where it is left open (n,) [mm]."""
    thinnest: FloatArray
    """Least thickness over the flat of the flange (n,) [mm]."""
    opening: FloatArray
    """Angle between panel and flange (n,) [degree]: 90 as flanged, 0 pressed flat, below zero where the tip dips."""

    def to_summary(self) -> dict[str, Any]:
        """Return its part of the summary."""
        summary: dict[str, Any] = {"edge_mm": _spread(self.edge), "opening_degrees": _spread(self.opening)}
        if np.isfinite(self.thickest).any():
            summary["thickness_mm"] = [float(np.nanmin(self.thinnest)), float(np.nanmax(self.thickest))]
        return summary


def _spread(values: FloatArray) -> dict[str, float]:
    return {"mean": float(values.mean()), "least": float(values.min()), "most": float(values.max())}


def measure_hem(hem: Hem, undeformed: FloatArray, position: FloatArray, half: FloatArray) -> HemShape:
    """Measure a hem.

    undeformed, position: of the nodes (n, 3) [mm], the former turned as the part lies. half: half of the thickness
    there (n,) [mm].
    """
    out, aside = _split(hem, undeformed)
    now, _ = _split(hem, position)
    rim = out >= 0.5 * (out.min() + out.max())
    size = max(float(np.ptp(aside[rim])), 1e-12)
    n = int(np.clip(np.sqrt(rim.sum()) / 4.0, 1, STRIPS))
    # a line of nodes on the border of two strips goes to one of them, whatever rounding does
    strip = np.clip(((aside - aside[rim].min()) / size * n + 1e-6).astype(int), 0, n - 1)
    rows = [_measure_strip(out[own], now[own], position[own, 2], half[own]) for k in range(n)
            if len(own := np.flatnonzero(rim & (strip == k))) > 2]  # fmt: skip
    edge, thickest, thinnest, opening = np.array(rows).T
    return HemShape(edge, thickest, thinnest, opening)


def find_hemmed(hem: Hem, undeformed: FloatArray, part: IntArray) -> IntArray:
    """Return the nodes of the sheet with the hem, the one that reaches farthest out; part: sheet of each node (n,)."""
    out, _ = _split(hem, undeformed)
    return np.flatnonzero(part == part[np.argmax(out)]).astype(np.int32)


def _split(hem: Hem, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far out points lie, and where along the hem (n,) [mm]."""
    if hem.outward is None:
        radius = np.hypot(points[:, 0], points[:, 1])
        return radius, np.arctan2(points[:, 1], points[:, 0]) * float(radius.max())
    x, y = np.divide(hem.outward, np.hypot(*hem.outward))
    return points[:, 0] * x + points[:, 1] * y, points[:, 1] * x - points[:, 0] * y


def _measure_strip(out: FloatArray, now: FloatArray, z: FloatArray, half: FloatArray) -> tuple[float, ...]:
    """Return the edge, the most and the least thickness, and the opening of a strip.

    out, now: how far out its nodes lie undeformed and at present; z: their height (n,) [mm].
    """
    order = np.argsort(out, kind="stable")
    out, now, z, half = out[order], now[order], z[order], half[order]
    thickness = 2.0 * float(half.mean())
    # 1. the panel's height behind the fold; the edge near it
    inner = np.flatnonzero(now <= now.max() - BEHIND * thickness)
    before = inner[out[inner] < out[int(np.argmax(now))]]
    level = float(z[before[-1]]) if len(before) else float(z[0])
    near = np.abs(z - level) <= NEAR * thickness
    edge = float((now + half)[near].max())
    # 2. the flange beyond the outermost node, without what is bent
    fold = int(np.flatnonzero(near)[np.argmax(now[near])])
    flange = np.arange(len(out)) > fold
    tip, root = int(len(out) - 1), int(np.flatnonzero(flange)[0]) if flange.any() else fold
    length = float(np.hypot(now[tip] - now[root], z[tip] - z[root]))
    flat = flange & (np.hypot(now - now[tip], z - z[tip]) < 0.6 * length)
    if flat.sum() < 2:
        return edge, np.nan, np.nan, 90.0
    along = np.array([now[flat] - now[flat].mean(), z[flat] - z[flat].mean()])
    direction = np.linalg.svd(along, full_matrices=False)[0][:, 0]
    direction *= np.sign(direction @ [now[tip] - now[root], z[tip] - z[root]]) or 1.0
    side = np.sign(float(z[flat].mean()) - level) or 1.0
    opening = float(np.degrees(np.arctan2(side * direction[1], -direction[0])))
    if opening > FOLDED:
        return edge, np.nan, np.nan, opening
    # 3. both sheets and what lies between them
    panel = np.flatnonzero(~flange)
    panel = panel[np.argsort(now[panel], kind="stable")]
    under, under_half = (np.interp(now[flange], now[panel], values[panel]) for values in (z, half))
    height = np.abs(z[flange] - under) + half[flange] + under_half
    return edge, float(height.max()), float(height[flat[flange]].min()), opening


def summarise_hem(formed: HemShape, before: HemShape | None, released: HemShape | None) -> dict[str, Any]:
    """Return the summary of a hem.

    before: as the part came into the operation, None: it was a blank. released: after springback.
    """
    summary: dict[str, Any] = {"formed": formed.to_summary()}
    last = formed if released is None else released
    if released is not None:
        summary["released"] = released.to_summary()
        summary["springback_degrees"] = float(released.opening.mean() - formed.opening.mean())
    if before is not None and len(before.edge) == len(last.edge):
        summary["roll_in_mm"] = _spread(before.edge - last.edge)
    return summary
