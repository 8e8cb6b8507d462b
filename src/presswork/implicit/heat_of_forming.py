# SPDX-License-Identifier: Apache-2.0
"""Heat of a body as it is formed: after each converged increment the heat equation, on the body as it lies then.

Staggered: an increment is computed at the temperatures at its start, then they take the heat of its plastic work and
of its friction, what flows into the tools and what the surroundings take (docs/theory/heat.md). Where surfaces touch a
tool or are free is found anew in every increment.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from presswork.body.heat import Conduction, PointShapes, sum_at_nodes
from presswork.body.solids import Mechanics
from presswork.implicit.heat_equation import HeatEquation, HeatProblem, HeatStep
from presswork.interaction.chilled_tool import CELLS, Column, ColumnFilm
from presswork.interaction.heat_films import Film, ToolFilm, make_surroundings, measure_sides
from presswork.interaction.of_model import Interactions
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import BoolArray, FloatArray, Heat, IntArray, Model, ToolHeat
from presswork.outcome import Failed, GaveUpError, Step
from presswork.state import NODE, RUN, Arrays, OnNewMesh, State
from presswork.timing import Timing

KINDS = ("plastic", "friction", "tools", "convection", "radiation")
"""What heats and cools a body that is formed."""
MOST_HALVINGS = 6
_CONTENT_ROUNDS = 5


@dataclass
class HeatArrays(Arrays):
    """Temperatures, and the heat that has come in."""

    owner = "heat"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "temperature": NODE,
        "heat": RUN,
        "columns": OnNewMesh("surface", axis=1),
    }
    temperature: FloatArray
    """(n_points,) [degrees C]."""
    heat: FloatArray
    """Since the start, by KINDS (5,) [N mm]."""
    columns: FloatArray
    """Of the steel of every tool behind every node, from the surface on (n_tools, n_points, CELLS) [degrees C]; no
    tools where none warms up."""


@dataclass(frozen=True)
class Touch:
    """Where a tool touches the body."""

    tool: int
    heat: ToolHeat
    nodes: IntArray
    """(n,)"""
    area: FloatArray
    """That they stand for (n,) [mm2]."""
    pressure: FloatArray
    """(n,) [MPa]."""


class HeatOfForming:
    """Conducts heat in a body between rigid tools of given temperatures."""

    def __init__(
        self, model: Model, cells: Mechanics, interactions: Interactions, timing: Timing, threads: int
    ) -> None:
        assert model.heat is not None
        self._model, self._heat, self._cells, self._interactions = model, model.heat, cells, interactions
        self._equation = HeatEquation(model, np.zeros((0, 2), dtype=np.int32), timing, threads)
        self._shapes = PointShapes(model.mesh)
        self._edges = find_open_edges(model)
        n = len(model.mesh.points)
        self._none: FloatArray = np.zeros(n)
        usual = min(stage.duration for stage in model.stages) * model.solver.max_increment
        self._columns = {
            name: Column(*tool.steel, usual) for name, tool in model.heat.tools.items() if tool.steel is not None
        }
        self._free_of_prescription = np.zeros(n, dtype=np.uint8)

    @property
    def conduction(self) -> Conduction:
        """What conducts and stores the heat."""
        return self._equation.conduction

    def at_rest(self) -> HeatArrays:
        """Return the temperatures at the start."""
        start = start_temperatures(self._model, self._heat)
        tools = self._model.plane_tools if self._columns else ()
        columns = np.zeros((len(tools), len(start), CELLS))
        for t, tool in enumerate(tools):
            if tool.name in self._columns:
                columns[t] = self._heat.tools[tool.name].temperature
        return HeatArrays(start, np.zeros(len(KINDS)), columns)

    def hottest(self, state: State) -> dict[str, float]:
        """Return the highest temperature at the surface of every tool that warms up [degrees C]."""
        names = [tool.name for tool in self._model.plane_tools]
        columns = state[HeatArrays].columns
        return {name: float(columns[names.index(name), :, 0].max()) for name in self._columns}

    def at_points(self, state: State, block: int) -> FloatArray:
        """Return the temperature at a block's points (n_cells, p) [degrees C]."""
        return self._shapes.to_points(block, state[HeatArrays].temperature)

    def stored(self, state: State) -> float:
        """Return the heat stored since the start [N mm]."""
        now, _ = self._equation.conduction.content(state[HeatArrays].temperature)
        before, _ = self._equation.conduction.content(start_temperatures(self._model, self._heat))
        return float((now - before).sum())

    def keep_stored(self, state: State, stored: float) -> float:
        """Bring temperatures carried to this mesh to a heat stored since the start [N mm]; return the largest change.

        What is missing goes to the nodes in proportion to the range of temperature in the cells round them, where
        carrying errs: an even temperature stays.
        """
        arrays = state[HeatArrays]
        conduction, carried = self._equation.conduction, arrays.temperature.copy()
        span = np.zeros(len(carried))
        for block in self._model.mesh.blocks:
            own = carried[block.connectivity]
            np.maximum.at(span, block.connectivity, np.ptp(own, axis=1)[:, None])
        change = 0.0
        for _ in range(_CONTENT_ROUNDS if span.max() > 0.0 else 0):
            _, slope = conduction.content(arrays.temperature)
            change += (stored - self.stored(state)) / float((slope * span).sum())
            arrays.temperature = carried + change * span
        return float(np.abs(arrays.temperature - carried).max())

    def spread(self, state: State) -> None:
        """Give the nodes' temperatures to the integration points of materials that depend on them."""
        for i, given in enumerate(state.cells.temperature):
            if given.size:
                state.cells.temperature[i] = self._shapes.to_points(i, state[HeatArrays].temperature)

    def advance(self, state_n: State, trial: State, step: Step, dt: float) -> None:
        """Bring the temperatures of a converged trial state to the end of its increment of dt [s].

        Raises GaveUpError if the heat equation has no solution.
        """
        plastic, friction, into_tools = self._make_heat(state_n, trial, dt)
        touches, around = self._find_surface(trial, step)
        columns = state_n[HeatArrays].columns
        points = self._model.mesh.points + trial.nodes.displacement
        arrays = trial[HeatArrays]
        temperature, heat = state_n[HeatArrays].temperature, np.zeros(len(KINDS))
        time, part = 0.0, dt
        while time < dt * (1 - 1e-12):
            chilled = self._chill(touches, columns, into_tools / dt, part)
            plain = [ToolFilm(t.heat, t.nodes, t.area, t.pressure) for t in touches if t.tool not in chilled]
            problem = HeatProblem(
                points=points,
                temperature_n=temperature,
                dt=part,
                films=[*plain, *chilled.values(), *around],
                time=time + part,
                mask=self._free_of_prescription,
                prescribed=self._none,
                source=(plastic + friction) / dt,
            )
            found = self._equation.solve(problem, temperature)
            if isinstance(found, Failed):
                part *= 0.5
                if part < dt * 0.5**MOST_HALVINGS:
                    name = self._model.stages[step.stage].name
                    raise GaveUpError(f"stage {name!r}: {found.reason} in an increment of {dt:.2e} s")
                continue
            temperature, time = found.temperature, time + part
            columns = self._warm_up(columns, chilled, temperature, part)
            heat += part * self._count(found)
            part = min(part, dt - time)
        heat[:2] = plastic.sum(), friction.sum()
        arrays.temperature, arrays.heat = temperature, state_n[HeatArrays].heat + heat
        arrays.columns = columns
        self.spread(trial)

    def _chill(self, touches: list[Touch], columns: FloatArray, rubbed: FloatArray, dt: float) -> dict[int, ColumnFilm]:
        """Return the films of the tools that warm up, over a time step of dt [s]; rubbed: (n_points,) [N mm/s]."""
        films = {}
        for touch in touches:
            column = self._columns.get(self._model.plane_tools[touch.tool].name)
            if column is not None:
                own, flux = columns[touch.tool, touch.nodes], rubbed[touch.nodes] / touch.area
                films[touch.tool] = ColumnFilm(
                    touch.heat, column, touch.nodes, touch.area, touch.pressure, own, flux, dt
                )
        return films

    def _warm_up(
        self, columns: FloatArray, chilled: Mapping[int, ColumnFilm], temperature: FloatArray, dt: float
    ) -> FloatArray:
        """Return the columns after a time step: of nodes that touch nothing heat only spreads."""
        after = columns.copy()
        for t, tool in enumerate(self._model.plane_tools if self._columns else ()):
            if tool.name in self._columns:
                after[t], _ = self._columns[tool.name].step(columns[t], dt)
            if t in chilled:
                after[t, chilled[t].nodes] = chilled[t].finish(temperature)
        return after

    @staticmethod
    def _count(found: HeatStep) -> FloatArray:
        power: Mapping[str, float] = found.power
        return np.array([power.get(kind, 0.0) for kind in KINDS])

    def _make_heat(self, state_n: State, trial: State, dt: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the heat of plastic work, that of friction, and the part of friction that heats the tools.

        Each is made in the increment at the nodes (n_points,) [N mm].
        """
        n = len(self._none)
        plastic = np.zeros(n)
        for i, work in enumerate(self._cells.plastic_work_at_points(state_n, trial, dt)):
            plastic += self._shapes.to_nodes(i, work)
        friction, into_tools = np.zeros(n), np.zeros(n)
        contact = self._interactions.tools.contact
        lost = self._interactions.tools.friction.lost_at
        if self._model.plane_tools and lost.any():
            tool = np.argmax((trial[ContactArrays].status > 0), axis=0) // 2
            share = np.array([self._share(self._heat.tools.get(t.name)) for t in self._model.plane_tools])
            friction = sum_at_nodes(contact.nodes, share[tool] * lost, n)
            into_tools = sum_at_nodes(contact.nodes, (1.0 - share[tool]) * lost, n)
        return self._heat.plastic_fraction * plastic, friction, into_tools

    def _share(self, tool: ToolHeat | None) -> float:
        """Return the part of friction heat that goes into the workpiece, by the effusivities of both."""
        own = self._heat.effusivity
        if tool is None or tool.effusivity is None or own is None:
            return 0.5
        return own / (own + tool.effusivity)

    def _find_surface(self, trial: State, step: Step) -> tuple[list[Touch], list[Film]]:
        """Return where tools touch the surface as it lies now, and the films of what is free.

        Edges both of whose ends a tool holds touch it, all others are free.
        """
        points = self._model.mesh.points + trial.nodes.displacement
        areas = measure_sides(self._model, self._edges, points)
        free: BoolArray = np.ones(len(areas), dtype=bool)
        touches: list[Touch] = []
        if self._model.plane_tools:
            forces = self._interactions.tools.contact.forces(trial, self._interactions.supports.fixed(step.stage))
            for t, tool in enumerate(self._model.plane_tools):
                own = forces.tool == t
                touching = np.isin(self._edges[:, :2], forces.nodes[own]).all(axis=1)
                free &= ~touching
                heat = self._heat.tools.get(tool.name)
                if heat is None or not touching.any():
                    continue
                area = sum_at_nodes(self._edges[touching], areas[touching], len(points))
                push = sum_at_nodes(forces.nodes[own], np.maximum(forces.push[own], 0.0), len(points))
                nodes = np.flatnonzero(area).astype(np.int32)
                touches.append(Touch(t, heat, nodes, area[nodes], push[nodes] / area[nodes]))
        if self._heat.surroundings is None:
            return touches, []
        area = sum_at_nodes(self._edges[free], areas[free], len(points))
        return touches, make_surroundings(self._heat.surroundings, area)


def start_temperatures(model: Model, heat: Heat) -> FloatArray:
    """Return the temperatures of the nodes at the start (n_points,) [degrees C]."""
    temperature = np.full(len(model.mesh.points), heat.initial[0])
    for body, value in zip(model.bodies, heat.initial, strict=False):
        temperature[body.points.start : body.points.stop] = value
    return temperature


def find_open_edges(model: Model) -> IntArray:
    """Return the boundary edges that no support holds: those of symmetry planes and clamps give no heat."""
    edges = model.mesh.boundary_edges
    held = np.zeros(len(edges), dtype=bool)
    for support in model.supports:
        held |= np.isin(edges, model.mesh.node_sets[support.node_set]).all(axis=1)
    return edges[~held]
