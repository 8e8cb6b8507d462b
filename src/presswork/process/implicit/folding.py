# SPDX-License-Identifier: Apache-2.0
"""Folds: contact of bodies with themselves, from where their surfaces are about to fold onto themselves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import list_bodies
from presswork.process.implicit.increments import IncrementRun
from presswork.process.implicit.self_contact import find_folding, switch_on, touches_itself
from presswork.process.mesh_change.contract import MeshChange

FOLDED = "folded"
"""Name in a checkpoint."""


class Folding(MeshChange):
    """Switches on contact of bodies with themselves; their mesh stays, and the procedure on it is another."""

    def __init__(self, run: IncrementRun) -> None:
        self._run = run

    def look(self, failure: str = "") -> bool:
        """Look for folds after a converged increment."""
        run = self._run
        found = {} if failure else find_folding(run.procedure, list_bodies(run.model))
        if found:
            run.replace_procedure(switch_on(run.procedure, list(found)))
            run.notes += list(found.values())
        return False

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return which bodies have contact with themselves."""
        model = self._run.model
        return {FOLDED: np.array([touches_itself(model, i) for i in range(len(list_bodies(model)))])}

    def prepare_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Switch on the contact that a checkpoint has."""
        run, folded = self._run, np.flatnonzero(epoch.get(FOLDED, np.zeros(0)))
        added = [int(i) for i in folded if not touches_itself(run.model, int(i))]
        if added:
            run.replace_procedure(switch_on(run.procedure, added))
