# SPDX-License-Identifier: Apache-2.0
"""The memories of a recording."""

from __future__ import annotations

from presswork.model import Model
from presswork.observe.memory.contract import Memories
from presswork.observe.memory.cracks import Cracks
from presswork.observe.memory.extremes import FieldExtremes
from presswork.observe.memory.first_crack import FirstCrack
from presswork.observe.memory.goals import Goals
from presswork.observe.memory.largest_forces import LargestForces
from presswork.observe.memory.limits import LimitsPassed


def list_memories(model: Model) -> Memories:
    """Return what a recording of a model remembers; a new memory is a line here."""
    cracks = Cracks(are_cut=model.separation is not None)
    return Memories(
        [FirstCrack(), cracks, LimitsPassed(model.limits), Goals(model.limits.end), LargestForces(), FieldExtremes()]
    )
