# SPDX-License-Identifier: Apache-2.0
"""Phases of a steel at the points of a body: what austenite becomes as it cools (kinetics.py), and how hard it is.

As an evolution law it follows the temperatures that a body has, after each increment, and gives no heat back.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from presswork.evolution.contract import EvolutionLaw, PointChange, Quantity
from presswork.evolution.hardness import HARDNESS_AT, find_hardness
from presswork.evolution.kinetics import Kinetics
from presswork.model import PHASES, FloatArray, Transformation

COOLING_RATE = Quantity("cooling_rate", "K/s", lowest=0.0, label="cooling rate at 700 degrees C")
HARDNESS = Quantity("hardness", "HV", lowest=0.0)
QUANTITIES = (*(Quantity(name, "1", lowest=0.0, highest=1.0) for name in PHASES), COOLING_RATE, HARDNESS)


class PhaseLaw(EvolutionLaw):
    """Phases, cooling rate and hardness of one steel."""

    follows_time = True

    def __init__(self, steel: Transformation) -> None:
        self._kinetics, self._composition, self._hardness = Kinetics(steel), steel.composition, steel.hardness
        self.quantities = QUANTITIES if steel.composition or steel.hardness else QUANTITIES[:-1]

    def advance(self, values: Mapping[str, FloatArray], change: PointChange) -> dict[str, FloatArray]:
        """Return the values at the end of an increment: those of before where no temperature is known."""
        if change.temperature is None or change.temperature_n is None or change.dt <= 0.0:
            return {quantity.name: values[quantity.name] for quantity in self.quantities}
        before, after = change.temperature_n, change.temperature
        fractions = np.stack([values[name] for name in PHASES])
        fractions = self._kinetics.advance(fractions, before, change.dt)
        fractions[3], _ = self._kinetics.martensite(fractions, after)
        passed = (before > HARDNESS_AT) & (after <= HARDNESS_AT)
        rate = np.where(passed, (before - after) / change.dt, values[COOLING_RATE.name])
        found = dict(zip(PHASES, fractions, strict=True)) | {COOLING_RATE.name: rate}
        if self._hardness:
            shares = np.concatenate([1.0 - fractions.sum(axis=0, keepdims=True), fractions])
            found[HARDNESS.name] = np.asarray(np.tensordot(self._hardness, shares, axes=1))
        elif self._composition:
            found[HARDNESS.name] = find_hardness(self._composition, fractions, rate)
        return found
