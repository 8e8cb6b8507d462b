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
from presswork.interaction.heat_films import ToolFilm
from presswork.interaction.heat_surface import HeatSurface, SurfaceNow, Touch
from presswork.interaction.of_model import Interactions
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import BoolArray, FloatArray, Heat, Model
from presswork.outcome import Failed, GaveUpError, Step
from presswork.state import NODE, RUN, Arrays, OnNewMesh, State
from presswork.timing import Timing

KINDS = ("plastic", "friction", "tools", "convection", "radiation")
"""What heats and cools bodies that are formed; what flows between them adds up to nothing."""
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


class HeatOfForming:
    """Conducts heat in a body between rigid tools of given temperatures."""

    def __init__(
        self, model: Model, cells: Mechanics, interactions: Interactions, timing: Timing, threads: int
    ) -> None:
        assert model.heat is not None
        self._model, self._heat, self._cells, self._interactions = model, model.heat, cells, interactions
        self._equation = HeatEquation(model, np.zeros((0, 2), dtype=np.int32), timing, threads)
        self._shapes = PointShapes(model.mesh)
        self._surface = HeatSurface(model, model.heat, interactions)
        n = len(model.mesh.points)
        self._none: FloatArray = np.zeros(n)
        usual = min(stage.duration for stage in model.stages) * model.solver.max_increment
        self._columns = {
            name: Column(*tool.steel, usual) for name, tool in model.heat.tools.items() if tool.steel is not None
        }
        self._shares = self._share_friction()
        self._body_of = np.zeros(n, dtype=np.intp)
        for number, body in enumerate(model.bodies):
            self._body_of[body.points.start : body.points.stop] = number
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

    def keep_stored(self, state: State, stored: float, new: BoolArray) -> None:
        """Bring temperatures carried to this mesh to a heat stored since the start [N mm]; new: nodes (n_points,).

        What is missing goes to the nodes in proportion to the range of temperature in the cells round them, where
        carrying errs: an even temperature stays.
        """
        arrays = state[HeatArrays]
        conduction, carried = self._equation.conduction, arrays.temperature.copy()
        span = np.zeros(len(carried))
        for block in self._model.mesh.blocks:
            own = carried[block.connectivity]
            np.maximum.at(span, block.connectivity, np.ptp(own, axis=1)[:, None])
        span *= new
        change = 0.0
        for _ in range(_CONTENT_ROUNDS if span.max() > 0.0 else 0):
            _, slope = conduction.content(arrays.temperature)
            change += (stored - self.stored(state)) / float((slope * span).sum())
            arrays.temperature = carried + change * span

    def spread(self, state: State) -> None:
        """Give the nodes' temperatures to the integration points of materials that depend on them."""
        for i, given in enumerate(state.cells.temperature):
            if given.size:
                state.cells.temperature[i] = self._shapes.to_points(i, state[HeatArrays].temperature)

    def advance(self, state_n: State, trial: State, step: Step, dt: float) -> None:
        """Bring the temperatures of a converged trial state to the end of its increment of dt [s].

        Raises GaveUpError if the heat equation has no solution.
        """
        surface = self._surface.find(trial, step)
        plastic, friction, into_tools = self._make_heat(state_n, trial, dt)
        friction += self._rub_bodies(state_n, trial, surface)
        between = [meeting.film for meeting in surface.meetings]
        self._equation.couple(np.concatenate([np.zeros((0, 2), dtype=np.int32), *(film.pairs for film in between)]))
        columns = state_n[HeatArrays].columns
        points = self._model.mesh.points + trial.nodes.displacement
        arrays = trial[HeatArrays]
        temperature, heat = state_n[HeatArrays].temperature, np.zeros(len(KINDS))
        time, part = 0.0, dt
        while time < dt * (1 - 1e-12):
            chilled = self._chill(surface.touches, columns, into_tools / dt, part)
            plain = [
                ToolFilm(t.heat.temperature, t.nodes, t.area, t.conductance)
                for t in surface.touches
                if t.tool not in chilled
            ]
            problem = HeatProblem(
                points=points,
                temperature_n=temperature,
                dt=part,
                films=[*plain, *chilled.values(), *between, *surface.around],
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
                films[touch.tool] = ColumnFilm(column, touch.nodes, touch.area, touch.conductance, own, flux, dt)
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
            share = self._shares[tool, self._body_of[contact.nodes]]
            friction = sum_at_nodes(contact.nodes, share * lost, n)
            into_tools = sum_at_nodes(contact.nodes, (1.0 - share) * lost, n)
        return self._heat.plastic_fraction * plastic, friction, into_tools

    def _rub_bodies(self, state_n: State, trial: State, surface: SurfaceNow) -> FloatArray:
        """Return the heat of friction between bodies at the nodes (n_points,) [N mm].

        All that friction takes in the increment, shared by shear times slip at the pairs of nodes, and between the two
        of each by their effusivities.
        """
        n = len(self._none)
        heat = np.zeros(n)
        lost = self._interactions.bodies.work(state_n, trial)["friction_work"] if self._model.contacts else 0.0
        if lost <= 0.0:
            return heat
        parts = []
        for meeting in surface.meetings:
            first, second = meeting.film.pairs.T
            slip = np.linalg.norm(trial.nodes.increment[first] - trial.nodes.increment[second], axis=1)
            parts.append(meeting.area * self._surface.find_shear(trial, meeting.contact)[first] * slip)
        total = sum(float(part.sum()) for part in parts)
        for meeting, part in zip(surface.meetings, parts, strict=True):
            first, second = meeting.film.pairs.T
            own, other = (np.array(self._heat.effusivity)[self._body_of[nodes]] for nodes in (first, second))
            amount = lost * part / total if total > 0.0 else np.zeros(len(part))
            heat += sum_at_nodes(first, amount * own / (own + other), n)
            heat += sum_at_nodes(second, amount * other / (own + other), n)
        return heat

    def _share_friction(self) -> FloatArray:
        """Return the part of the heat of friction that goes from a tool into a body (n_tools, n_bodies)."""
        shares = np.full((len(self._model.plane_tools), max(len(self._model.bodies), 1)), 0.5)
        for t, tool in enumerate(self._model.plane_tools):
            heat = self._heat.tools.get(tool.name)
            if heat is not None and heat.effusivity is not None:
                own = np.array(self._heat.effusivity)
                shares[t] = own / (own + heat.effusivity)
        return shares


def start_temperatures(model: Model, heat: Heat) -> FloatArray:
    """Return the temperatures of the nodes at the start (n_points,) [degrees C]."""
    temperature = np.full(len(model.mesh.points), heat.initial[0])
    for body, value in zip(model.bodies, heat.initial, strict=False):
        temperature[body.points.start : body.points.stop] = value
    return temperature
