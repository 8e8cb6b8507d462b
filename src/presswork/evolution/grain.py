# SPDX-License-Identifier: Apache-2.0
"""Grain size of austenite in hot forming: dynamic, metadynamic and static recrystallisation, grain growth.

Fractions follow Johnson, Mehl, Avrami and Kolmogorov's law, sizes and kinetics power laws of Sellars' form (Sellars &
Whiteman 1979), with d0 the grain size when the deformation began, e the strain since then, r its rate, Q an energy:

    value = A d0^a e^b r^c exp(Q/(R T))                                                     (model.PowerLaw)
    dynamic      X = 1 - exp(-ln 2 ((e - ec)/e05)^k), e > ec
    post         X = 1 - exp(-ln 2 (t/t05)^k); metadynamic where it has begun dynamically, static elsewhere
    growth       d^m = d_n^m + A exp(-Q/(R T)) dt, where little is left to recrystallise

Where conditions change, a fraction goes on from the strain, or time, that it would have taken under the new ones to
come so far (additivity, Scheil 1935). Mixtures of grains have the mean size by volume. When a point is deformed again,
its mean grain is the new d0, and of the strain the part 1 - X is retained.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from presswork.evolution.contract import EvolutionLaw, PointChange, Quantity
from presswork.model import ZERO_CELSIUS, BoolArray, FloatArray, Grain, PowerLaw, Recrystallisation

GAS = 8.314462618
"""[J/(mol K)] (CODATA 2018)."""
LN2 = float(np.log(2.0))
COMPLETE = 0.95
"""Fraction from which grains grow: Sellars & Whiteman's."""
NEW_STRAIN, SLOW = 1e-3, 0.05
"""A point is deformed where an increment has more strain than this, or a rate above this part of the mean rate so far.
What is less, as stresses relax in a pause, is none."""
SIZE, FRACTION, TOTAL = "grain_size", "recrystallised_fraction", "total_plastic_strain"
QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        Quantity(SIZE, "um", lowest=0.0, label="mean grain size"),
        Quantity(FRACTION, "1", lowest=0.0, highest=1.0, label="recrystallised fraction"),
        Quantity(TOTAL, "1", lowest=0.0, label="total plastic strain"),
        Quantity("grain_parent", "um", lowest=0.0, shown=False),
        Quantity("grain_strain", "1", lowest=0.0, shown=False),
        Quantity("grain_rate", "1/s", lowest=0.0, shown=False),
        Quantity("grain_dynamic_fraction", "1", lowest=0.0, highest=1.0, shown=False),
        Quantity("grain_dynamic_size", "um", lowest=0.0, shown=False),
        Quantity("grain_formed_size", "um", lowest=0.0, shown=False),
        Quantity("grain_post_fraction", "1", lowest=0.0, highest=1.0, shown=False),
    )
}
"""What is kept: shown are the mean size, the fraction since the last deformation began, and the strain in all; then d0,
the strain e and its mean rate, the dynamic fraction and its size, the mean size at the end of the deformation, and the
fraction recrystallised after it."""


