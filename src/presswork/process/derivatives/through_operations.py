# SPDX-License-Identifier: Apache-2.0
"""Neighbours of a line of operations.

Each neighbour lays its own part into its own tools, as the run does. From the difference of the parts the derivatives
go on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from presswork.implicit.stepping import ImplicitProcedure
from presswork.outcome import GaveUpError
from presswork.process.derivatives.derivatives import Derivatives
from presswork.process.derivatives.released import find_forming, release_neighbours
from presswork.process.line.press_line import PressLine
from presswork.process.model_run import NamedArrays

BESIDE = "beside."
"""Prefix in a checkpoint of the parts that neighbours have begun the present operation with, one after the other."""


class ThroughOperations:
    """Lets the neighbours of a line go through its operations beside it."""

    def __init__(self, line: PressLine, derivatives: Derivatives[PressLine]) -> None:
        self._line, self._derivatives = line, derivatives
        self._follow()

    def _follow(self) -> None:
        """Follow the operation at work, and its part when that is released."""
        self._line.now.after_release = self._release
        self._derivatives.follow(find_forming(self._line.now), lambda line: find_forming(line.now))

    def _release(self, procedure: ImplicitProcedure) -> None:
        release_neighbours(self._derivatives, lambda line: line.now, procedure)

    def leave_operation(self) -> None:
        """Put the neighbours where the derivatives have them, before the part is laid into the next operation."""
        self._derivatives.spread()

    def take_operation(self) -> None:
        """Lay the neighbours' parts into the operation that the line has begun."""
        for line, number, change in self._derivatives.placed:
            is_lost = bool(change) and self._derivatives.is_lost(number)
            if is_lost or not _lay(line):
                self._derivatives.lose(number if change else None)
                line.go_to(self._line.line_arrays())  # with the run's part, which counts for nothing
        self._follow()

    def arrays(self) -> NamedArrays:
        """Return the neighbours' parts."""
        arrays: NamedArrays = {}
        for number, line in enumerate(self._derivatives.sides):
            arrays |= {f"{BESIDE}{number}.{name}": values for name, values in line.line_arrays().items()}
        return arrays

    def go_to(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Begin the operation of a checkpoint, which the line has begun, with the neighbours' parts."""
        if self._line.operation == 0:  # which is at work already
            return
        for number, line in enumerate(self._derivatives.sides):
            own = f"{BESIDE}{number}."
            line.go_to({name.removeprefix(own): v for name, v in arrays.items() if name.startswith(own)})
        self._follow()


def _lay(line: PressLine) -> bool:
    """Lay the part of a neighbour into its next operation; return whether it lies there."""
    try:
        line.begin_next()
    except GaveUpError:
        return False
    return True
