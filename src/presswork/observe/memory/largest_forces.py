# SPDX-License-Identifier: Apache-2.0
"""The largest forces of a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.observe.contract import History
from presswork.observe.memory.contract import Memory, describe_instant

FORCE = ".force"


class LargestForces(Memory):
    """The largest force of every tool, bead and contact, by the history."""

    name = "largest_forces"

    def summary(self, history: History) -> dict[str, Any]:
        """Return the largest forces [N], either direction, with when they were."""
        found = {}
        for column in (name for name in history if name.endswith(FORCE) and len(history[name])):
            at = int(np.argmax(np.abs(history[column])))
            row = {name: values[at] for name, values in history.items()}
            found[column.removesuffix(FORCE)] = {"force_n": float(row[column]), **describe_instant(row)}
        return {"largest_forces": found}
