# SPDX-License-Identifier: Apache-2.0
"""Evolution laws that follow time take an increment in as many equal parts as their error asks for
(docs/theory/time_steps.md): stress, strain and temperature change evenly within it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from presswork.evolution.contract import EvolutionLaw, PointChange
from presswork.model import FloatArray

MOST = 32
"""Parts that are tried last."""


def advance_in_parts(
    law: EvolutionLaw, values: Mapping[str, FloatArray], change: PointChange, tolerance: float
) -> dict[str, FloatArray]:
    """Return the values at the end of an increment (n,) by name; those of its start are not written to.

    Parts are halved until what the law shows changes by no more than the tolerance: of 1, or of larger values.
    """
    found, parts = law.advance(values, change), 1
    if not law.follows_time or change.dt <= 0.0:
        return found
    while parts < MOST:
        parts *= 2
        before, found = found, _advance(law, values, change, parts)
        shown = [quantity.name for quantity in law.quantities if quantity.shown]
        if max((_differ(before[name], found[name]) for name in shown), default=0.0) <= tolerance:
            break
    return found


def _advance(
    law: EvolutionLaw, values: Mapping[str, FloatArray], change: PointChange, parts: int
) -> dict[str, FloatArray]:
    now = dict(values)
    for k in range(parts):
        now = law.advance(now, _take_part(change, k, parts))
    return now


def _take_part(change: PointChange, k: int, parts: int) -> PointChange:
    """Return the part k of an increment."""

    def at(before: FloatArray, after: FloatArray, share: float) -> FloatArray:
        return (1.0 - share) * before + share * after

    ends = k / parts, (k + 1) / parts
    stress, eqps = (
        [at(a, b, s) for s in ends] for a, b in ((change.stress_n, change.stress), (change.eqps_n, change.eqps))
    )
    degrees: list[FloatArray | None] = [change.temperature_n, change.temperature]
    if change.temperature_n is not None and change.temperature is not None:
        degrees = [at(change.temperature_n, change.temperature, s) for s in ends]
    return replace(
        change, stress_n=stress[0], stress=stress[1], eqps_n=eqps[0], eqps=eqps[1], dt=change.dt / parts,
        temperature_n=degrees[0], temperature=degrees[1], parts=parts,
    )  # fmt: skip


def _differ(first: FloatArray, second: FloatArray) -> float:
    """Return the mean difference of two arrays, over 1 or their mean where that is more."""
    if not len(second):
        return 0.0
    return float(np.sqrt(np.mean((second - first) ** 2))) / max(1.0, float(np.sqrt(np.mean(second**2))))
