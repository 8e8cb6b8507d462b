# SPDX-License-Identifier: Apache-2.0
"""Pressure of fluids on faces of a sheet between tools, which follows the surface.

A pressure p over cells gives nodes the forces p dV/dx, V being the volume that the sheet sweeps; p d2V/dx2 is the load
stiffness (cell_pressure.py). It acts on the middle surface of the sheet.

The pressure of a fluid in a closed space is p = K ln(V_fluid/V_space), never below zero, with V_space = room + V. So
its forces have one part of the stiffness more, K/V_space dV/dx (dV/dx)^T, which couples all nodes under it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork import _core
from presswork.interaction.cell_pressure import press_cells
from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.mesh.pressed_cells import find_pressed_cells, find_side, find_swept_volume
from presswork.model import FloatArray, IntArray, Model, SheetPressure
from presswork.state import RUN, Arrays, OnNewMesh, State

TIGHT = 1e-9
"""Least space that a guess may leave a fluid, over its room."""


@dataclass
class PressureArrays(Arrays):
    """What pressures have come to."""

    owner = "pressures"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"value": RUN}
    value: FloatArray
    """Values of the model's pressures (n,) [MPa]."""


@dataclass(frozen=True)
class PressureForces(Forces):
    """Forces of all pressures at a guess."""

    value: FloatArray
    """Pressures (n,) [MPa]."""


class SheetPressures(Interaction):
    """The pressures on the sheet of one model."""

    is_driving = True

    def __init__(self, model: Model) -> None:
        self._model = model
        self._shapes = [_core.shell_shape(block.element) for block in model.mesh.blocks]
        self._pressed = [self._find_cells(pressure) for pressure in model.sheet_pressures]
        points, cells = model.mesh.points, model.cells
        self._corners = [cells[find_pressed_cells(points, cells, pressure)] for pressure in model.sheet_pressures]
        self._sides = [find_side(points, cells, pressure.face) for pressure in model.sheet_pressures]

    def _find_cells(self, pressure: SheetPressure) -> list[IntArray]:
        """Return the cells that a pressure acts on, block by block (n, nodes)."""
        pressed = np.zeros(len(self._model.cells), dtype=bool)
        pressed[find_pressed_cells(self._model.mesh.points, self._model.cells, pressure)] = True
        blocks = self._model.mesh.blocks
        ends = np.cumsum([len(block.connectivity) for block in blocks])[:-1]
        return [block.connectivity[own] for block, own in zip(blocks, np.split(pressed, ends), strict=True)]

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return no pressure."""
        return (PressureArrays(np.zeros(len(self._pressed))),)

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> PressureForces:
        """Return the forces at a guess."""
        points = self._model.mesh.points + guess.displacement[:, :3]
        force, value = np.zeros((len(points), 6)), np.zeros(len(self._pressed))
        pairs, blocks, dyads = [np.zeros((0, 2), dtype=np.int32)], [np.zeros((0, 6, 6))], []
        courses = self._model.stages[guess.step.stage].pressure_course
        for number, pressure in enumerate(self._model.sheet_pressures):
            given = float(np.interp(guess.step.fraction, *courses[pressure.name].rows.T))
            p, slope = self._find_pressure(number, given, points)
            value[number] = p
            if p == 0.0:
                continue
            area = np.zeros_like(force)
            for cells, shape in zip(self._pressed[number], self._shapes, strict=True):
                more, stiffness = press_cells(points, cells, shape, self._sides[number], area)
                pairs.append(more)
                blocks.append(p * stiffness)
            force += p * area
            if slope:
                dyads.append((-slope * area, area))
        return PressureForces(force, np.concatenate(pairs), np.concatenate(blocks), value, dyads=dyads)

    def _find_pressure(self, number: int, given: float, points: FloatArray) -> tuple[float, float]:
        """Return a pressure [MPa] and its derivative by the swept volume [MPa/mm3].

        given: the pressure, or the volume that has flowed in; points: present (n_points, 3) [mm].
        """
        fluid = self._model.sheet_pressures[number].fluid
        if fluid is None:
            return given, 0.0
        swept = self._sides[number] * find_swept_volume(self._model.mesh.points, points, self._corners[number])
        space = max(fluid.room + swept, TIGHT * fluid.room)
        p = fluid.stiffness * np.log((fluid.room + given) / space)
        return (float(p), -fluid.stiffness / space) if p > 0.0 else (0.0, 0.0)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Add the forces to the loads of a converged state, which are set before; keep the pressures."""
        trial.nodes.external_force = trial.nodes.external_force + own.force
        trial[PressureArrays].value = own.value.copy()
