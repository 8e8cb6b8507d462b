# SPDX-License-Identifier: Apache-2.0
"""Austenite on cooling: ferrite, pearlite and bainite by diffusion, martensite without (docs/theory/microstructure.md).

Diffusion (Kirkaldy & Venugopalan 1984, in the form of Li, Niebuhr, Meekisho & Atteridge 1998): at constant temperature
the part X of what can form has formed after

    t = delay C exp(Q/RT) / (2^(n G) (T_start - T)^m) S(X),   S(X) = int_0^X dx / (x^(0.4 (1-x)) (1-x)^(0.4 x)),

C by composition, G the ASTM grain size. Times add up (Scheil): S grows by dt over the factor before it, so that a step
at constant temperature is exact, however long. Martensite: M = A (1 - exp(-a (Ms - T))) of the austenite A that is left
(Koistinen & Marburger 1959), and never less than it was.

It is a law of points: arrays of any shape, whose owner keeps the fractions and calls `advance` at the end of each step.
"""

from __future__ import annotations

import numpy as np

from presswork.evolution.time_tables import TimeTable
from presswork.model import PHASES, FloatArray, IndexArray, Transformation

GAS_CONSTANT = 1.987
"""[cal/(mol K)]."""
ACTIVATION = 27500.0
"""[cal/mol] of ferrite, pearlite and bainite."""
ZERO_CELSIUS = 273.15
GRAIN, UNDERCOOLING = (0.41, 0.32, 0.29), (3.0, 3.0, 2.0)
"""Exponents n and m of ferrite, pearlite and bainite."""
EUTECTOID = 0.77
"""Mass per cent of carbon in pearlite: no more than 1 - C/0.77 becomes ferrite (lever rule)."""
_TABLE = 2001
_SOLVING = 8
"""Newton's corrections that find a place of the table by S, to the last digit."""


def find_factors(composition: dict[str, float]) -> tuple[float, float, float]:
    """Return C of ferrite, pearlite and bainite [s K^m] for mass per cents by element.

    >>> [round(c, 4) for c in find_factors({"C": 0.2})]
    [9.6023, 0.0325, 0.0003]
    """
    c, mn, si, ni, cr, mo = (composition.get(e, 0.0) for e in ("C", "Mn", "Si", "Ni", "Cr", "Mo"))
    ferrite = np.exp(1.0 + 6.31 * c + 1.78 * mn + 0.31 * si + 1.12 * ni + 2.7 * cr + 4.06 * mo)
    pearlite = np.exp(-4.25 + 4.12 * c + 4.36 * mn + 0.44 * si + 1.71 * ni + 3.33 * cr + 5.19 * np.sqrt(mo))
    bainite = np.exp(-10.23 + 10.18 * c + 0.85 * mn + 0.55 * ni + 0.9 * cr + 0.36 * mo)
    return float(ferrite), float(pearlite), float(bainite)


