# SPDX-License-Identifier: Apache-2.0
"""What an interaction does in a neighbour of a run, by which the derivatives of the run are found.

A neighbour holds the nodes that the run holds, and takes multipliers over where the run has. Freedoms of its own are
put where the derivatives have them (implicit/neighbours.py).
"""

from __future__ import annotations

from typing import Any, Protocol, Self

import numpy as np

from presswork.interaction.contract import Forces, Point
from presswork.model import FloatArray, IntArray
from presswork.outcome import Step
from presswork.state import State


class Tangent(Protocol):
    """The whole tangent of a run in equilibrium, its constraints as there; vectors (n_points, freedoms) are global."""

    def answer(self, force: FloatArray, moves: FloatArray | None = None) -> FloatArray:
        """Return what nodes do under forces, where the held ones move as given (None: not at all)."""

    def find_row(self, motion: FloatArray) -> FloatArray:
        """Return the derivative of the work of internal forces along a motion by the nodes."""


class Led:
    """A base beside Interaction of what holds nodes, has freedoms or multipliers of its own; alone it does nothing."""

    def hold_like(self, other: Self, trial: State, held: State, displacement: FloatArray) -> None:
        """Hold in a trial state what another run of nearly the same model holds, before a guess is evaluated.

        other: the interaction of that run; held: its state in equilibrium. displacement: of the guess (n_points,
        freedoms) [mm, rad].
        """

    def hold_anew(self, state: State, held: State) -> None:
        """Hold on a new mesh what another run of nearly the same model holds on a mesh beside it, in place."""

    def find_last_travel(self, state: State, step: Step) -> FloatArray:
        """Return how far they went in the increment that has led to a state (n,)."""
        return np.zeros(0)

    def travel_like(self, state_n: State, trial: State, step: Step, travel: FloatArray) -> None:
        """Put its own freedoms where they have gone so far in the increment (n,)."""

    def find_missing(self, trial: State, point: Point, own: Any) -> FloatArray:
        """Return what the equations of its own freedoms lack (n,) [N], held as hold_like() has them."""
        return np.zeros(0)

    def find_border(self, trial: State, point: Point, own: Any, tangent: Tangent) -> Any:
        """Return these equations (placing.Border)."""
        return None

    def find_area_blocks(self, point: Point, own: Any, resistance: Any) -> tuple[IntArray, FloatArray]:
        """Return how its forces depend on the area of contact, which the tangent of Newton's method leaves out.

        Pairs of nodes (n, 2), and what the first adds to the tangent by the place of the second (n, d, d) [N/mm].
        """
        return np.zeros((0, 2), dtype=np.int32), np.zeros((0, 1, 1))

    def augment_like(self, trial: State, own: Forces | None) -> None:
        """Take multipliers over as another run of nearly the same model has done where it was."""
