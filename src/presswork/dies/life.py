# SPDX-License-Identifier: Apache-2.0
"""How many parts a die makes before a crack begins, by Smith, Watson & Topper (J. Mater. 5, 1970).

    sigma_max eps_a = (sigma_f^2 / E) (2N)^(2b) + sigma_f epsilon_f (2N)^(b + c)

At each node sigma_max is the largest principal stress of the stroke, the joined die before the load among its states.
The strain amplitude eps_a is half the largest von Mises stress of the difference of two states, over E. Where nothing
is drawn no crack begins. Without sigma_max, Coffin, Manson & Basquin: eps_a = (sigma_f / E) (2N)^b + epsilon_f (2N)^c.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from presswork.dies.study import DieStudy, Peak, largest_principal, von_mises
from presswork.model import Fatigue, FloatArray

MOST = 1e12
"""Cycles beyond which life has no end."""
ROUNDS = 80
"""Halvings of the logarithm of N."""


def find_life(strain: FloatArray, fatigue: Fatigue, young: float, largest: FloatArray | None = None) -> FloatArray:
    """Return the cycles N (n,) for strain amplitudes (n,); infinite beyond MOST.

    largest: the largest stress of the cycle (n,) [MPa]; None: the mean stress is left out.
    """
    f = fatigue
    terms = [(f.strength / young, f.strength_exponent), (f.ductility, f.ductility_exponent)]
    given = np.asarray(strain, dtype=np.float64)
    if largest is not None:
        terms = [(f.strength * factor, f.strength_exponent + exponent) for factor, exponent in terms]
        given = np.maximum(largest, 0.0) * given
    low, high = np.full(given.shape, np.log(0.5)), np.full(given.shape, np.log(10.0 * MOST))
    for _ in range(ROUNDS):
        middle = 0.5 * (low + high)
        borne = sum(factor * np.exp(exponent * (np.log(2.0) + middle)) for factor, exponent in terms)
        low, high = np.where(borne > given, middle, low), np.where(borne > given, high, middle)
    cycles = np.exp(0.5 * (low + high))
    return np.where(cycles < MOST, cycles, np.inf)


def judge_life(study: DieStudy) -> list[Peak | None]:
    """Return the least number of parts of each part of a die, and where; None where its fatigue is not known."""
    states = [study.joined.stress, *(now.answer.stress for now in study.instants)]
    largest = np.max([largest_principal(stress) for stress in states], axis=0)
    swing = np.max([von_mises(one - other) for one, other in combinations(states, 2)], axis=0)
    found: list[Peak | None] = []
    for number, part in enumerate(study.structure.body.parts):
        own, fatigue, young = study.structure.part_of(number), part.steel.fatigue, part.steel.young
        if fatigue is None:
            found.append(None)
            continue
        cycles = find_life(0.5 * swing[own] / young, fatigue, young, largest[own])
        at = int(np.argmin(cycles))
        found.append(Peak(float(cycles[at]), study.structure.points[own][at]))
    return found