class _Progress:
    """S(X) and its inverse: cubic Hermite polynomials in u, X = sin^2(u/2), in which the integrand is bounded.

    Derivatives of runs ask for a smooth law: straight lines between the values would have a corner at each of them.
    """

    def __init__(self) -> None:
        self._width = np.pi / (_TABLE - 1)
        knots: FloatArray = self._width * np.arange(_TABLE, dtype=float)
        self._slope = self._width * np.concatenate([[0.0], _integrand(knots[1:-1]), [0.0]])
        gauss = 0.5 * self._width * (1.0 + np.array([-1.0, 1.0]) / 3.0**0.5)
        parts = 0.5 * self._width * _integrand(knots[:-1, None] + gauss).sum(axis=1)
        self._value = np.concatenate([[0.0], np.cumsum(parts)])

    def at(self, part: FloatArray) -> FloatArray:
        """Return S at parts X (n,)."""
        u = 2.0 * np.arcsin(np.sqrt(part)) / self._width
        i = np.minimum(u.astype(np.intp), _TABLE - 2)
        return self._evaluate(i, u - i)[0]

    def part(self, progress: FloatArray) -> FloatArray:
        """Return X at S (n,); one beyond the table."""
        i = np.clip(np.searchsorted(self._value, progress, side="right") - 1, 0, _TABLE - 2)
        t = np.clip((progress - self._value[i]) / (self._value[i + 1] - self._value[i]), 0.0, 1.0)
        for _ in range(_SOLVING):
            value, slope = self._evaluate(i, t)
            t = np.clip(t - (value - progress) / np.maximum(slope, 1e-300), 0.0, 1.0)
        return np.asarray(np.sin(0.5 * self._width * (i + t)) ** 2)

    def _evaluate(self, i: IndexArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return value and slope in intervals i (n,) at t from 0 to 1 (n,)."""
        first, rise = self._value[i], self._value[i + 1] - self._value[i]
        left, right = self._slope[i], self._slope[i + 1]
        square, cube = 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise
        return first + t * (left + t * (square + t * cube)), left + t * (2.0 * square + 3.0 * t * cube)


def _integrand(u: FloatArray) -> FloatArray:
    """Return dS/du."""
    x = np.sin(0.5 * u) ** 2
    return np.asarray(0.5 * np.sin(u) / (x ** (0.4 * (1 - x)) * (1 - x) ** (0.4 * x)))


class Kinetics:
    """The transformations of one steel, at any number of points."""

    def __init__(self, steel: Transformation) -> None:
        self._steel = steel
        self._progress = _Progress()
        self._latent = np.array(steel.latent_heat)
        self._starts = (steel.ferrite_start, steel.pearlite_start, steel.bainite_start)
        factors = find_factors(dict(steel.composition))
        self._times = tuple(
            d * c / 2.0 ** (n * steel.grain_size) for d, c, n in zip(steel.delay, factors, GRAIN, strict=True)
        )
        self._tables = {PHASES.index(name): TimeTable(rows) for name, rows in steel.times.items()}
        self._most_ferrite = max(0.0, 1.0 - steel.composition.get("C", 0.0) / EUTECTOID)

    def at_rest(self, shape: tuple[int, ...]) -> FloatArray:
        """Return the fractions of austenite alone (4, *shape)."""
        return np.zeros((4, *shape))

    def advance(self, fractions: FloatArray, temperature: FloatArray, dt: float) -> FloatArray:
        """Return the fractions after dt [s] at temperatures (...) [degrees C]: those of diffusion have grown.

        fractions (4, ...) in the order of PHASES.
        """
        if self._tables:
            return self._advance_by_tables(fractions, temperature, dt)
        after = fractions.copy()
        if not self._steel.composition:
            return after
        austenite = 1.0 - fractions.sum(axis=0)
        room = austenite.copy()
        for i, (start, time, power) in enumerate(zip(self._starts, self._times, UNDERCOOLING, strict=True)):
            forms = (temperature < start) & (austenite > 0.0) & (temperature > self._steel.martensite_start)
            if i < 2:
                forms &= temperature > self._starts[2]
            if not forms.any():
                continue
            now, own = temperature[forms], fractions[i][forms]
            rate = (start - now) ** power * np.exp(-ACTIVATION / (GAS_CONSTANT * (now + ZERO_CELSIUS))) / time
            capacity = own + austenite[forms]
            if i == 0:
                capacity = np.minimum(capacity, self._most_ferrite)
            part = np.clip(own / np.maximum(capacity, 1e-300), 0.0, 1.0)
            gone = self._progress.at(part) + dt * rate
            grown = np.maximum(self._progress.part(gone) * capacity - own, 0.0)
            grown = np.minimum(grown, room[forms])
            after[i][forms] += grown
            room[forms] -= grown
        return after

    def _advance_by_tables(self, fractions: FloatArray, temperature: FloatArray, dt: float) -> FloatArray:
        after, austenite = fractions.copy(), 1.0 - fractions.sum(axis=0)
        room = austenite.copy()
        for i, table in self._tables.items():
            forms = table.forms(temperature) & (austenite > 0.0) & (temperature > self._steel.martensite_start)
            now, own = temperature[forms], fractions[i][forms]
            capacity = np.maximum((own + austenite[forms]) * table.most(now), 1e-300)
            part = table.advance(np.clip(own / capacity, 0.0, 1.0), now, dt)
            grown = np.clip(part * capacity - own, 0.0, room[forms])
            after[i][forms] += grown
            room[forms] -= grown
        return after

    def martensite(self, fractions: FloatArray, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the martensite at temperatures (...), and its derivative by them [1/K]; fractions: before."""
        free = 1.0 - fractions[:3].sum(axis=0)
        below = self._steel.martensite_start - temperature
        left = np.exp(-self._steel.martensite_rate * np.maximum(below, 0.0))
        formed = free * (1.0 - left)
        grows = (below > 0.0) & (formed >= fractions[3])
        slope = np.where(grows, -self._steel.martensite_rate * free * left, 0.0)
        return np.where(grows, formed, fractions[3]), slope

    def heat_of(self, fractions: FloatArray) -> FloatArray:
        """Return the heat per mass that fractions (4, ...) have set free as they formed (...) [mm2/s2]."""
        return np.asarray(np.tensordot(self._latent, fractions, axes=1))

    @property
    def martensite_law(self) -> tuple[float, float]:
        """Its start [degrees C] and rate [1/K]."""
        return self._steel.martensite_start, self._steel.martensite_rate

    @property
    def heat_of_martensite(self) -> float:
        """Heat per mass that martensite sets free [mm2/s2]."""
        return float(self._latent[3])
