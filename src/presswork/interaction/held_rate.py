# SPDX-License-Identifier: Apache-2.0
"""A pressure that holds the strain rate of the sheet at a target, between limits, as gas does in superplastic forming.

In an increment of dt the sheet gets the strain e (mesh/membrane_strain.py). From p_n before, the pressure is

    p = p_n (1 + G (1 - e/(target dt)))

between its limits. G is large, so that e stays near target dt whatever the law; dp/dx couples all nodes under the
pressure with those of the cells whose strain is held. Near equilibrium a limit holds p where it would lie beyond, once
in an increment, and releases it once. At the start, below its lower limit, p rises to that evenly in a strain of R
whatever the rate: a flat sheet has no strain to go by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.mesh.membrane_strain import find_strain_gradients, find_strains
from presswork.mesh.pressed_cells import find_area_vectors
from presswork.model import FloatArray, HeldRate, IntArray

GAIN = 50.0
"""The rate is off its target by a 50th of the relative change of the pressure in an increment."""
RISE = 0.001
"""R: strain at the target in which the pressure rises to its lower limit."""
CHANGES = 2
"""Most times that limits hold a pressure or release it in an increment."""


@dataclass(frozen=True)
class LedPressure:
    """The pressure that follows from a strain at a guess, whatever its limits."""

    value: float
    """[MPa]"""
    slope: FloatArray
    """Its derivative by the positions (n_points, 3) [MPa/mm]."""


class RateHold:
    """Whether limits hold a pressure in an increment."""

    def __init__(self, goal: HeldRate, p_n: float, rate_n: float, dt: float) -> None:
        """p_n, rate_n: pressure [MPa] and strain rate [1/s] at the start of the increment; dt: [s]."""
        self._goal, self._changes = goal, 0
        self.given: float | None = None
        """Pressure at which it is held [MPa]; None: the strain rate leads it."""
        self.is_rising = p_n < goal.least
        if self.is_rising:
            self.given = min(p_n + goal.least * goal.target * dt / RISE, goal.least)
        elif p_n >= goal.most and rate_n <= goal.target:
            self.given = goal.most
        elif p_n <= goal.least and rate_n > goal.target:
            self.given = goal.least

    def update(self, led: float) -> int:
        """Hold or release a pressure that the rate would lead to a value near equilibrium [MPa]; return the changes."""
        goal = self._goal
        if self.is_rising or self._changes == CHANGES:
            return 0
        within = min(max(led, goal.least), goal.most)
        wanted = None if within == led else within
        if wanted == self.given:
            return 0
        self.given = wanted
        self._changes += 1
        return 1


def lead_pressure(
    goal: HeldRate, p_n: float, before: FloatArray, now: FloatArray, cells: IntArray, *, fastest: int, dt: float
) -> LedPressure:
    """Return the pressure to which the strain leads at a guess.

    p_n: at the start of the increment [MPa]. before, now: positions (n_points, 3) [mm]; cells (n, 4): those that it
    presses; fastest: number among them of the one that was strained fastest, -1: it is sought; dt: [s].
    """
    if goal.of == "mean":
        own, weight = np.arange(len(cells)), _weigh(before, cells)
    else:
        own = np.array([fastest if fastest >= 0 else int(np.argmax(find_strains(before, now, cells)))])
        weight = np.ones(1)
    strain, gradient = find_strain_gradients(before, now, cells[own])
    gain, slope = GAIN * p_n / (goal.target * dt), np.zeros_like(now)
    np.add.at(slope, cells[own], -gain * weight[:, None, None] * gradient)
    return LedPressure(p_n * (1.0 + GAIN) - gain * float(weight @ strain), slope)


def measure_rate(goal: HeldRate, before: FloatArray, now: FloatArray, cells: IntArray, dt: float) -> tuple[int, float]:
    """Return the number of the cell that was strained fastest, and the rate that is held [1/s]; as of hold_rate."""
    strain = find_strains(before, now, cells)
    fastest = int(np.argmax(strain))
    held = float(strain[fastest]) if goal.of == "greatest" else float(_weigh(before, cells) @ strain)
    return fastest, held / dt


def _weigh(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the parts of the whole area that cells (n, 4) have (n,)."""
    area = np.linalg.norm(find_area_vectors(points[cells]).sum(axis=1), axis=1)
    return np.asarray(area / area.sum())
