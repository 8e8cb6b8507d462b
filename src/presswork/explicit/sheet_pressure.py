# SPDX-License-Identifier: Apache-2.0
"""Pressure of fluids on the sheet of an explicit run (cpp/explicit/contact/sheet_pressure.hpp)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.motion import check_table
from presswork.model import EnclosedFluid

Array = npt.NDArray[np.float64]


class PressuresOfRun:
    """What an explicit run does with pressures on its sheet."""

    _loop: _core.SpaceLoop | _core.SpaceLoopSingle
    _nodes: npt.NDArray[np.intp]
    time: float
    dt: float

    def _start_pressures(self) -> None:
        self.pressures: dict[str, int] = {}
        self._pressure_courses: list[tuple[Array, Array]] = []

    def add_pressure(
        self,
        name: str,
        cells: npt.NDArray[np.integer],
        side: float,
        course: tuple[npt.ArrayLike, npt.ArrayLike],
        fluid: EnclosedFluid | None = None,
    ) -> None:
        """Let a pressure push shells from now on.

        cells: their nodes (n, 4), a triangle with its last node twice. side: 1 along their normals, -1 against. course:
        times [s] and pressures [MPa], of a fluid its volume without pressure [mm3], straight between them and constant
        beyond. fluid: whose pressure follows from the volume of its space; its room is that of these cells. Raises
        ExplicitError.
        """
        if name in self.pressures:
            raise ExplicitError(f"pressure {name!r} is there already: give each a name of its own")
        table = check_table(*course, f"pressure {name!r}: course")
        place = np.empty(len(self._nodes), dtype=np.int32)
        place[self._nodes] = np.arange(len(self._nodes))
        enclosed = {} if fluid is None else {"stiffness": fluid.stiffness, "room": fluid.room}
        inside = np.ascontiguousarray(place[cells])
        self.pressures[name] = self._loop.add_pressure(inside, side=side, **enclosed)
        self._pressure_courses.append(table)

    def find_pressure(self, name: str) -> float:
        """Return a pressure as it is now [MPa]."""
        return float(self._loop.pressure_state(self.pressures[name])[0])

    def _prepare_pressures(self, n: int) -> None:
        times = self.time + self.dt * np.arange(1, n + 1)
        for number, table in enumerate(self._pressure_courses):
            self._loop.drive_pressure(number, np.interp(times, *table))
