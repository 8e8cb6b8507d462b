# SPDX-License-Identifier: Apache-2.0
"""The first guess of an increment of a sheet between tools.

1. Velocities of the last two increments, each at the middle of its increment, are continued in a straight line to the
   middle of the next. A guess by the last increment alone is off by a term of second order: where the sheet turns by an
   angle a in an increment, by a membrane strain of a^2 / 2, which is 400 MPa for a = 0.06.
2. Each interaction moves the guess to where it expects its nodes (Interaction.lead): tools to where they push on the
   sheet as they did.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.implicit.progress import Progress
from presswork.interaction.contract import Interaction
from presswork.model import BoolArray, FloatArray
from presswork.state import Arrays, State

FARTHEST = 2.0
"""How many times the change of velocity between the last two increments is continued at most."""
TOO_SHORT = 0.1
"""Length of an increment over the one after it below which it is too short to show the velocity."""


@dataclass
class FormerIncrement(Arrays):
    """The increment before the last."""

    owner = "former"
    increment: FloatArray
    """Displacement of it (n_points, f) [mm, rad], as in NodeArrays."""
    size: float = 0.0
    """Part of the stage that it went; 0: there is none in this stage."""


def find_first_guess(
    state_n: State, trial: State, size: float, interactions: Sequence[Interaction], fixed: BoolArray
) -> FloatArray:
    """Return the guess at an increment of `size`, a part of the stage (n_points, f) [mm, rad].

    trial: its tools stand where the increment leads. fixed: freedoms that the tools do not move (n_points, f).
    """
    last, increment = state_n[Progress].last_size, state_n.nodes.increment
    if last == 0.0:
        return np.zeros_like(increment)
    guess, former = increment * (size / last), state_n[FormerIncrement]
    if former.size > TOO_SHORT * last:
        ahead = min((size + last) / (last + former.size), FARTHEST)
        guess = guess + size * ahead * (increment / last - former.increment / former.size)
    led = guess
    for interaction in interactions:
        led = interaction.lead(state_n, trial, led)
    return np.where(fixed, guess, led)


def keep_former(state_n: State, trial: State) -> None:
    """Keep the increment that led to state_n, in the trial state that follows it."""
    former = trial[FormerIncrement]
    former.increment, former.size = state_n.nodes.increment, state_n[Progress].last_size
