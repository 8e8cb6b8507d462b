# SPDX-License-Identifier: Apache-2.0
"""Pressure of fluids on faces of a sheet between tools, which follows the surface.

A pressure p over cells gives nodes the forces p dV/dx, V being the volume that the sheet sweeps; d(p dV/dx)/dx is the
load stiffness (cell_pressure.py). It acts on the middle surface of the sheet.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork import _core
from presswork.interaction.cell_pressure import press_cells
from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.mesh.pressed_cells import find_pressed_cells, find_side
from presswork.model import FloatArray, IntArray, Model, SheetPressure
from presswork.state import RUN, Arrays, OnNewMesh, State


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
        force = np.zeros((len(points), 6))
        pairs, blocks = [np.zeros((0, 2), dtype=np.int32)], [np.zeros((0, 6, 6))]
        value = self._find_values(guess.step.stage, guess.step.fraction)
        for p, side, of_blocks in zip(value, self._sides, self._pressed, strict=True):
            if p == 0.0:
                continue
            for cells, shape in zip(of_blocks, self._shapes, strict=True):
                more, stiffness = press_cells(points, cells, shape, side * p, force)
                pairs.append(more)
                blocks.append(stiffness)
        return PressureForces(force, np.concatenate(pairs), np.concatenate(blocks), value)

    def _find_values(self, stage: int, fraction: float) -> FloatArray:
        """Return the pressures at a part of a stage (n,) [MPa]."""
        courses = self._model.stages[stage].pressure_course
        names = [pressure.name for pressure in self._model.sheet_pressures]
        return np.array([np.interp(fraction, *courses[name].rows.T) for name in names])

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Add the forces to the loads of a converged state, which are set before; keep the pressures."""
        trial.nodes.external_force = trial.nodes.external_force + own.force
        trial[PressureArrays].value = own.value.copy()
