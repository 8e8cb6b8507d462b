# SPDX-License-Identifier: Apache-2.0
"""Heat of bodies as they are formed: the heat equation over an increment, on the bodies as they lie at its end.

With the heat of plastic work and friction, and what tools, other bodies and surroundings take. Within an increment time
steps of heat follow their own error, as in heat alone (docs/theory/heat.md). Implicit increments
(heat_of_increments.py) and rows of explicit cycles (process/explicit/heat/of_solids.py) describe themselves as a
FormingInstant.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt
from typing import ClassVar

import numpy as np

from presswork.body.heat import Conduction, PointShapes, measure_ranges, widen
from presswork.implicit.heat_equation import PRESCRIBED, HeatEquation, HeatProblem, HeatStep
from presswork.implicit.heat_made import HeatSources
from presswork.implicit.heat_of_phases import KIND as LATENT
from presswork.implicit.heat_of_phases import PhasesAtNodes
from presswork.interaction.heat.chilled_tool import CELLS, Column, ColumnFilm
from presswork.interaction.heat.forming_instant import FormingInstant, Poses
from presswork.interaction.heat.heat_films import Film, ToolFilm
from presswork.interaction.heat.heat_surface import HeatSurface, Touch
from presswork.interaction.heat.meshed_dies import MeshedDies, pass_on
from presswork.model import BoolArray, FloatArray, Heat, IntArray, Model
from presswork.outcome import Failed, GaveUpError, IterationLog
from presswork.state import NODE, RUN, Arrays, OnNewMesh
from presswork.timing import Timing

KINDS = ("plastic", "friction", "tools", "convection", "radiation", LATENT)
"""What heats and cools bodies that are formed; what flows between them adds up to nothing."""
DIE_KINDS = ("friction", "contact", "convection", "radiation", PRESCRIBED)
"""What heats and cools tools with a mesh."""
FIRST_PART = 0.1
"""First time step of heat that is tried, over the increment with which a stage begins."""
SAFETY, SHRINK, GROWTH, REFUSED = 0.9, 0.2, 2.0, 2.0
"""As in process.heat."""
SMALLEST_PART = 1e-4
"""Time step of heat that is accepted as it is, over an increment."""
_CONTENT_ROUNDS = 5
_NO_PAIRS: IntArray = np.zeros((0, 2), dtype=np.int32)


@dataclass
class HeatArrays(Arrays):
    """Temperatures, and the heat that has come in."""

    owner = "heat"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "temperature": NODE,
        "rate": NODE,
        "heat": RUN,
        "columns": OnNewMesh("surface", axis=1),
        "dies": RUN,
        "die_rate": RUN,
        "die_heat": RUN,
        "phases": NODE,
        "reached": RUN,
        "last_step": RUN,
        "next_step": RUN,
    }
    temperature: FloatArray
    """(n_points,) [degrees C]."""
    rate: FloatArray
    """Rate of the temperature over the last time step of heat (n_points,) [K/s]."""
    heat: FloatArray
    """Since the start, by KINDS (6,) [N mm]."""
    columns: FloatArray
    """Temperatures of the steel of every tool behind every node, from the surface on (n_tools, n_points, CELLS)
    [degrees C]; no tools where none warms up."""
    dies: FloatArray
    """Temperatures of the nodes of tools with meshes, tool after tool (n_die_points,) [degrees C]."""
    die_rate: FloatArray
    """Rate of the tools' temperature over the last time step of heat (n_die_points,) [K/s]."""
    die_heat: FloatArray
    """Heat come into all of them since the start, by DIE_KINDS (5,) [N mm]."""
    phases: FloatArray
    """Ferrite, pearlite, bainite and martensite at the nodes (n_points, 4); 0 where no steel transforms."""
    reached: FloatArray
    """Lowest and highest temperature of each material since the start (n_materials, 2) [degrees C]."""
    last_step: float = 0.0
    """Last time step of heat [s]; 0 where a stage begins."""
    next_step: float = 0.0
    """Next step by the error [s]; 0: not known."""


@dataclass(frozen=True)
class _Instant:
    """Temperatures within an increment, of bodies and dies together."""

    temperature: FloatArray
    rate: FloatArray
    columns: FloatArray
    phases: FloatArray
    last_step: float
    next_step: float


