# SPDX-License-Identifier: Apache-2.0
"""Heat of a sheet as it is stamped: what its faces exchange with tools and surroundings, found anew in every increment.

Staggered with the mechanics, which take the temperatures at the start of the increment. It is the same for implicit
increments and for rows of explicit cycles: both describe the sheet as a `SheetInstant` (docs/theory/sheet_heat.md).
Time is that of the process, however fast the tools are driven.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswork.body.sheet_heat import SheetConduction
from presswork.evolution.hardness import HARDNESS_AT, find_hardness
from presswork.evolution.kinetics import Kinetics
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.heat.chilled_tool import CELLS, Column, ColumnFilm
from presswork.interaction.heat.heat_films import Film, ToolFilm, interpolate, make_surroundings
from presswork.model import PHASES, Dwell, FloatArray, IntArray, Model, ToolHeat
from presswork.outcome import GaveUpError
from presswork.state import Arrays

KINDS = ("plastic", "friction", "tools", "convection", "radiation", "latent")
"""What heats and cools a sheet."""
NEAR = 0.01
"""Part of the thickness: a face that is nearer to a tool touches it, if without pressure."""
GROWTH, MARGIN = 2.0, 0.9
SMALLEST = 1e-9
"""Part of an increment below which no time step is tried."""


@dataclass
class SheetHeatArrays(Arrays):
    """Temperatures of a sheet, what its austenite has become, and the heat that has come in."""

    owner = "sheet_heat"
    temperature: FloatArray
    """Temperature through the thickness from the bottom up (levels, n_points) [degrees C]."""
    fractions: FloatArray
    """Fractions of PHASES (4, levels, n_points)."""
    cooling_rate: FloatArray
    """When 700 degrees C were passed; 0: not yet (levels, n_points) [K/s]."""
    heat: FloatArray
    """Since the start, by KINDS (6,) [N mm]."""
    columns: FloatArray
    """Temperatures of the steel of every tool behind every node, from the surface on (n_tools, n_points, CELLS)
    [degrees C]; no tools where none warms up."""
    pressure: FloatArray
    """Pressure of every tool on every node in the last increment that formed (n_tools, n_points) [MPa]."""
    step: float
    """Time step that is tried next [s]."""


@dataclass(frozen=True)
class SheetInstant:
    """A sheet between its tools at the end of an increment, and what the increment has done."""

    points: FloatArray
    """(n_points, 3) [mm]."""
    thickness: FloatArray
    """Thickness of the cells (n_cells,) [mm]."""
    tools: FloatArray
    """Positions of the tools' frames (n_tools, 3) [mm]."""
    force: FloatArray
    """Mean force of each tool on the nodes (n_tools, n_points, 3) [N]."""
    slip: FloatArray
    """Way of the nodes along each tool in the increment (n_tools, n_points, 3) [mm]."""
    plastic: FloatArray
    """Plastic work of the increment (levels, n_points) [N mm]."""


@dataclass(frozen=True)
class _Touch:
    tool: int
    level: int
    nodes: IntArray
    area: FloatArray
    conductance: FloatArray
    """[N/(mm s K)]"""


@dataclass(frozen=True)
class _Faces:
    """What the faces exchange in an increment."""

    touches: list[_Touch]
    free: list[FloatArray]
    """Areas free of tools at bottom and top (n_points,) [mm2]."""
    pressure: FloatArray
    """Pressure of the tools (n_tools, n_points) [MPa]."""
    friction: FloatArray
    """Heat of friction in the sheet (levels, n_points) [N mm]."""
    friction_work: FloatArray
    """Heat of friction in the tools (n_tools, n_points) [N mm]."""


