# SPDX-License-Identifier: Apache-2.0
"""Whether a run has reached what it is for: a die is full, a force or a gap is there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from presswork.model import Goal
from presswork.observe.contract import History, Observed
from presswork.observe.memory.contract import Memory, begin_sentence, describe_instant

TEXTS = ("stage", "remesh_cause")
"""Columns without numbers."""


class Goals(Memory):
    """The goal that a run has reached first."""

    name = "goals"

    def __init__(self, goals: Sequence[Goal]) -> None:
        self._goals = goals
        self._reached = ""

    def look(self, run: Observed | None, row: Mapping[str, Any]) -> str | None:
        """Look whether a row reaches a goal; that is no reason to give up."""
        for goal in self._goals if not self._reached else ():
            if goal.column in row and goal.is_reached(value := float(row[goal.column])):
                bound = f"above = {goal.above:g}" if goal.above is not None else f"below = {goal.below:g}"
                instant = begin_sentence(describe_instant(row))
                self._reached = f"{instant}{goal.column} is {value:.6g}: complete (limits.end, {bound})"
                break
        return None

    def reached(self) -> str:
        """Return which goal is reached, and when; empty before."""
        return self._reached

    def summary(self, history: History) -> dict[str, Any]:
        """Return which goal ended the run, if one did."""
        return {"ended_by": self._reached} if self._reached else {}

    def to_data(self) -> Any:
        """Return what is reached."""
        return self._reached

    def load_data(self, data: Any) -> None:
        """Take up what to_data gave."""
        self._reached = str(data)
