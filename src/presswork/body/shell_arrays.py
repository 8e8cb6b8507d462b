# SPDX-License-Identifier: Apache-2.0
"""What shells keep in the State besides stress and history."""

from __future__ import annotations

from dataclasses import dataclass

from presswork.model import FloatArray
from presswork.state import Arrays


@dataclass
class ShellArrays(Arrays):
    """Directors, and per block of q points in the plane and k layers what follows the sheet."""

    owner = "shells"
    director: FloatArray
    """Unit directors (n_directors, 3)."""
    thickness: list[FloatArray]
    """(n_cells, q) [mm]."""
    direction: list[FloatArray]
    """First covariant base vector in the lamina frame, which turns with the material (n_cells, q, k, 2), unit."""
    shear: list[FloatArray]
    """Transverse shear force per area of the reference cell, contravariant (n_cells, q, 2)."""
    internal: list[FloatArray]
    """What a cell keeps besides its points (n_cells, m): the bubble of shell3_mitc_plus; of shell4_1pt the hourglass
    forces (6), the energy stored by them and that lost to plastic flow [N mm]."""


@dataclass(frozen=True)
class ShellBlock:
    """The arrays of a block's shells that are evaluated here; as in CellArrays and ShellArrays."""

    thickness: FloatArray
    stress: FloatArray
    history: FloatArray
    direction: FloatArray
    shear: FloatArray
    internal: FloatArray
    volume: FloatArray
    temperature: FloatArray

    @property
    def kept(self) -> list[FloatArray]:
        """What the kernel reads and fills, in its order."""
        return [self.thickness, self.stress, self.history, self.direction, self.shear, self.internal]

    @property
    def filled(self) -> list[FloatArray]:
        """What the kernel fills: all but the temperature."""
        return [*self.kept, self.volume]