class HeatOfForming:
    """Conducts heat in bodies, and in tools with meshes."""

    def __init__(self, model: Model, timing: Timing, threads: int, usual: float) -> None:
        """Take how long an increment usually is [s]."""
        assert model.heat is not None
        self._model, self._heat = model, model.heat
        self._dies = MeshedDies(model, model.heat)
        self._equation = HeatEquation(self._dies.join(), _NO_PAIRS, timing, threads, iterative=True)
        self._surface = HeatSurface(model, model.heat, self._dies)
        self._sources = HeatSources(model, model.heat)
        self._phases = PhasesAtNodes(model, self._equation.conduction.mass)
        self._shapes = PointShapes(model)
        self._n_points = len(model.mesh.points)
        self._skin = np.unique(
            model.mesh.boundary_faces if model.analysis == "solid" else model.mesh.boundary_edges
        )  # nodes that a tool may touch
        self._columns = {
            name: Column(*tool.steel, usual) for name, tool in model.heat.tools.items() if tool.steel is not None
        }

    @property
    def conduction(self) -> Conduction:
        """What conducts and stores the heat."""
        return self._equation.conduction

    @property
    def dies(self) -> MeshedDies:
        """Tools with meshes."""
        return self._dies

    def volumes(self) -> list[FloatArray]:
        """Return the volumes of each block's cells at the start (n_cells,) [mm3]."""
        return self._shapes.volumes

    def at_rest(self) -> HeatArrays:
        """Return the temperatures at the start."""
        start, dies = start_temperatures(self._model, self._heat), self._dies.at_rest()
        tools = self._model.tools if self._columns else ()
        columns = np.zeros((len(tools), len(start), CELLS))
        for t, tool in enumerate(tools):
            if tool.name in self._columns:
                columns[t] = self._heat.tools[tool.name].temperature
        rates = np.zeros(len(start)), np.zeros(len(dies))
        heat, phases = (np.zeros(len(KINDS)), np.zeros(len(DIE_KINDS))), self._phases.at_rest()
        reached = measure_ranges(self._model, start)
        return HeatArrays(start, rates[0], heat[0], columns, dies, rates[1], heat[1], phases, reached)

    def hottest(self, arrays: HeatArrays) -> dict[str, float]:
        """Return the highest temperature of every tool that warms up, at its surface or of its mesh [degrees C]."""
        names = [tool.name for tool in self._model.tools]
        found = {name: float(arrays.columns[names.index(name), :, 0].max()) for name in self._columns}
        for die in self._dies.dies:
            found[die.name] = float(arrays.dies[self._own(die.nodes)].max())
        return {name: found[name] for name in names if name in found}

    def _own(self, nodes: slice) -> slice:
        """Return the place of a die's nodes among those of dies."""
        return slice(nodes.start - self._n_points, nodes.stop - self._n_points)

    def die_temperatures(self, arrays: HeatArrays) -> dict[str, FloatArray]:
        """Return the temperatures of each tool with a mesh at its nodes (n,) [degrees C]."""
        return {die.name: arrays.dies[self._own(die.nodes)] for die in self._dies.dies}

    def stored(self, arrays: HeatArrays) -> float:
        """Return the heat that the bodies have stored since the start [N mm]."""
        return float(self._gain(arrays)[: self._n_points].sum())

    def stored_in_bodies(self, arrays: HeatArrays) -> FloatArray:
        """Return the heat that each body has stored since the start (n_bodies,) [N mm]."""
        gain = self._gain(arrays)
        return np.array([gain[own.start : own.stop].sum() for own in self._bodies()])

    def _bodies(self) -> list[range]:
        """Return the nodes of each body."""
        return [body.points for body in self._model.bodies] or [range(self._n_points)]

    def stored_in_dies(self, arrays: HeatArrays) -> float:
        """Return the heat that the tools with meshes have stored since the start [N mm]."""
        return float(self._gain(arrays)[self._n_points :].sum())

    def _gain(self, arrays: HeatArrays) -> FloatArray:
        now, _ = self._equation.conduction.content(_together(arrays))
        start = np.concatenate([start_temperatures(self._model, self._heat), self._dies.at_rest()])
        before, _ = self._equation.conduction.content(start)
        return now - before

    def to_points(self, block: int, temperature: FloatArray) -> FloatArray:
        """Return temperatures of the nodes (n_points,) at a block's points (n_cells, p) [degrees C]."""
        return self._shapes.to_points(block, temperature)

    def keep_stored(self, arrays: HeatArrays, stored: FloatArray, new: BoolArray) -> None:
        """Bring temperatures carried to this mesh to the heat that each body has stored since the start.

        stored: (n_bodies,) [N mm]; new: nodes (n_points,). What a body lacks goes to its nodes in proportion to the
        range of temperature in the cells round them, where carrying errs: an even temperature stays. A body that keeps
        its mesh keeps its temperatures; its mass is counted anew in its present shape, and the others balance the
        difference.
        """
        conduction, carried = self._equation.conduction, arrays.temperature.copy()
        span = np.zeros(len(carried))
        for block in self._model.mesh.blocks:
            own = carried[block.connectivity]
            np.maximum.at(span, block.connectivity, np.ptp(own, axis=1)[:, None])
        span *= new
        bodies = [slice(nodes.start, nodes.stop) for nodes in self._bodies()]
        change = np.zeros(len(bodies))
        for _ in range(_CONTENT_ROUNDS if span.max() > 0.0 else 0):
            _, slope = conduction.content(_together(arrays))
            lacking = stored - self.stored_in_bodies(arrays)
            answer = np.array([slope[nodes] @ span[nodes] for nodes in bodies])
            able = answer > 0.0
            lacking[able] += float(lacking[~able].sum()) * answer[able] / float(answer.sum())
            change[able] += lacking[able] / answer[able]
            for nodes, more in zip(bodies, change.tolist(), strict=True):
                arrays.temperature[nodes] = carried[nodes] + more * span[nodes]

    @staticmethod
    def begin_stage(arrays: HeatArrays) -> None:
        """Forget the rate: what heats and cools jumps where a stage begins."""
        arrays.rate, arrays.die_rate = np.zeros_like(arrays.rate), np.zeros_like(arrays.die_rate)
        arrays.last_step = arrays.next_step = 0.0

    def rest(self, arrays_n: HeatArrays, points: FloatArray, poses: Poses, duration: float) -> HeatArrays:
        """Return the arrays after a time [s] in which the tools with meshes lie open without a workpiece.

        points: of the bodies (n_points, 2) [mm]. Raises GaveUpError where heat finds no balance.
        """
        arrays, n = arrays_n.duplicate(), self._n_points
        self.begin_stage(arrays)
        if duration == 0.0:
            return arrays
        mask, held = self._dies.mask.copy(), self._dies.held.copy()
        mask[:n], held[:n] = 1, arrays.temperature
        places = self._dies.place(points, poses)
        problem = HeatProblem(
            points=places,
            temperature_n=_together(arrays),
            dt=duration,
            films=self._surface.find_open(places),
            time=duration,
            mask=mask,
            prescribed=held,
            counted=n,
        )
        self._equation.couple(_NO_PAIRS)
        heat = np.zeros((2, len(KINDS)))
        found = self._take_steps(arrays, problem, [], np.zeros((len(poses), n)), heat)
        if isinstance(found, Failed):
            raise GaveUpError(f"the pause between parts: {found.reason}")
        arrays.dies, arrays.die_heat = found.temperature[n:], arrays.die_heat + heat[1, : len(DIE_KINDS)]
        return arrays

    def advance(self, arrays_n: HeatArrays, now: FormingInstant, dt: float) -> HeatArrays | Failed:
        """Return the arrays after an increment of dt [s], or why heat finds no balance."""
        places = self._dies.place(now.points, now.poses)
        surface = self._surface.find(now, places)
        made = self._sources.find(now, surface)
        between = [meeting.film for meeting in surface.meetings] + [film for film, _ in surface.links.values()]
        self._equation.couple(np.concatenate([film.pairs for film in between]) if between else _NO_PAIRS)
        source = np.zeros(self._dies.n_points)
        for t, (film, area) in surface.links.items():
            own = np.zeros(self._dies.n_points)
            own[: self._n_points] = made.into_tools[t]
            source += pass_on(film.pairs, area, own)
        friction_heat = float(source.sum()) if surface.links else 0.0
        source[: self._n_points] += made.plastic + made.friction
        problem = HeatProblem(
            points=places,
            temperature_n=_together(arrays_n),
            dt=dt,
            films=[*between, *surface.around],
            time=dt,
            mask=self._dies.mask,
            prescribed=self._dies.held,
            source=source / dt,
            counted=self._n_points,
        )
        heat = np.zeros((2, len(KINDS)))
        found = self._take_steps(arrays_n, problem, surface.touches, made.into_tools / dt, heat)
        if isinstance(found, Failed):
            return found
        heat[0, :2] = made.plastic.sum(), made.friction.sum()
        heat[1, 0] = friction_heat
        return self._collect(arrays_n, found, heat)

    def _take_steps(
        self,
        arrays: HeatArrays,
        problem: HeatProblem,
        touches: list[Touch],
        friction_heat: FloatArray,
        heat: FloatArray,
    ) -> _Instant | Failed:
        """Go through an increment in time steps that follow their error; adds up the heat (2, n_kinds) [N mm]."""
        dt, films = problem.dt, problem.films
        rate = np.concatenate([arrays.rate, arrays.die_rate])
        now = _Instant(problem.temperature_n, rate, arrays.columns, arrays.phases, arrays.last_step, arrays.next_step)
        done, part = 0.0, min(dt, now.next_step or FIRST_PART * dt)
        while True:
            part = dt - done if done + part > dt * (1 - 1e-9) else min(part, 0.5 * (dt - done) + 0.5 * part)
            columns, chilled = self._chill(touches, now.columns, friction_heat, part)
            at_tools: list[Film] = [
                ToolFilm(t.nodes, t.area * t.conductance, t.heat.temperature)
                for t in touches
                if t.tool not in chilled and t.heat.die is None
            ]
            phases, latent = self._phases.grow(now.phases, now.temperature, part)
            asked = replace(
                problem, temperature_n=now.temperature, dt=part, films=[*at_tools, *chilled.values(), *latent, *films]
            )
            found = self._equation.solve(asked, now.temperature + part * now.rate)
            if isinstance(found, Failed):
                part *= found.factor
                if part < SMALLEST_PART * dt:
                    return Failed(IterationLog(), f"{found.reason} in a time step of {part:.1e} s", 0.5)
                continue
            error = self._estimate_error(now, found, part)
            factor = min(max(SAFETY * sqrt(self._heat.tolerance / error), SHRINK), GROWTH) if error else GROWTH
            if error > REFUSED * self._heat.tolerance and part > SMALLEST_PART * dt:
                part *= factor
                continue
            done += part
            heat += part * _count(found)
            for t, film in chilled.items():
                columns[t, film.nodes] = film.finish(found.temperature)
            rate = (found.temperature - now.temperature) / part
            cut_short = part < now.next_step and factor >= 1.0
            wanted = max(part * factor, now.next_step) if cut_short else part * factor
            phases = self._phases.finish(phases, found.temperature)
            now = _Instant(found.temperature, rate, columns, phases, part, wanted)
            if done > dt * (1 - 1e-9):
                return now
            part = wanted

    @staticmethod
    def _estimate_error(now: _Instant, found: HeatStep, part: float) -> float:
        """Return the largest error of a time step [K]; where a stage begins half the change (docs/theory/heat.md)."""
        foretold = now.temperature + part * now.rate
        return float(np.abs(found.temperature - foretold).max()) * part / (2 * part + now.last_step)

    def _collect(self, before: HeatArrays, found: _Instant, heat: FloatArray) -> HeatArrays:
        n = self._n_points
        return HeatArrays(
            temperature=found.temperature[:n],
            rate=found.rate[:n],
            heat=before.heat + heat[0],
            columns=found.columns,
            dies=found.temperature[n:],
            die_rate=found.rate[n:],
            die_heat=before.die_heat + heat[1, : len(DIE_KINDS)],
            phases=found.phases,
            reached=widen(before.reached, measure_ranges(self._model, found.temperature)),
            last_step=found.last_step,
            next_step=found.next_step,
        )

    def _chill(
        self, touches: list[Touch], columns: FloatArray, friction_heat: FloatArray, dt: float
    ) -> tuple[FloatArray, dict[int, ColumnFilm]]:
        """Return the columns after a time step of dt [s] without a flux, and the films of tools that warm up.

        friction_heat: (n_tools, n_points) [N mm/s].
        """
        still, films = columns.copy(), {}
        touched = {touch.tool: touch for touch in touches}
        for t, tool in enumerate(self._model.tools):
            column, touch = self._columns.get(tool.name), touched.get(t)
            if column is None:
                continue
            still[t, self._skin], answer = column.step(columns[t, self._skin], dt)
            if touch is not None:
                flux = friction_heat[t, touch.nodes] / touch.area
                own = still[t, touch.nodes]
                films[t] = ColumnFilm(column, touch.nodes, touch.area, touch.conductance, own, answer, flux)
        return still, films


def _together(arrays: HeatArrays) -> FloatArray:
    """Return the temperatures of bodies and dies."""
    return np.concatenate([arrays.temperature, arrays.dies])


def _count(found: HeatStep) -> FloatArray:
    """Return the power that came into bodies by KINDS and into dies by DIE_KINDS, then 0 (2, 6) [N mm/s]."""
    none = np.zeros(2)
    power = {**found.power, "contact": found.power.get("dies", none)}
    into_bodies = [power.get(kind, none)[0] for kind in KINDS]
    into_bodies[2] += power["contact"][0]
    return np.array([into_bodies, [*(power.get(kind, none)[1] for kind in DIE_KINDS), 0.0]])


def start_temperatures(model: Model, heat: Heat) -> FloatArray:
    """Return the temperatures of the nodes at the start (n_points,) [degrees C]."""
    temperature = np.full(len(model.mesh.points), heat.initial[0])
    for body, value in zip(model.bodies, heat.initial, strict=False):
        temperature[body.points.start : body.points.stop] = value
    return temperature
