# SPDX-License-Identifier: Apache-2.0
"""Weight: density times the acceleration of gravity on the undeformed volume, in every family.

A node takes rho g int N dV of its cells, so that a polynomial field of the cells' order is loaded as theory asks. The
load keeps its direction and size, hence it has no derivative. In increments it comes linearly over the first stage and
stays; explicit runs give each node its mass times g from the first cycle on (process/explicit), so that a free body
falls without strain.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.mesh.node_weights import find_weights
from presswork.model import Model
from presswork.state import State


class Gravity(Interaction):
    """The weight of one model's nodes."""

    is_driving = True

    def __init__(self, model: Model) -> None:
        self._weight = find_weights(model)
        d = model.dimension
        self._no_pairs, self._no_blocks = np.zeros((0, 2), dtype=np.int32), np.zeros((0, d, d))

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces:
        """Return the weight at a guess."""
        share = guess.step.fraction if guess.step.stage == 0 else 1.0
        return Forces(share * self._weight, self._no_pairs, self._no_blocks)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Add the weight to the loads of a converged state, which are set before."""
        external = trial.nodes.external_force.copy()
        external[:, : own.force.shape[1]] += own.force
        trial.nodes.external_force = external
