# SPDX-License-Identifier: Apache-2.0
"""The steel of a tool behind the nodes that touch it: a half-space each, in cells along the normal.

Heat flows along the normal alone, which holds while its depth, the square root of diffusivity and time, is small beside
the tool and the contact. Each column is a row of finite volumes by backward Euler. It is linear, so its answer to the
flux q into it is a + g q; with the conductance h of the contact and half a cell before its first temperature

    q = (T - a_1) / (1/h + d_1 / (2 k) + g_1),

which stands in the equation of the workpiece's node: both temperatures are those at the end of the step.
"""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.interaction.heat.heat_films import ToolFilm
from presswork.model import FloatArray, IntArray

CELLS = 20
GROWTH = 1.3
FIRST = 1 / 3
"""Thickness of the first cell over the distance that heat goes in a step, sqrt(diffusivity dt)."""


class Column:
    """The cells behind a contact node, of one steel."""

    def __init__(self, conductivity: float, capacity: float, dt: float) -> None:
        """Take conductivity [N/(s K)], heat capacity of a volume [N/(mm2 K)] and a usual time step [s]."""
        width = FIRST * np.sqrt(conductivity / capacity * dt) * GROWTH ** np.arange(CELLS)
        between = 2 * conductivity / (width[1:] + width[:-1])
        self._capacity = capacity * width
        self._column = _core.HeatColumn(self._capacity, between)
        self.surface = float(width[0] / (2 * conductivity))
        """Resistance from the surface to the first temperature [mm s K/N]."""

    def step(self, temperature: FloatArray, dt: float) -> tuple[FloatArray, FloatArray]:
        """Return the temperatures after dt [s] without a flux (n, CELLS), and what a flux of 1 adds (CELLS,)."""
        still, answer = self._column.step(temperature, dt)
        return np.asarray(still), np.asarray(answer)

    def content(self, temperature: FloatArray) -> FloatArray:
        """Return the heat of columns (n, CELLS) over an area of 1 mm2 (n,) [N/mm]."""
        return np.asarray(temperature @ self._capacity)


class ColumnFilm:
    """Conductance between nodes and the columns behind them, over one time step."""

    kind = "tools"

    def __init__(
        self,
        column: Column,
        nodes: IntArray,
        area: FloatArray,
        conductance: FloatArray,
        still: FloatArray,
        answer: FloatArray,
        friction_heat: FloatArray,
    ) -> None:
        """Take nodes in contact (n,), their areas [mm2] and conductances [N/(mm s K)].

        still, answer: what Column.step returns of the nodes' columns;
        friction_heat: what goes into the tool (n,) [N/(mm s)].
        """
        self._answer, self._still = answer, still + friction_heat[:, None] * answer
        resistance = 1.0 / np.maximum(conductance, 1e-12) + column.surface + answer[0]
        self.nodes, self._through = nodes, 1.0 / resistance
        self._film = ToolFilm(nodes, area * self._through, self._still[:, 0])

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return self._film.at(time)

    def finish(self, temperature: FloatArray) -> FloatArray:
        """Return the columns at the end of the step (n, CELLS), from the temperatures of all nodes."""
        flux = self._through * (temperature[self.nodes] - self._still[:, 0])
        return np.asarray(self._still + flux[:, None] * self._answer)