class GrainLaw(EvolutionLaw):
    """Grain size of one material."""

    follows_time = True

    def __init__(self, grain: Grain) -> None:
        self._grain = grain
        self.quantities = tuple(QUANTITIES.values())
        self.softens = grain.softens

    def at_rest(self) -> dict[str, float]:
        """Return the values at the start of a run by name."""
        sizes = dict.fromkeys((SIZE, "grain_parent", "grain_dynamic_size", "grain_formed_size"), self._grain.initial)
        return {**super().at_rest(), **sizes}

    def advance(self, values: Mapping[str, FloatArray], change: PointChange) -> dict[str, FloatArray]:
        """Return the values at the end of an increment."""
        found = {name: values[name].copy() for name in QUANTITIES}
        found[TOTAL] += np.maximum(change.strain, 0.0)
        if change.temperature is not None and change.temperature_n is not None:
            kelvin = 0.5 * (change.temperature + change.temperature_n) + ZERO_CELSIUS
        elif self._grain.temperature is not None:
            kelvin = np.full_like(change.strain, self._grain.temperature + ZERO_CELSIUS)
        else:  # a part that springs back: cold, as it were
            return found
        if change.dt <= 0.0:
            return found
        flows = (change.parts * change.strain > NEW_STRAIN) | (change.rate > SLOW * found["grain_rate"])
        self._deform(found, flows, change.strain, change.dt, kelvin)
        self._rest(found, ~flows, change.dt, kelvin)
        return found

    def hardening_strain(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Return the strain that hardens, that of what is not recrystallised (n,)."""
        return (1.0 - values[FRACTION]) * values["grain_strain"]

    def _deform(
        self, v: dict[str, FloatArray], flows: BoolArray, strain: FloatArray, dt: float, kelvin: FloatArray
    ) -> None:
        """Advance the points that flow."""
        # 1. a deformation begins anew where there was a pause: mean grain, retained strain
        anew = flows & (v["grain_post_fraction"] > 0.0)
        v["grain_parent"][anew] = v[SIZE][anew]
        v["grain_strain"][anew] *= 1.0 - v[FRACTION][anew]
        for name in ("grain_dynamic_fraction", "grain_post_fraction"):
            v[name][anew] = 0.0
        # 2. the strain, and its mean rate
        own, added = np.flatnonzero(flows), strain[flows]
        before = v["grain_strain"][own]
        after = before + added
        v["grain_rate"][own] = (v["grain_rate"][own] * before + added / dt * added) / after
        v["grain_strain"][own] = after
        # 3. dynamic recrystallisation beyond the critical strain
        parent, rate, warm, x_n = v["grain_parent"][own], added / dt, kelvin[own], v["grain_dynamic_fraction"][own]
        x = x_n
        if (law := self._grain.dynamic) is not None:
            critical = evaluate(law.critical_strain, parent, after, rate, warm)
            half = evaluate(law.half_strain, parent, after, rate, warm)
            x = go_on(x_n, np.clip(after - critical, 0.0, added), half, law.exponent)
            grown = evaluate(law.size, parent, after, rate, warm)
            size_n = v["grain_dynamic_size"][own]
            v["grain_dynamic_size"][own] = np.where(
                x > x_n, (x_n * size_n + (x - x_n) * grown) / np.maximum(x, 1e-300), size_n
            )
        v["grain_dynamic_fraction"][own] = v[FRACTION][own] = x
        v[SIZE][own] = v["grain_formed_size"][own] = x * v["grain_dynamic_size"][own] + (1.0 - x) * parent

    def _rest(self, v: dict[str, FloatArray], rests: BoolArray, dt: float, kelvin: FloatArray) -> None:
        """Advance the points that do not flow: recrystallisation after the deformation, then growth."""
        by_dynamic = rests & (v["grain_dynamic_fraction"] > 0.0)
        by_static = rests & (v["grain_dynamic_fraction"] == 0.0) & (v["grain_strain"] > 0.0)
        self._recrystallise(v, by_dynamic, self._grain.metadynamic, dt, kelvin)
        self._recrystallise(v, by_static, self._grain.static, dt, kelvin)
        if (law := self._grain.growth) is not None:
            done = rests & ((v["grain_strain"] == 0.0) | (v["grain_post_fraction"] >= COMPLETE))
            rise = law.A * np.exp(-law.energy / (GAS * kelvin[done])) * dt
            v[SIZE][done] = (v[SIZE][done] ** law.exponent + rise) ** (1.0 / law.exponent)

    @staticmethod
    def _recrystallise(
        v: dict[str, FloatArray], own: BoolArray, law: Recrystallisation | None, dt: float, kelvin: FloatArray
    ) -> None:
        if law is None or not own.any():
            return
        given = v["grain_parent"][own], v["grain_strain"][own], v["grain_rate"][own], kelvin[own]
        x_n = v["grain_post_fraction"][own]
        x = go_on(x_n, np.full_like(x_n, dt), evaluate(law.half_time, *given), law.exponent)
        size = evaluate(law.size, *given)
        v["grain_post_fraction"][own] = x
        v[FRACTION][own] = 1.0 - (1.0 - v["grain_dynamic_fraction"][own]) * (1.0 - x)
        mixed = x * size + (1.0 - x) * v["grain_formed_size"][own]
        v[SIZE][own] = np.where(x_n < COMPLETE, mixed, v[SIZE][own])


def evaluate(law: PowerLaw, grain: FloatArray, strain: FloatArray, rate: FloatArray, kelvin: FloatArray) -> FloatArray:
    """Return A d0^a e^b r^c exp(Q/(R T)) of points (n,)."""
    value = law.A * grain**law.grain * rate**law.rate * np.exp(law.energy / (GAS * kelvin))
    return np.asarray(value * strain**law.strain)


def go_on(fraction: FloatArray, step: FloatArray, half: FloatArray, exponent: float) -> FloatArray:
    """Return a fraction (n,) after a step of strain or time, with `half` for the first half.

    The step is added to what would have been needed under the present conditions to come so far.

    >>> import numpy as np
    >>> x = go_on(np.zeros(1), np.array([2.0]), np.array([2.0]), 3.0)
    >>> float(round(x[0], 12))
    0.5
    """
    left = np.maximum(1.0 - fraction, 1e-300)
    equivalent = half * (-np.log(left) / LN2) ** (1.0 / exponent)
    reached = np.where(step > 0.0, ((equivalent + step) / half) ** exponent, -np.log(left) / LN2)
    return np.asarray(np.where(step > 0.0, -np.expm1(-LN2 * reached), fraction))
