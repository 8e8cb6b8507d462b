# SPDX-License-Identifier: Apache-2.0
"""The whole tangent with the freedoms of interactions, such as the travel of tools that forces push (placing.py).

Vectors have a row for each such freedom after those of the nodes, with its value in the first column.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.implicit.linear.whole_tangent import WholeTangent
from presswork.interaction.contract import Interaction, Point
from presswork.interaction.led import Led
from presswork.interaction.placing import Border
from presswork.model import FloatArray
from presswork.state import State

DIGITS = 1e-6
"""Residual, over a tool's column of the matrix, to which the answer of the nodes is found."""


class BorderedTangent:
    """The tangent at one point of a run, with the equations of interactions, of which at most one has any."""

    def __init__(self, whole: WholeTangent, interactions: Sequence[Interaction], trial: State, point: Point) -> None:
        self._whole = whole
        found = (
            interaction.find_border(trial, point, forces, self)
            for interaction, forces in zip(interactions, point.forces, strict=True)
            if isinstance(interaction, Led)
        )
        self._border: Border | None = next((border for border in found if border is not None), None)

    @property
    def rounds(self) -> int:
        """Back-substitutions so far, one for each right-hand side."""
        return self._whole.rounds

    def answer(self, force: FloatArray, moves: FloatArray | None = None) -> FloatArray:
        """Return what nodes do under forces, where the held ones move as given, by the whole tangent alone."""
        moves = np.zeros_like(force) if moves is None else moves
        size = self._whole.find_largest(force, moves)
        return self._whole.respond([force], [moves], [DIGITS * size])[0]

    def find_row(self, motion: FloatArray) -> FloatArray:
        """Return the derivative of the work of internal forces along a motion by the nodes (n_points, freedoms)."""
        return self._whole.find_row(motion)

    def respond(
        self, forces: Sequence[FloatArray], moves: Sequence[FloatArray], goals: Sequence[float]
    ) -> list[FloatArray]:
        """Return what nodes and own freedoms do, as WholeTangent.respond."""
        if self._border is None:
            return self._whole.respond(forces, moves, goals)
        n = len(forces[0]) - len(self._border.own)
        found = self._whole.respond([f[:n] for f in forces], [m[:n] for m in moves], goals)
        corrections = []
        for force, correction in zip(forces, found, strict=True):
            travel = self._border.find_travel(force[n:, 0], correction)
            rows = np.zeros_like(force[n:])
            rows[:, 0] = travel
            corrections.append(np.vstack([self._border.carry(correction, travel), rows]))
        return corrections
