# SPDX-License-Identifier: Apache-2.0
"""Whether a converged state is still physics: a list of measures, each of which the case sets a limit on.

Every procedure measures its state after each increment or row of cycles; what happens beyond a limit is decided here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from presswork.fields.formability_fields import Extreme, FormingVerdict
from presswork.model import FloatArray, Limits
from presswork.observe.damage import Peak

LimitName = Literal["penetration", "thinning", "hydrostatic_stress", "mean_pressure"]

REMEDIES: dict[LimitName, str] = {
    "penetration": "refine the mesh where tools are narrow or curved, or shorten the stroke",
    "thinning": "the sheet has torn: ease the draw by radii, friction or holder force, or shorten the stroke",
    "hydrostatic_stress": "shorten the stroke if the die is full or tools have used up the metal between them; else "
    "take an element that does not lock",
    "mean_pressure": "the metal has no way out: shorten the stroke, make the workpiece smaller, or open the die",
}
NEVER_PASSED: tuple[LimitName, ...] = ("mean_pressure",)
"""Limits that stop a run even where the case lets it go on: what follows is a force without bounds."""


FULL = 0.98
"""Part of its wall from which on a die is said to be full."""


@dataclass(frozen=True)
class Measure:
    """How far a state is towards a limit."""

    limit: LimitName
    value: float
    """In the unit of the limit."""
    fact: str
    """In words, with its place."""


@dataclass(frozen=True)
class Watched:
    """Measures of a converged state that limits apply to."""

    measures: tuple[Measure, ...] = ()
    margin: Extreme | None = None
    """The cell with the least margin to the forming limit; None without a curve."""
    damage: tuple[Peak, ...] = ()
    """The largest damage by each criterion."""


def find_breach(limits: Limits, measures: Sequence[Measure]) -> Measure | None:
    """Return the measure farthest beyond its limit, if any is.

    >>> deep = Measure("penetration", 0.8, "a tool has cut 0.8 mm into an edge of 1 mm")
    >>> find_breach(Limits(), [deep]) is deep
    True
    >>> find_breach(Limits(penetration=0.9), [deep])
    """
    beyond = [(m.value / getattr(limits, m.limit), m) for m in measures]
    share, worst = max(beyond, key=lambda pair: pair[0], default=(0.0, None))
    return worst if share > 1.0 else None


def explain_breach(measure: Measure, limits: Limits, row: Mapping[str, Any]) -> str:
    """Say what is beyond which limit, and the remedy. row: of the history; of pressures it tells fill and force."""
    limit = getattr(limits, measure.limit)
    presses = describe_press(row) if measure.limit in ("hydrostatic_stress", "mean_pressure") else ""
    key = f"limits.{measure.limit}={2.0 * measure.value:.2g}" if measure.limit in NEVER_PASSED else "limits.stop=false"
    return (
        f"{measure.fact}{presses}: no longer physics (limits.{measure.limit} = {limit:g}). "
        f"{REMEDIES[measure.limit].capitalize()}. To continue anyway: --set {key}"
    )


def describe_press(row: Mapping[str, Any]) -> str:
    """Say how far dies are filled, and how hard the strongest of the tools that move presses, else of all.

    >>> describe_press({"die.fill": 0.987, "die.force": -3e6, "punch.stroke": 3.0, "punch.force": 2.5e6})
    '; the wall of die is filled to 98.7 %; punch presses with 2.5e+06 N'
    """
    filled = [
        f"; the wall of {k.removesuffix('.fill')} is filled to {100.0 * row[k]:.3g} %"
        for k in row
        if k.endswith(".fill")
    ]
    forces = {name.removesuffix(".force"): abs(float(row[name])) for name in row if name.endswith(".force")}
    moved = {name: force for name, force in forces.items() if row.get(f"{name}.stroke")}
    strongest = max(moved or forces, key=lambda name: forces[name], default=None)
    pressed = "" if strongest is None else f"; {strongest} presses with {forces[strongest]:.4g} N"
    return "".join(filled) + pressed


def explain_full_dies(row: Mapping[str, Any]) -> list[str]:
    """Say which dies are full where a run gives up; row: of the history.

    >>> explain_full_dies({"upper.fill": 0.995, "lower.fill": 0.7})
    ['upper is full (99.5 % of its wall): what is left of the stroke would squeeze out flash']
    """
    full = {name.removesuffix(".fill"): part for name, part in row.items() if name.endswith(".fill") and part >= FULL}
    end = "what is left of the stroke would squeeze out flash"
    return [f"{name} is full ({100.0 * part:.3g} % of its wall): {end}" for name, part in full.items()]


def watch_sheet(verdict: FormingVerdict) -> Watched:
    """Return the measures of a sheet's strains that limits apply to."""
    thinnest = verdict.thinning
    fact = f"the sheet is thinned by {thinnest.value:.1f} % {thinnest.where()}"
    return Watched((Measure("thinning", thinnest.value / 100.0, fact),), verdict.margin)


def measure_sheet_penetration(name: str, depth: float, thickness: float) -> Measure:
    """Return how deep a tool is in a sheet's surface [mm], by its thickness at the start [mm]."""
    fact = f"the tool {name} is {depth:.3g} mm deep in the surface of the sheet of {thickness:g} mm"
    return Measure("penetration", depth / thickness, fact)


def measure_overlap(depth: float, thickness: float) -> Measure:
    """Return by how much two parts of a sheet overlap [mm], by its thickness at the start [mm]."""
    return Measure("penetration", depth / thickness, f"the sheet of {thickness:g} mm overlaps itself by {depth:.3g} mm")


def measure_hydrostatic_stress(stress: FloatArray, flow_stress: FloatArray, centres: FloatArray) -> Measure:
    """Return the largest hydrostatic stress over the flow stress.

    stress, flow_stress: of points (n,) [MPa]; centres: of their cells (n, 2), in space (n, 3) [mm].
    """
    share = np.abs(stress) / np.maximum(flow_stress, 1e-300)
    worst = int(np.argmax(share))
    where = ", ".join(f"{c:.4g}" for c in centres[worst])
    fact = (
        f"the hydrostatic stress is {stress[worst]:.4g} MPa at ({where}) mm, {share[worst]:.3g} times the "
        f"flow stress of {flow_stress[worst]:.4g} MPa"
    )
    return Measure("hydrostatic_stress", float(share[worst]), fact)


def measure_mean_pressure(
    body: str, stress: FloatArray, flow_stress: FloatArray, volume: FloatArray, touched: float | None = None
) -> Measure:
    """Return the mean pressure in a body over its mean flow stress; 0 in tension.

    Where metal can yield its mean pressure is a few times its flow stress: friction hill, flash and extrusion by nine
    tenths stay below ten. Metal that cannot get out answers by its bulk modulus, 3 times its flow stress for every
    per cent of volume in cold steel. stress: mean of the three (n,) [MPa], flow_stress (n,) [MPa], volume (n,) [mm3] of
    points; touched: part of the surface that tools or supports hold, None: unknown.
    """
    pressure, flow = (float((of * volume).sum() / volume.sum()) for of in (-stress, flow_stress))
    share = max(pressure, 0.0) / max(flow, 1e-300)
    held = "" if touched is None else f"; tools and supports hold {100.0 * touched:.3g} % of the surface"
    fact = (
        f"the mean pressure in the {body} is {pressure:.4g} MPa, {share:.3g} times its mean flow stress of "
        f"{flow:.4g} MPa{held}"
    )
    return Measure("mean_pressure", share, fact)
