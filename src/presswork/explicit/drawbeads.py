# SPDX-License-Identifier: Apache-2.0
"""Drawbeads of an explicit run: lines in the plan that hold the sheet back (cpp/explicit/contact/drawbeads.hpp)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.motion import check_table
from presswork.explicit.tools import RigidTool
from presswork.model import Drawbead

Array = npt.NDArray[np.float64]


class BeadsOfRun:
    """What an explicit run does with its drawbeads."""

    _loop: _core.SpaceLoop | _core.SpaceLoopSingle
    _reference: tuple[float, float] | None
    tools: dict[str, RigidTool]
    time: float
    dt: float

    def _start_beads(self) -> None:
        self.beads: dict[str, int] = {}
        self._bead_shares: list[tuple[Array, Array]] = []

    def add_bead(self, bead: Drawbead, share: tuple[npt.ArrayLike, npt.ArrayLike] = ((0.0, 1.0), (1.0, 1.0))) -> None:
        """Let a drawbead hold the sheet from now on; its tool must be there.

        share: times [s] and the share of its force, straight between them and constant beyond. Raises ExplicitError.
        """
        if bead.name in self.beads:
            raise ExplicitError(f"bead {bead.name!r} is there already: give each a name of its own")
        if not 0 <= bead.force < np.inf:
            raise ExplicitError(f"bead {bead.name!r}: force = {bead.force:g} N/mm: it must not be negative")
        if bead.tool is not None and bead.tool not in self.tools:
            raise ExplicitError(f"bead {bead.name!r}: there is no tool {bead.tool!r}: add it first")
        table = check_table(*share, f"bead {bead.name!r}: share")
        tool = -1 if bead.tool is None else self.tools[bead.tool].number
        place, across, length = (np.ascontiguousarray(a) for a in (bead.place, bead.across, bead.length))
        self.beads[bead.name] = self._loop.add_bead(place, across, length, force=bead.force, tool=tool)
        self._bead_shares.append(table)

    def bead_restraint(self, name: str) -> float:
        """Give the restraining force of a bead, summed along its line [N]."""
        return self._loop.bead_restraint(self.beads[name])

    def _prepare_beads(self, n: int) -> None:
        for number, table in enumerate(self._bead_shares):
            self._loop.drive_bead(number, np.interp(self.time + self.dt * np.arange(n), *table))
