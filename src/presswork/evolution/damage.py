# SPDX-License-Identifier: Apache-2.0
"""Damage: criteria of ductile fracture, accumulated along the path of every point (cpp/material/damage.hpp).

The integral over the equivalent plastic strain is taken by the trapezoidal rule within each increment; in the increment
in which a point flows for the first time, by the stress at its end.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from presswork import _core
from presswork.evolution.contract import EvolutionLaw, PointChange, Quantity
from presswork.model import Damage, FloatArray

UNITS = {"freudenthal": "MPa"}
"""Units of criteria that are no pure numbers."""
LABELS = {
    "cockcroft_latham": "Cockcroft-Latham damage",
    "rice_tracey": "Rice-Tracey damage",
    "oyane": "Oyane damage",
    "freudenthal": "Freudenthal damage",
    "johnson_cook": "Johnson-Cook damage",
}
QUANTITIES = {
    name: Quantity(f"damage_{name}", UNITS.get(name, "1"), lowest=0.0, label=label) for name, label in LABELS.items()
}
"""What each criterion keeps."""


class DamageLaw(EvolutionLaw):
    """Damage by one criterion."""

    def __init__(self, damage: Damage) -> None:
        quantity = QUANTITIES[damage.criterion]
        self.quantities = (quantity,)
        if damage.critical is not None:
            self.critical = {quantity.name: damage.critical}
        self._kernel = _core.Damage(_core.DamageCriterion[damage.criterion], dict(damage.parameters))

    def advance(self, values: Mapping[str, FloatArray], change: PointChange) -> dict[str, FloatArray]:
        """Return the damage at the end of an increment."""
        name = self.quantities[0].name
        arrays = (values[name], change.stress_n, change.stress, change.eqps_n, change.eqps)
        warm = None if change.temperature is None else np.ascontiguousarray(change.temperature)
        return {name: self._kernel.advance(*map(np.ascontiguousarray, arrays), dt=change.dt, temperature=warm)}
