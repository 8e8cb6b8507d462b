# SPDX-License-Identifier: Apache-2.0
"""Why a guess of a solid's displacement cannot be evaluated: a cell has turned inside out."""

from __future__ import annotations

from dataclasses import dataclass

from presswork.outcome import BadGuess


@dataclass(frozen=True)
class TurnedInsideOut(BadGuess):
    """A cell that the trial displacement has turned inside out; the increment must be cut."""

    block: int
    cell: int

    def __str__(self) -> str:
        return f"cell {self.cell} of block {self.block} turned inside out"
