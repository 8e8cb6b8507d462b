# SPDX-License-Identifier: Apache-2.0
"""Implicit runs whose history has derivatives by numbers of the case beside its columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Mesh, Model
from presswork.process.derivatives import WithDerivatives
from presswork.process.differentiated_remeshing import DifferentiatedRemeshing
from presswork.process.implicit_recording import ImplicitRecording
from presswork.process.implicit_stamping import ImplicitStamping
from presswork.process.recording import Recording
from presswork.process.released_part import Released
from presswork.process.springback import FORMING, ReleasedStamping


def begin_differentiated(model: Model, threads: int) -> Recording:
    """Return the procedure of a model with derivatives. Raises StartError."""
    if model.analysis == "stamping" and (model.springback is not None or model.output.dynain):
        return DifferentiatedRelease(model, threads=threads)
    if model.analysis == "stamping":
        return DifferentiatedStamping(model, threads=threads)
    if model.remeshing is not None:
        return DifferentiatedRemeshing(model, threads=threads)
    return DifferentiatedForming(model, threads=threads)


class DifferentiatedForming(WithDerivatives[ImplicitRecording], ImplicitRecording):
    """An implicit procedure at work beside its neighbours, whose rows give the derivatives. Raises StartError."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self.begin_derivatives(lambda m: ImplicitRecording(m, threads=threads))
        self.derivatives.follow(self.procedure, lambda side: side.procedure)


class DifferentiatedStamping(WithDerivatives[ImplicitStamping], ImplicitStamping):
    """An implicit stamping at work beside its neighbours. Raises StartError."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self.begin_derivatives(lambda m: ImplicitStamping(m, threads=threads))
        self.derivatives.follow(self.procedure, lambda side: side.procedure)


class _Side(ReleasedStamping):
    """A neighbour of a stamping that is released: held by the nodes that hold the run's part."""

    like: Model | None = None
    """The model of the run's released part."""

    def _make_released_model(self, mesh: Mesh) -> Model:
        model = super()._make_released_model(mesh)
        assert self.like is not None, "the run is released first"
        held = replace(model.mesh, node_sets=self.like.mesh.node_sets)
        solver = replace(model.solver, symmetric=False)
        return replace(model, mesh=held, supports=self.like.supports, solver=solver)

    def let_go(self, like: Model) -> None:
        """Release the part of the neighbour's tools as the run has done."""
        self.like = like
        self._released = self._release()

    @property
    def forming_procedure(self) -> ImplicitProcedure:
        """The procedure that forms."""
        return _forming(self)

    @property
    def released_procedure(self) -> ImplicitProcedure:
        """The procedure of the part without tools."""
        assert self._released is not None, "it was let go"
        return self._released.implicit


class DifferentiatedRelease(WithDerivatives[_Side], ReleasedStamping):
    """An implicit stamping, and the springback of its part, at work beside their neighbours. Raises StartError."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self.begin_derivatives(lambda m: _Side(m, threads=threads))
        self.derivatives.follow(_forming(self), lambda side: side.forming_procedure)

    def _release(self) -> Released:
        released = super()._release()
        self._release_sides(released.implicit)
        return released

    def _release_sides(self, procedure: ImplicitProcedure) -> None:
        """Let the neighbours go, from where the derivatives have them."""
        self.derivatives.spread()
        for side in self.derivatives.sides:
            side.let_go(procedure.model)
        self.derivatives.follow(procedure, lambda side: side.released_procedure)

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        if self._released is not None:
            formed = {name.removeprefix(FORMING): a for name, a in arrays.items() if name.startswith(FORMING)}
            self.forming.load_arrays(formed)
            self._release_sides(self._released.implicit)
        super()._load_state(arrays)


def _forming(stamping: ReleasedStamping) -> ImplicitProcedure:
    assert isinstance(stamping.forming, ImplicitStamping), "explicit runs have no derivatives"
    return stamping.forming.procedure
