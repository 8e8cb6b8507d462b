# SPDX-License-Identifier: Apache-2.0
"""Stampings that are trimmed and released, whose history has derivatives by numbers of the case beside its columns.

When the tools let the part of the run go, so do the neighbours: each cuts its own part along its own lines. Where that
leaves other cells than in the run, no derivative is found from there on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Mesh, Model
from presswork.outcome import GaveUpError
from presswork.process.derivatives.derivatives import Derivatives, Measured, WithDerivatives
from presswork.process.implicit.implicit_stamping import ImplicitStamping
from presswork.process.line.released_part import Released
from presswork.process.line.springback import FORMING, ReleasedStamping

Beside = TypeVar("Beside", bound=Measured)


class ReleasedSide(ReleasedStamping):
    """A neighbour of a stamping that is released: held by the nodes that hold the run's part."""

    like: Model | None = None
    """The model of the run's released part."""

    def _make_released_model(self, mesh: Mesh) -> Model:
        model = super()._make_released_model(mesh)
        assert self.like is not None, "the run is released first"
        held = replace(model.mesh, node_sets=self.like.mesh.node_sets)
        solver = replace(model.solver, symmetric=False)
        return replace(model, mesh=held, supports=self.like.supports, solver=solver)

    def let_go(self, like: Model) -> bool:
        """Release the part of the neighbour's tools as the run has done; return whether it has the run's cells."""
        self.like = like
        try:
            self._released = self._release()
        except GaveUpError:
            return False
        own = self._released.implicit.model.mesh.blocks
        return len(own) == len(like.mesh.blocks) and all(
            np.array_equal(a.connectivity, b.connectivity) for a, b in zip(own, like.mesh.blocks, strict=True)
        )

    def let_go_like(self, like: Model) -> None:
        """Go on with the run's part at rest, in a state that counts for nothing."""
        implicit = ImplicitProcedure(replace(like, solver=replace(like.solver, symmetric=False)), threads=self._threads)
        self._begin_epoch(like.mesh)
        self._released = Released(implicit, None, np.zeros_like(like.mesh.points), 0.0, {})

    @property
    def forming_procedure(self) -> ImplicitProcedure:
        """The procedure that forms."""
        return find_forming(self)

    @property
    def released_procedure(self) -> ImplicitProcedure:
        """The procedure of the part without tools."""
        assert self._released is not None, "it was let go"
        return self._released.implicit


class LeadingStamping(ReleasedStamping):
    """A stamping whose neighbours are let go when it is."""

    release_sides: Callable[[ImplicitProcedure], None]
    """Lets them go; is given the procedure of the run's released part."""

    def _release(self) -> Released:
        released = super()._release()
        self.release_sides(released.implicit)
        return released

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        if self._released is not None:
            formed = {name.removeprefix(FORMING): a for name, a in arrays.items() if name.startswith(FORMING)}
            self.forming.load_arrays(formed)
            self.release_sides(self._released.implicit)
        super()._load_state(arrays)


def let_sides_go(
    derivatives: Derivatives[Beside], find_side: Callable[[Beside], ReleasedSide], procedure: ImplicitProcedure
) -> None:
    """Let neighbours go, from where the derivatives have them, and follow the run's released part with them."""
    derivatives.spread()
    for beside, number, change in derivatives.placed:
        side = find_side(beside)
        is_lost = bool(change) and derivatives.is_lost(number)
        if is_lost or not side.let_go(procedure.model):
            derivatives.lose(number if change else None)
            side.let_go_like(procedure.model)
    derivatives.follow(procedure, lambda beside: find_side(beside).released_procedure)


class DifferentiatedRelease(WithDerivatives[ReleasedSide], LeadingStamping):
    """An implicit stamping, and what becomes of its part, at work beside their neighbours. Raises StartError."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self.begin_derivatives(lambda m: ReleasedSide(m, threads=threads))
        self.release_sides = lambda procedure: let_sides_go(self.derivatives, lambda side: side, procedure)
        self.derivatives.follow(find_forming(self), lambda side: side.forming_procedure)


def find_forming(stamping: ReleasedStamping) -> ImplicitProcedure:
    """Return the procedure that forms."""
    assert isinstance(stamping.forming, ImplicitStamping), "explicit runs have no derivatives"
    return stamping.forming.procedure
