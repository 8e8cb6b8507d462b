# SPDX-License-Identifier: Apache-2.0
"""Whether a converged state is still physics: a list of measures, each of which the case sets a limit on.

Every procedure measures its state after each increment or row of cycles; what happens beyond a limit is decided here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswork.fields.formability_fields import Extreme, FormingVerdict
from presswork.model import FloatArray, Limits
from presswork.process.peaks import Peak

LimitName = Literal["penetration", "thinning", "hydrostatic_stress"]

REMEDIES: dict[LimitName, str] = {
    "penetration": "refine the mesh where tools are narrow or curved, or shorten the stroke",
    "thinning": "the sheet has torn: ease the draw by radii, friction or holder force, or shorten the stroke",
    "hydrostatic_stress": "shorten the stroke if the die is full; else take an element that does not lock",
}


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


def explain_breach(measure: Measure, limits: Limits) -> str:
    """Say what is beyond which limit, and the remedy."""
    limit = getattr(limits, measure.limit)
    return (
        f"{measure.fact}: no longer physics (limits.{measure.limit} = {limit:g}). "
        f"{REMEDIES[measure.limit].capitalize()}. To go on all the same: --set limits.stop=false"
    )


def watch_sheet(verdict: FormingVerdict) -> Watched:
    """Return the measures of a sheet's strains that limits apply to."""
    thinnest = verdict.thinning
    fact = f"the sheet is thinned by {thinnest.value:.1f} % {thinnest.where()}"
    return Watched((Measure("thinning", thinnest.value / 100.0, fact),), verdict.margin)


def measure_sheet_penetration(name: str, depth: float, thickness: float) -> Measure:
    """Return how deep a tool is in a sheet's surface [mm], by its thickness at the start [mm]."""
    fact = f"the tool {name} is {depth:.3g} mm deep in the surface of the sheet of {thickness:g} mm"
    return Measure("penetration", depth / thickness, fact)


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
