# SPDX-License-Identifier: Apache-2.0
"""Pressure of fluids on faces of a sheet between tools, which follows the surface.

A pressure p over cells gives nodes the forces p dV/dx, V being the volume that the sheet sweeps; p d2V/dx2 is the load
stiffness (cell_pressure.py). It acts on the middle surface of the sheet, where tools seal it up to their rings of
contact (sealing.py).

The pressure of a fluid in a closed space is p = K ln(V_fluid/V_space), never below zero, with V_space = room + V. So
its forces have one part of the stiffness more, K/V_space dV/dx (dV/dx)^T, which couples all nodes under it. So has the
pressure that holds a strain rate (held_rate.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork import _core
from presswork.interaction.cell_pressure import press_cells
from presswork.interaction.contract import Forces, Guess, Interaction, Point
from presswork.interaction.held_rate import LedPressure, RateHold, lead_pressure, measure_rate
from presswork.interaction.sealing import Seal
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.mesh.pressed_cells import find_pressed_cells, find_rim, find_side, find_swept_volume
from presswork.model import BoolArray, FloatArray, HeldRate, IntArray, Model, SheetPressure
from presswork.outcome import Step
from presswork.state import ANEW, RUN, Arrays, OnNewMesh, State

CHANGE = 0.02
"""Part of a stage in which all but 1/e of a cell becomes wet or dry, and of a pressure is lost."""
STEADY = 0.2
"""Most of this in one increment: what leaks takes the load off the ring that is to hold."""
TIGHT = 1e-9
"""Least space that a guess may leave a fluid, over its room."""


@dataclass
class PressureArrays(Arrays):
    """What pressures have come to."""

    owner = "pressures"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"value": RUN, "rate": RUN, "fastest": ANEW, "wet": ANEW}
    value: FloatArray
    """Values of the model's pressures (n,) [MPa]."""
    rate: FloatArray
    """Strain rates in the last increment of those that hold one [1/s]; of those that tools seal what has leaked off
    them [MPa], else 0 (n,)."""
    fastest: FloatArray
    """Number, among the cells under each of them, of the one that was strained fastest; -1: none yet (n,)."""
    wet: FloatArray
    """Parts of the cells that fluids wet, of those alone that tools seal (n_sealed, n_cells)."""


@dataclass(frozen=True)
class PressureForces(Forces):
    """Forces of all pressures at a guess."""

    value: FloatArray
    """Pressures (n,) [MPa]."""
    strained: FloatArray
    """Rates and fastest cells, as PressureArrays has them, and the pressures that a rate leads to [MPa] (3, n)."""


