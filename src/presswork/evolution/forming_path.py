# SPDX-License-Identifier: Apache-2.0
"""How near a layer of a sheet has come to its forming limit along its own path, in stresses and in plastic strain.

A forming limit curve holds for straight paths. On a straight path whose plastic strain rate has the principal values
e1 >= e2 per unit of equivalent plastic strain p, the curve is met at p* = e1*(e2/e1) / e1. The polar limit (Stoughton &
Yoon 2012) takes p* for any path: it depends on the direction of the present plastic strain rate alone, and p is all the
plastic strain so far. The limit in stresses (Arrieux 1982; Stoughton 2000) is the flow stress at p*. The margins are
1 - p/p* and 1 - f(stress)/Y(p*); with isotropic hardening f(stress) is Y(p), and both are zero at once.

Where a path turns without unloading, the stress runs along the yield surface, and the direction passes what lies
between. A neck does not form in so little strain: 1/p* is averaged over the last MEMORY of plastic strain, with weights
that decay exponentially. On a straight path that changes nothing.

A sheet necks when all its layers have reached their limits at the same time (Stoughton & Yoon 2011). Over a radius one
face is beyond its limit while the other is compressed, and the reverse holds where the sheet is straightened again:
neither necks it. So in every increment a place has the margin of its best layer, one that does not flow the whole of
it, and the least of these so far is kept.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from presswork.evolution.contract import EvolutionLaw, PointChange, Quantity
from presswork.formability import POLAR, STRESS, FormingLimitCurve
from presswork.law.elastic_plastic import (
    depends_on_rate,
    depends_on_temperature,
    make_sheet_law,
    make_yield_function,
)
from presswork.model import FloatArray, Material

MEMORY = 0.01
"""Equivalent plastic strain over which the limit follows a change of direction."""
FARTHEST = 3.0
"""Equivalent plastic strain beyond which no limit in stresses is looked for."""
FLOWS = 0.9
"""Share of the flow stress below which a stress at the end of a row of explicit cycles does not show flow."""
SHARE = "forming_limit_share"
QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        Quantity(POLAR, "1", start=1.0, highest=1.0, label="least margin to the polar forming limit", all_layers=True),
        Quantity(
            STRESS, "1", start=1.0, highest=1.0, label="least margin to the forming limit in stresses", all_layers=True
        ),
        Quantity(SHARE, "1", start=-1.0, shown=False),
    )
}
"""What is kept; last 1/p* as it is averaged, negative before a layer first flows."""


class FormingPath(EvolutionLaw):
    """The forming limit of one material along the paths of its layers."""

    def __init__(self, material: Material, curve: FormingLimitCurve) -> None:
        self._curve = curve
        self._function = make_yield_function(material.yield_function)
        self._law = make_sheet_law(material)
        names = (POLAR, STRESS, SHARE) if has_stress_limit(material) else (POLAR, SHARE)
        self.quantities = tuple(QUANTITIES[name] for name in names)

    def advance(self, values: Mapping[str, FloatArray], change: PointChange) -> dict[str, FloatArray]:
        """Return the least margins at the end of an increment."""
        found = {name: old.copy() for name, old in values.items()}
        flows = np.flatnonzero(change.strain > 0.0)
        if len(flows) == 0:
            return found
        stress, p, grown = change.stress[flows], change.eqps[flows], change.strain[flows]
        active = stress if change.back_stress is None else stress - change.back_stress[flows]
        size, normal, _ = self._function.evaluate(np.ascontiguousarray(active))
        telling = size > 0.0
        if STRESS in values:
            telling = size >= FLOWS * self._law.flow_stress(np.ascontiguousarray(p))[0]
        flows, p, grown, size = flows[telling], p[telling], grown[telling], size[telling]

        share = self._find_share(normal[telling])
        before = values[SHARE][flows]
        mean = share + np.where(before < 0.0, 0.0, np.exp(-grown / MEMORY)) * (before - share)
        found[SHARE][flows] = mean
        share = np.minimum(share, mean)  # a layer that is compressed now does not neck, whatever it remembers
        found[POLAR] = _keep_least(found[POLAR], 1.0 - p * share, flows, change.layers)
        if STRESS in values:
            limit = self._law.flow_stress(1.0 / np.maximum(share, 1.0 / FARTHEST))[0]
            found[STRESS] = _keep_least(found[STRESS], 1.0 - size / limit, flows, change.layers)
        return found

    def _find_share(self, normal: FloatArray) -> FloatArray:
        """Return 1/p* of plastic strain rates xx, yy, xy (engineering shear) per unit of p (n, 3)."""
        mean, half = 0.5 * (normal[:, 0] + normal[:, 1]), 0.5 * (normal[:, 0] - normal[:, 1])
        radius = np.hypot(half, 0.5 * normal[:, 2])
        major, minor = mean + radius, mean - radius
        stretched = major > 0.0
        ratio = np.divide(minor, major, out=np.full_like(minor, -np.inf), where=stretched)
        return np.where(stretched, major / self._curve.meet(np.where(stretched, ratio, 0.0)), 0.0)


def _keep_least(before: FloatArray, margin: FloatArray, flows: NDArray[np.intp], layers: int) -> FloatArray:
    """Return the least margin of all points (n,), by those of the points that flow now, the best layer's of a place."""
    now = np.ones_like(before)
    now[flows] = margin
    best = now.reshape(-1, layers).max(axis=1)
    least: FloatArray = np.minimum(before, np.repeat(best, layers))
    return least


def has_stress_limit(material: Material) -> bool:
    """Return whether a material's flow stress depends on plastic strain alone, so that stresses have one limit."""
    return material.kinematic is None and not depends_on_rate(material) and not depends_on_temperature(material)


def make_forming_path(material: Material) -> tuple[FormingPath, ...]:
    """Return the law of a sheet with a forming limit; none without one."""
    curve = material.formability.curve
    return () if curve is None or material.umat is not None else (FormingPath(material, curve),)
