# SPDX-License-Identifier: Apache-2.0
"""Lines of operations whose history has derivatives by numbers of the case beside its columns.

Each neighbour lays its own part into its own tools, as the run does. From the difference of the parts the derivatives
go on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Model
from presswork.outcome import GaveUpError
from presswork.process.derivatives.derivatives import WithDerivatives
from presswork.process.derivatives.differentiated_release import (
    LeadingStamping,
    ReleasedSide,
    find_forming,
    let_sides_go,
)
from presswork.process.epochs import NamedArrays
from presswork.process.line.press_line import PressLine
from presswork.process.line.springback import LaidPart

BESIDE = "beside."
"""Prefix in a checkpoint of the parts that neighbours have begun the present operation with, one after the other."""


class _LineSide(PressLine):
    """A neighbour of a line."""

    def _make_operation(self, own: Model, part: LaidPart | None) -> ReleasedSide:
        return ReleasedSide(own, threads=self._threads, begin=part, shows_springback=self._releases)

    @property
    def side(self) -> ReleasedSide:
        """The present operation."""
        assert isinstance(self._now, ReleasedSide)
        return self._now

    def lay(self) -> bool:
        """Lay the part into the next operation; return whether it lies there."""
        try:
            self._begin_next()
        except GaveUpError:
            return False
        return True

    def lay_like(self, line: PressLine) -> None:
        """Begin the operation of another line with its part, which counts for nothing."""
        self.go_to(line.line_arrays())


class DifferentiatedLine(WithDerivatives[_LineSide], PressLine):
    """A line of implicit operations at work beside its neighbours. Raises StartError."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self.begin_derivatives(lambda m: _LineSide(m, threads=threads))
        self._follow()

    def _make_operation(self, own: Model, part: LaidPart | None) -> LeadingStamping:
        operation = LeadingStamping(own, threads=self._threads, begin=part, shows_springback=self._releases)
        operation.release_sides = self._release_sides
        return operation

    def _release_sides(self, procedure: ImplicitProcedure) -> None:
        let_sides_go(self.derivatives, lambda line: line.side, procedure)

    def _follow(self) -> None:
        self.derivatives.follow(find_forming(self._now), lambda line: line.side.forming_procedure)

    def _begin_next(self) -> None:
        self.derivatives.spread()
        super()._begin_next()
        for line, number, change in self.derivatives.placed:
            is_lost = bool(change) and self.derivatives.is_lost(number)
            if is_lost or not line.lay():
                self.derivatives.lose(number if change else None)
                line.lay_like(self)
        self._follow()

    def line_arrays(self) -> NamedArrays:
        """Return where the line is, and its neighbours' parts."""
        arrays = super().line_arrays()
        for number, line in enumerate(self.derivatives.sides):
            arrays |= {f"{BESIDE}{number}.{name}": values for name, values in line.line_arrays().items()}
        return arrays

    def go_to(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Begin the operation of these arrays with its parts."""
        super().go_to(arrays)
        if self._operation == 0:  # which is at work already
            return
        for number, line in enumerate(self.derivatives.sides):
            own = f"{BESIDE}{number}."
            line.go_to({name.removeprefix(own): v for name, v in arrays.items() if name.startswith(own)})
        self._follow()