class SheetPressures(Interaction):
    """The pressures on the sheet of one model."""

    is_driving = True

    def __init__(self, model: Model) -> None:
        self._model = model
        self._ends = np.cumsum([len(block.connectivity) for block in model.mesh.blocks])[:-1]
        self._holds: dict[int, RateHold] = {}
        self._shapes = [_core.shell_shape(block.element) for block in model.mesh.blocks]
        self._pressed = [self._find_cells(pressure) for pressure in model.sheet_pressures]
        points, cells = model.mesh.points, model.cells
        self._corners = [cells[find_pressed_cells(points, cells, pressure)] for pressure in model.sheet_pressures]
        self._sides = [find_side(points, cells, pressure.face) for pressure in model.sheet_pressures]
        self._seals = {
            number: Seal(cells, find_pressed_cells(points, cells, each), find_rim(model.mesh), self._sides[number])
            for number, each in enumerate(model.sheet_pressures)
            if each.is_sealed
        }
        self._wet: dict[int, tuple[FloatArray, float]] = {}

    def _find_cells(self, pressure: SheetPressure) -> list[IntArray]:
        """Return the cells that a pressure acts on, block by block (n, nodes)."""
        pressed = np.zeros(len(self._model.cells), dtype=bool)
        pressed[find_pressed_cells(self._model.mesh.points, self._model.cells, pressure)] = True
        return self._split(pressed)

    def _split(self, pressed: BoolArray) -> list[IntArray]:
        """Return the pressed ones of all cells, block by block (n, nodes)."""
        parts = np.split(pressed, self._ends)
        return [block.connectivity[own] for block, own in zip(self._model.mesh.blocks, parts, strict=True)]

    def _take_wet(self, wet: FloatArray, side: float) -> tuple[list[IntArray], list[FloatArray]]:
        """Return the cells that a fluid wets at all, and by how much with the side's sign, block by block."""
        parts = np.split(wet, self._ends)
        return self._split(wet > 0.0), [side * own[own > 0.0] for own in parts]

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return no pressure."""
        n, sealed = len(self._pressed), [seal.at_rest() for seal in self._seals.values()]
        wet = np.array(sealed).reshape(len(sealed), len(self._model.cells))
        return (PressureArrays(np.zeros(n), np.zeros(n), np.full(n, -1.0), wet),)

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> PressureForces:
        """Return the forces at a guess."""
        points = self._model.mesh.points + guess.displacement[:, :3]
        force, value = np.zeros((len(points), 6)), np.zeros(len(self._pressed))
        strained = np.array([np.zeros(len(value)), state_n[PressureArrays].fastest, np.zeros(len(value))])
        pairs, blocks, dyads = [np.zeros((0, 2), dtype=np.int32)], [np.zeros((0, 6, 6))], []
        courses = self._model.stages[guess.step.stage].pressure_course
        for number, pressure in enumerate(self._model.sheet_pressures):
            course, slope, led = courses[pressure.name], 0.0, None
            if course.held is None:
                p, slope = self._find_pressure(number, float(np.interp(guess.step.fraction, *course.rows.T)), points)
            else:
                led, strained[:, number] = self._lead(number, course.held, state_n, points, guess.dt)
                given = self._holds[number].given
                p, led = (led.value, led) if given is None else (given, None)
            pressed = self._pressed[number]
            share: Sequence[float | FloatArray] = [self._sides[number]] * len(self._shapes)
            if number in self._wet:
                wet, strained[0, number] = self._wet[number]
                p -= strained[0, number]
                pressed, share = self._take_wet(wet, self._sides[number])
            value[number] = p
            if p == 0.0:
                continue
            area = np.zeros_like(force)
            for cells, shape, sides in zip(pressed, self._shapes, share, strict=True):
                more, stiffness = press_cells(points, cells, shape, sides, area)
                pairs.append(more)
                blocks.append(p * stiffness)
            force += p * area
            if slope:
                dyads.append((-slope * area, area))
            elif led is not None:
                dyads.append((-area, np.pad(led.slope, ((0, 0), (0, 3)))))
        return PressureForces(force, np.concatenate(pairs), np.concatenate(blocks), value, strained, dyads=dyads)

    def _lead(
        self, number: int, goal: HeldRate, state_n: State, points: FloatArray, dt: float
    ) -> tuple[LedPressure, tuple[float, float, float]]:
        """Return the pressure to which a strain rate leads, and of this guess the rate, fastest cell and pressure."""
        before = self._model.mesh.points + state_n.nodes.displacement[:, :3]
        cells, own = self._corners[number], state_n[PressureArrays]
        p_n, fastest = float(own.value[number]), int(own.fastest[number])
        if number not in self._holds:
            self._holds[number] = RateHold(goal, p_n, float(own.rate[number]), dt)
        led = lead_pressure(goal, p_n, before, points, cells, fastest=fastest, dt=dt)
        fastest, rate = measure_rate(goal, before, points, cells, dt)
        return led, (rate, fastest, led.value)

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Forget which limits have held pressures; find where sealed fluids come to."""
        self._holds.clear()
        own, courses = state_n[PressureArrays], self._model.stages[step.stage].pressure_course
        for row, (number, seal) in enumerate(self._seals.items()):
            now = self._model.mesh.points + state_n.nodes.displacement[:, :3]
            by_tool = state_n[SpaceToolArrays].force if SpaceToolArrays in state_n else np.zeros((0, len(now), 3))
            rows = courses[self._model.sheet_pressures[number].name].rows
            given, part = float(np.interp(step.fraction, *rows.T)), (step.fraction - step.fraction_n) / CHANGE
            self._wet[number] = seal.advance(
                seal.measure_contact(now, by_tool), given, (own.wet[row], float(own.rate[number])), min(part, STEADY)
            )

    def update(self, trial: State, point: Point, own: Any, *, near: bool, pull: float) -> int:
        """Let limits hold the pressures that a strain rate would lead beyond them."""
        return sum(hold.update(own.strained[2, number]) for number, hold in self._holds.items()) if near else 0

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
        kept = trial[PressureArrays]
        kept.value = own.value.copy()
        kept.rate, kept.fastest = own.strained[:2].copy()
        if self._wet:
            kept.wet = np.array([wet for wet, _ in self._wet.values()])