class _OnFace:
    """A film of nodes on one face of the sheet."""

    def __init__(self, film: Film, level: int) -> None:
        self._film, self.kind, self.level = film.at(0.0), film.kind, level

    def evaluate(self, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heat into the nodes and minus its derivative."""
        return self._film.evaluate(temperature)


class HeatOfSheet:
    """Conducts heat in a sheet between rigid tools."""

    def __init__(self, model: Model) -> None:
        assert model.heat is not None
        self._model, self._heat = model, model.heat
        section, material = model.sheet
        if material.thermal is None:
            raise ValueError(f"the material {material.name} has no thermal properties")
        self._steel = Kinetics(material.transformation) if material.transformation else None
        self.conduction = SheetConduction(
            model.mesh.points, model.cells, material.thermal, section.thickness, model.heat.levels, self._steel
        )
        self._thickness = section.thickness
        self._tools = [model.heat.tools.get(tool.name) for tool in model.space_tools]
        self._surfaces = [make_surface(tool.surface) for tool in model.space_tools]
        usual = 0.02 * min(s.duration * s.slower for s in model.stages)
        self._columns = [Column(*t.steel, usual) if t is not None and t.steel else None for t in self._tools]
        self._dwelt: tuple[Dwell, tuple[FloatArray, ...], _Faces] | None = None

    @property
    def has_phases(self) -> bool:
        """Whether transformations are computed."""
        return self._steel is not None

    def at_rest(self) -> SheetHeatArrays:
        """Return the temperatures at the start."""
        levels, n = self.conduction.levels, self.conduction.n_points
        warm = [i for i, column in enumerate(self._columns) if column is not None]
        columns = np.zeros((len(self._tools) if warm else 0, n, CELLS))
        for i in warm:
            tool = self._tools[i]
            assert tool is not None
            columns[i] = tool.temperature
        return SheetHeatArrays(
            temperature=np.full((levels, n), self._heat.initial[0]),
            fractions=np.zeros((4, levels, n)),
            cooling_rate=np.zeros((levels, n)),
            heat=np.zeros(len(KINDS)),
            columns=columns,
            pressure=np.zeros((len(self._tools), n)),
            step=min(s.duration * s.slower for s in self._model.stages) * self._heat.initial_step,
        )

    def fields(self, arrays: SheetHeatArrays) -> dict[str, FloatArray]:
        """Return temperatures, phases, hardness and cooling rate at the nodes by the names of their fields (n_points,).

        Those without a place are means through the thickness.
        """
        t, share = arrays.temperature, self.conduction.share
        middle = 0.5 * (t[(len(t) - 1) // 2] + t[len(t) // 2])
        found = {"temperature_bottom": t[0], "temperature_middle": middle, "temperature_top": t[-1]}
        steel = self._model.sheet[1].transformation
        if steel is None:
            return found
        found |= {name: share @ part for name, part in zip(PHASES, arrays.fractions, strict=True)}
        found["cooling_rate"] = share @ arrays.cooling_rate
        if steel.composition:
            found["hardness"] = share @ find_hardness(steel.composition, arrays.fractions, arrays.cooling_rate)
        return found

    def mean_at_nodes(self, arrays: SheetHeatArrays) -> FloatArray:
        """Return the mean temperature through the thickness (n_points,) [degrees C]."""
        return np.asarray(self.conduction.share @ arrays.temperature)

    def stored(self, arrays: SheetHeatArrays) -> float:
        """Return the heat stored since the start [N mm]; what transformations set free came in from outside."""
        start = np.full_like(arrays.temperature, self._heat.initial[0])
        return float((self.conduction.content(arrays.temperature) - self.conduction.content(start)).sum())

    def hottest(self, arrays: SheetHeatArrays) -> dict[str, float]:
        """Return the highest temperature at the surface of every tool that warms up [degrees C]."""
        names = [tool.name for tool in self._model.space_tools]
        each = enumerate(self._columns)
        return {names[i]: float(arrays.columns[i, :, 0].max()) for i, column in each if column is not None}

    def advance(self, arrays_n: SheetHeatArrays, now: SheetInstant, dt: float, dwell: Dwell | None) -> SheetHeatArrays:
        """Return the arrays after dt [s] of the process. Raises GaveUpError if there is no balance of heat."""
        self.conduction.update(now.points, now.thickness)
        faces = self._find_faces(arrays_n, now, dwell) if dwell is None else self._keep_faces(arrays_n, now, dwell)
        made = (self._heat.plastic_fraction * now.plastic + faces.friction) / dt
        around = self._heat.surroundings
        surfaces = [
            _OnFace(film, level)
            for level, area in zip((0, -1), faces.free, strict=True)
            for film in (make_surroundings(around, area) if around else [])
        ]
        temperature, fractions = arrays_n.temperature, arrays_n.fractions
        cooling, columns, heat = arrays_n.cooling_rate, arrays_n.columns, np.zeros(len(KINDS))
        time, size = 0.0, arrays_n.step
        while time < dt * (1 - 1e-12):
            left = int(np.ceil((dt - time) / size * (1 - 1e-9)))
            part = (dt - time) / left
            still, chilled = self._chill(faces, columns, dt, part)
            films = [*self._touching(faces.touches, chilled), *surfaces]
            found = self.conduction.step(temperature, fractions, part, films, made)
            if found is None or found.error > 2.0 * self._heat.tolerance:
                size = 0.25 * part if found is None else part * self._grow(found.error)
                if size < SMALLEST * dt:
                    raise GaveUpError(f"no balance of heat in a time step of {part:.2e} s")
                continue
            for touch, film in zip(faces.touches, chilled, strict=True):
                if film is not None:
                    still[touch.tool, touch.nodes] = film.finish(found.temperature[touch.level])
            columns = still
            passed = (temperature > HARDNESS_AT) & (found.temperature <= HARDNESS_AT)
            cooling = np.where(passed, (temperature - found.temperature) / part, cooling)
            temperature, fractions, time = found.temperature, found.fractions, time + part
            heat += part * np.array([found.power.get(kind, 0.0) for kind in KINDS])
            wished = part * self._grow(found.error)
            size = max(size, wished) if left == 1 and wished >= part else wished
        heat[:2] = self._heat.plastic_fraction * now.plastic.sum(), faces.friction.sum()
        total = arrays_n.heat + heat
        return SheetHeatArrays(temperature, fractions, cooling, total, columns, faces.pressure, size)

    def _grow(self, error: float) -> float:
        """Return by what the time step is changed after an error [K]."""
        return float(np.clip(MARGIN * np.sqrt(self._heat.tolerance / max(error, 1e-12)), 0.2, GROWTH))

    def _keep_faces(self, arrays_n: SheetHeatArrays, now: SheetInstant, dwell: Dwell) -> _Faces:
        """Return what the faces exchange in a dwell, in which nothing moves: found once for all its increments."""
        asked = now.points, now.tools, arrays_n.pressure
        if self._dwelt is None or self._dwelt[0] != dwell or not all(map(np.array_equal, self._dwelt[1], asked)):
            self._dwelt = dwell, tuple(each.copy() for each in asked), self._find_faces(arrays_n, now, dwell)
        return self._dwelt[2]

    def _find_faces(self, arrays_n: SheetHeatArrays, now: SheetInstant, dwell: Dwell | None) -> _Faces:
        """Return what the faces of the sheet exchange in an increment."""
        n, area = self.conduction.n_points, self.conduction.area
        shape = (len(self._tools), n)
        faces = _Faces([], [area, area], np.zeros(shape), np.zeros((self.conduction.levels, n)), np.zeros(shape))
        if dwell is not None and not dwell.in_tools:
            return replace(faces, pressure=arrays_n.pressure)
        best, owner, passes = np.zeros((2, n)), np.full((2, n), -1), np.zeros((2, n))
        for t, tool in enumerate(self._tools):
            width = tool.gap if tool is not None else 0.0
            gap, normal = self._measure_gaps(t, now, max(width, NEAR * self._thickness))
            push = np.maximum(np.einsum("ni,ni->n", now.force[t], normal), 0.0)
            faces.pressure[t] = (
                arrays_n.pressure[t] if dwell else np.divide(push, area, out=np.zeros(n), where=area > 0)
            )
            touching = (faces.pressure[t] > 0.0) | (gap <= NEAR * self._thickness)
            side = np.where(np.einsum("ni,ni->n", normal, self.conduction.normal) < 0.0, 1, 0)
            if tool is not None:
                own = np.full(n, dwell.pressure) if dwell and dwell.pressure is not None else faces.pressure[t]
                across = np.clip(1.0 - gap / width, 0.0, 1.0) if width > 0.0 else np.zeros(n)
                part = np.where(touching, 1.0, across)
                conductance = part * interpolate(tool.conductance, np.where(touching, own, 0.0))[0]
                for face in (0, 1):
                    better = (side == face) & (conductance > best[face])
                    best[face][better], owner[face][better], passes[face][better] = conductance[better], t, part[better]
            if dwell is None:
                self._add_friction(faces, t, now, normal, side)
        for face, level in ((0, 0), (1, -1)):
            faces.free[face] = (1.0 - passes[face]) * area
            for t in range(len(self._tools)):
                nodes = np.flatnonzero(owner[face] == t).astype(np.int32)
                if len(nodes):
                    faces.touches.append(_Touch(t, level, nodes, area[nodes], best[face][nodes]))
        return faces

    def _add_friction(self, faces: _Faces, t: int, now: SheetInstant, normal: FloatArray, side: IntArray) -> None:
        """Add the friction heat of a tool; side: face of the sheet at which it lies (n_points,)."""
        pull = now.force[t] - np.einsum("ni,ni->n", now.force[t], normal)[:, None] * normal
        lost = np.maximum(-np.einsum("ni,ni->n", pull, now.slip[t]), 0.0)
        share = self._share(self._tools[t])
        faces.friction[0] += np.where(side == 0, share * lost, 0.0)
        faces.friction[-1] += np.where(side == 1, share * lost, 0.0)
        faces.friction_work[t] = (1.0 - share) * lost

    def _measure_gaps(self, t: int, now: SheetInstant, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the gaps of the sheet's face to a tool (n_points,) [mm], and the tool's normals (n_points, 3)."""
        half = 0.5 * self.conduction.thickness
        gap, normal, *_ = self._surfaces[t].nearest(now.points - now.tools[t], float(half.max()) + 2.0 * reach)
        return np.asarray(gap - half), np.where(np.isfinite(gap)[:, None], normal, 0.0)

    def _share(self, tool: ToolHeat | None) -> float:
        """Return the part of friction heat that goes into the sheet, by the effusivities of both."""
        if tool is None or tool.effusivity is None:
            return 0.5
        (own,) = self._heat.effusivity
        return own / (own + tool.effusivity)

    def _chill(
        self, faces: _Faces, columns: FloatArray, dt: float, part: float
    ) -> tuple[FloatArray, list[ColumnFilm | None]]:
        """Return the columns after a part [s] of an increment of dt [s] without a flux, and the film of each touch.

        A film is None where the tool stays as warm as it is.
        """
        still, answers = columns.copy(), {}
        for t, column in enumerate(self._columns):
            if column is not None:
                still[t], answers[t] = column.step(columns[t], part)
        films: list[ColumnFilm | None] = []
        for touch in faces.touches:
            column = self._columns[touch.tool]
            if column is None:
                films.append(None)
                continue
            own, flux = still[touch.tool, touch.nodes], faces.friction_work[touch.tool, touch.nodes] / (touch.area * dt)
            answer = answers[touch.tool]
            films.append(ColumnFilm(column, touch.nodes, touch.area, touch.conductance, own, answer, flux))
        return still, films

    def _touching(self, touches: Sequence[_Touch], chilled: Sequence[ColumnFilm | None]) -> list[_OnFace]:
        """Return the films of all touches."""
        films = []
        for touch, warm in zip(touches, chilled, strict=True):
            tool = self._tools[touch.tool]
            assert tool is not None
            film = warm or ToolFilm(touch.nodes, touch.area * touch.conductance, tool.temperature)
            films.append((film, touch.level))
        return [_OnFace(film, level) for film, level in films]
