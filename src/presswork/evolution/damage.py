# SPDX-License-Identifier: Apache-2.0
"""Damage: criteria of ductile fracture, accumulated along the path of every point (cpp/material/damage.hpp).

The integral over the equivalent plastic strain is taken by the trapezoidal rule within each increment; in the increment
in which a point flows for the first time, by the stress at its end.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from presswork import _core
from presswork.evolution.contract import EvolutionLaw, PointChange, Quantity
from presswork.model import Damage, FloatArray, Umat

UNITS = {"freudenthal": "MPa"}
"""Units of criteria that are no pure numbers."""
LABELS = {
    "cockcroft_latham": "Cockcroft-Latham damage",
    "rice_tracey": "Rice-Tracey damage",
    "oyane": "Oyane damage",
    "freudenthal": "Freudenthal damage",
    "johnson_cook": "Johnson-Cook damage",
    "modified_mohr_coulomb": "modified Mohr-Coulomb damage",
    "hosford_coulomb": "Hosford-Coulomb damage",
    "bai_wierzbicki": "Bai-Wierzbicki damage",
}
QUANTITIES = {
    name: Quantity(f"damage_{name}", UNITS.get(name, "1"), lowest=0.0, label=label, peak_counts=True)
    for name, label in LABELS.items()
}
"""What each criterion keeps."""


DEFAULT: Final = "cockcroft_latham"
"""Criterion that solids have without being asked."""


class DamageLaw(EvolutionLaw):
    """Damage by one criterion."""

    def __init__(self, damage: Damage) -> None:
        quantity = QUANTITIES[damage.criterion]
        self.name, self.quantities = quantity.name, (quantity,)
        if damage.critical is not None:
            self.critical = {quantity.name: damage.critical}
        self.kernel = _core.Damage(_core.DamageCriterion[damage.criterion], dict(damage.parameters))

    def advance(self, values: Mapping[str, FloatArray], change: PointChange) -> dict[str, FloatArray]:
        """Return the damage at the end of an increment."""
        arrays = (values[self.name], change.stress_n, change.stress, change.eqps_n, change.eqps)
        warm = None if change.temperature is None else np.ascontiguousarray(change.temperature)
        return {self.name: self.kernel.advance(*map(np.ascontiguousarray, arrays), dt=change.dt, temperature=warm)}


def make_damage(chosen: Damage | None, umat: Umat | None, *, is_solid: bool) -> tuple[DamageLaw, ...]:
    """Return the criteria of a material: the chosen one, and in solids the default, if plastic strain is known."""
    if umat is not None and umat.plastic_strain == 0:
        return ()
    wanted = [Damage(DEFAULT)] if is_solid and (chosen is None or chosen.criterion != DEFAULT) else []
    wanted += [chosen] if chosen is not None else []
    return tuple(DamageLaw(damage) for damage in wanted)
