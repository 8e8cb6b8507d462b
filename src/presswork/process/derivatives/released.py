# SPDX-License-Identifier: Apache-2.0
"""Neighbours of a stamping that is trimmed and released.

When the tools let the part of the run go, so do the neighbours: each cuts its own part along its own lines, and is held
by the nodes that hold the run's part. Where that leaves other cells than in the run, no derivative is found from there
on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Model
from presswork.outcome import GaveUpError
from presswork.process.derivatives.derivatives import Derivatives, Measured
from presswork.process.implicit.stamping import ImplicitStamping
from presswork.process.line.released_part import Released
from presswork.process.line.springback import ReleasedStamping

Beside = TypeVar("Beside", bound=Measured)


def release_neighbours(
    derivatives: Derivatives[Beside], find_stamping: Callable[[Beside], ReleasedStamping], procedure: ImplicitProcedure
) -> None:
    """Release neighbours, from where the derivatives have them, and follow the run's released part with them."""
    derivatives.spread()
    for beside, number, change in derivatives.placed:
        side = find_stamping(beside)
        is_lost = bool(change) and derivatives.is_lost(number)
        if is_lost or not release_like(side, procedure.model):
            derivatives.lose(number if change else None)
            _rest_like(side, procedure.model)
    derivatives.follow(procedure, lambda beside: _find_released(find_stamping(beside)))


def release_like(side: ReleasedStamping, like: Model) -> bool:
    """Release the part of a neighbour's tools as the run has done; return whether it has the run's cells.

    like: the model of the run's released part.
    """
    side.hold = lambda model: _hold_like(model, like)
    try:
        side.released = side.release()
    except GaveUpError:
        return False
    own = side.released.implicit.model.mesh.blocks
    return len(own) == len(like.mesh.blocks) and all(
        np.array_equal(a.connectivity, b.connectivity) for a, b in zip(own, like.mesh.blocks, strict=True)
    )


def _hold_like(model: Model, like: Model) -> Model:
    """Return the model of a released part, held by the nodes that hold another one."""
    held = replace(model.mesh, node_sets=like.mesh.node_sets)
    solver = replace(model.solver, symmetric=False)
    return replace(model, mesh=held, supports=like.supports, solver=solver)


def _rest_like(side: ReleasedStamping, like: Model) -> None:
    """Go on with the run's part at rest, in a state that counts for nothing."""
    implicit = ImplicitProcedure(replace(like, solver=replace(like.solver, symmetric=False)), threads=side.threads)
    side.begin_epoch(like.mesh)
    side.released = Released(implicit, None, np.zeros_like(like.mesh.points), 0.0, {})


def find_forming(stamping: ReleasedStamping) -> ImplicitProcedure:
    """Return the procedure that forms."""
    assert isinstance(stamping.forming, ImplicitStamping), "explicit runs have no derivatives"
    return stamping.forming.procedure


def _find_released(stamping: ReleasedStamping) -> ImplicitProcedure:
    """Return the procedure of the part without tools."""
    assert stamping.released is not None, "it was released"
    return stamping.released.implicit
