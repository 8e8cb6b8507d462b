# SPDX-License-Identifier: Apache-2.0
"""An implicit procedure that watches for folds, and goes on with contact of the folding bodies with themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Body, list_bodies
from presswork.process.epochs import EPOCH, NamedArrays
from presswork.process.implicit.implicit_recording import ImplicitRecording
from presswork.process.implicit.self_contact import find_folding, switch_on, touches_itself

FOLDED = "folded"
"""Name in a checkpoint."""


class FoldingRecording(ImplicitRecording):
    """An implicit procedure at work on solids whose surfaces may fold onto themselves."""

    def _may_change_mesh(self, failure: str = "") -> bool:
        if not failure:
            self._watch_folds()
        return super()._may_change_mesh(failure)

    def _watch_folds(self) -> None:
        """Switch on contact of bodies with themselves where their surfaces are about to fold onto themselves."""
        found = find_folding(self.procedure, self._bodies())
        if found:
            self._go_on_with(switch_on(self.procedure, list(found)))
            self._notes += list(found.values())

    def _go_on_with(self, procedure: ImplicitProcedure) -> None:
        """Go on with another procedure on the same mesh."""
        self.procedure, self.model = procedure, procedure.model
        procedure.evolution.place(self._origin)

    def _bodies(self) -> Sequence[Body]:
        return list_bodies(self.model)

    def _epoch_arrays(self) -> NamedArrays:
        folded = np.array([touches_itself(self.model, i) for i in range(len(self._bodies()))])
        return super()._epoch_arrays() | {FOLDED: folded}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Go back to the epoch and the state of these arrays. Raises ValueError if they belong to another model."""
        folded = np.flatnonzero(arrays.get(f"{EPOCH}{FOLDED}", np.zeros(0)))
        added = [int(i) for i in folded if not touches_itself(self.model, int(i))]
        if added:
            self._go_on_with(switch_on(self.procedure, added))
        super().load_arrays(arrays)
