# SPDX-License-Identifier: Apache-2.0
"""When and where the strains of a sheet first passed its forming limit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from presswork.observe.contract import History, Observed
from presswork.observe.formability import FormabilityObserver
from presswork.observe.memory.contract import Memory, describe_instant


class FirstCrack(Memory):
    """The first instant with a negative margin to the forming limit."""

    name = "first_crack"

    def __init__(self) -> None:
        self._first: dict[str, Any] | None = None

    def look(self, run: Observed | None, row: Mapping[str, Any]) -> str | None:
        """Note the first crack; it stops no run."""
        if run is None or self._first is not None:
            return None
        margin = run.observers.find(FormabilityObserver).find_margin(run)
        if margin is not None and margin.value < 0.0:
            place = [float(x) for x in margin.place]
            self._first = {**describe_instant(row), "margin": margin.value, "cell": margin.cell, "at_mm": place}
        return None

    def summary(self, history: History) -> dict[str, Any]:
        """Return the first crack, if there is one."""
        return {} if self._first is None else {"first_crack": self._first}

    def to_data(self) -> Any:
        """Return the first crack."""
        return self._first

    def load_data(self, data: Any) -> None:
        """Take up what to_data gave."""
        self._first = data
