# SPDX-License-Identifier: Apache-2.0
"""The contract of objects that follow the increments of the stepping, for instance the derivatives of a run
(sensitivities.py)."""

from __future__ import annotations

from typing import Protocol

from presswork.outcome import Step
from presswork.state import State


class Follower(Protocol):
    """Follows a run, increment after increment."""

    def note(self, trial: State) -> None:
        """Take note of a trial state in equilibrium, before it is completed."""

    def follow(self, state_n: State, trial: State, step: Step, next_stage: int | None) -> None:
        """Go through the increment that has led to a completed trial state.

        state_n: the converged state before it, and before its stage began. next_stage: that begins after it, if any.
        """
