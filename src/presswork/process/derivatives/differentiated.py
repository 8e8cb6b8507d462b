# SPDX-License-Identifier: Apache-2.0
"""Implicit runs whose history has derivatives by numbers of the case beside its columns."""

from __future__ import annotations

from presswork.model import Model
from presswork.process.derivatives.derivatives import WithDerivatives
from presswork.process.derivatives.differentiated_line import DifferentiatedLine
from presswork.process.derivatives.differentiated_release import DifferentiatedRelease
from presswork.process.derivatives.differentiated_remeshing import DifferentiatedRemeshing, DifferentiatedSpaceRemeshing
from presswork.process.implicit.implicit_recording import ImplicitRecording
from presswork.process.implicit.implicit_stamping import ImplicitStamping
from presswork.process.recording import Recording


def begin_differentiated(model: Model, threads: int) -> Recording:
    """Return the procedure of a model with derivatives. Raises StartError."""
    if model.following:
        return DifferentiatedLine(model, threads=threads)
    if model.analysis == "stamping" and (model.trim or model.springback is not None or model.output.dynain):
        return DifferentiatedRelease(model, threads=threads)
    if model.analysis == "stamping":
        return DifferentiatedStamping(model, threads=threads)
    if model.remeshing is not None and model.dimension == 3:
        return DifferentiatedSpaceRemeshing(model, threads=threads)
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
