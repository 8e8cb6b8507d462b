# SPDX-License-Identifier: Apache-2.0
"""The tools of a stamping at work: stroke by stage, forces over the whole process, what each feels on the mean."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from presswork import _core
from presswork.explicit.motion import DrivenStroke, Motion, SmoothStroke
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.tools import RigidTool
from presswork.fields.formability_fields import describe_judged
from presswork.formability import Info
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.thickness_rule import thickness_rule
from presswork.mesh.tool_clearance import find_clearance
from presswork.model import (
    Drawbead,
    ExplicitSheet,
    FloatArray,
    Model,
    PressureCourse,
    SheetPressure,
    Stage,
    Tool,
    ToolMotion,
)
from presswork.observe.contract import Row
from presswork.process.mesh_change.refinement import PlacedTool
from presswork.process.space_surfaces import SHEET_CHORD

FORCE_TIMES = 100
"""Number of times in each stage at which a force over the stroke is tabulated."""
BEAD_POINTS = 2000
"""Number of points of all beads that results keep: an attribute of HDF5 has 64 kB."""


class StampingTools:
    """Adds a model's tools and beads to the shells, and moves them."""

    def __init__(
        self, model: Model, shells: ExplicitShells, before: StampingTools | None = None, *, sag: float = 0.0
    ) -> None:
        """before: the same tools on another mesh of the blank, whose surfaces and masses are taken over.

        sag: of the arcs of a bent part's edges off their chords, at most [mm].
        """
        self._model = model
        self._surfaces: list[_core.ToolSurface] = (
            before._surfaces if before else [make_surface(t.surface) for t in model.tools]
        )
        assert isinstance(model.explicit, ExplicitSheet)
        edges, each = model.explicit.contact_points == "edges", zip(model.tools, self._surfaces, strict=True)
        self._tools = [
            shells.add_tool(t.name, surface, mu=float(t.friction.mu), edges=edges, sag=sag) for t, surface in each
        ]
        for tool, at_work in zip(model.tools, self._tools, strict=True):
            at_work.position = tool.position
        # a resumed run takes the same
        self._pushing_mass: float = before._pushing_mass if before else float(shells.mass[:, 0].sum())
        self._stops: dict[str, tuple[str, float]] = before._stops if before else find_stops(model)
        self._shells = shells
        for bead in model.beads:
            shells.add_bead(bead, tabulate_share(model, bead))
        self._mean = np.zeros((len(model.tools), 3))
        self._restraint = np.zeros(len(model.beads))
        self._samples = 0

    @property
    def at_work(self) -> list[RigidTool]:
        """The tools in the order of the model's."""
        return self._tools

    @property
    def hold_sheet(self) -> bool:
        """Whether a tool touches the sheet, or a bead restrains it."""
        beads = (self._shells.bead_restraint(bead.name) for bead in self._model.beads)
        return any(tool.force.any() for tool in self._tools) or any(beads)

    def placed(self) -> list[PlacedTool]:
        """Return the tools where they stand."""
        return [PlacedTool(s, tool.position) for s, tool in zip(self._surfaces, self._tools, strict=True)]

    def begin_stage(self, number: int) -> None:
        """Let the tools move, push or stand still as in the stage; the speed of strokes is a stroke in its time."""
        stages = self._model.stages
        for tool, at_work in zip(self._model.tools, self._tools, strict=True):
            at_work.stop()
            if is_pushed_in(self._model, tool, number):
                times, forces = tabulate_force(self._model, tool.name)
                at_work.push(
                    working_direction_of(tool),
                    (times, forces / self._model.whole),
                    mass=self._pushing_mass,
                    stop=self._stop_in(tool, number),
                )
                continue
            motion = stages[number].tool_motion.get(tool.name) if number < len(stages) else None
            at_work.velocity = np.array((motion or ToolMotion()).move)

    def _stop_in(self, tool: Tool, number: int) -> tuple[RigidTool, float] | None:
        if tool.name not in self._stops:
            return None
        name, clearance = self._stops[tool.name]
        index = [t.name for t in self._model.tools].index(name)
        other = self._model.tools[index]
        if is_pushed_in(self._model, other, number):
            return None
        return self._tools[index], float(
            np.subtract(tool.position, other.position) @ working_direction_of(tool)
        ) + clearance

    def begin_row(self) -> None:
        """Forget the forces felt so far."""
        self._mean[:], self._restraint[:], self._samples = 0.0, 0.0, 0

    def sample(self) -> None:
        """Note what every tool feels now."""
        self._samples += 1
        for mean, tool in zip(self._mean, self._tools, strict=True):
            mean += (tool.force - mean) / self._samples
        restraint = [self._shells.bead_restraint(bead.name) for bead in self._model.beads]
        self._restraint += (np.array(restraint) - self._restraint) / self._samples

    def forces(self) -> FloatArray:
        """Return the mean force of the sheet on each whole tool since begin_row (n_tools, 3) [N]."""
        return make_whole(self._model, self._mean)

    def row(self) -> Row:
        """Return the columns of the history."""
        tools = tool_columns(self._model, self.displacement(), self.forces())
        return tools | bead_columns(self._model, self._restraint.tolist())

    def text(self) -> str:
        """Name the tools with their strokes and forces."""
        return tool_text(self._model, self.row())

    def displacement(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the start (3,) [mm]."""
        each = zip(self._model.tools, self._tools, strict=True)
        return {t.name: at_work.position - np.asarray(t.position) for t, at_work in each}


def make_whole(model: Model, forces: FloatArray) -> FloatArray:
    """Return the forces on whole tools of those on what is modelled (n_tools, 3) [N]."""
    whole = forces * model.whole
    for axis, is_cut in enumerate(model.symmetry):
        if is_cut:  # what the mirror images feel takes it away
            whole[:, axis] = 0.0
    return whole


def tool_columns(model: Model, displacement: Mapping[str, FloatArray], forces: FloatArray) -> Row:
    """Return the history's columns of all tools: stroke along its direction [mm], force along it and in space [N].

    displacement: of each tool since the start (3,) [mm]. forces: of the sheet on the whole tools (n_tools, 3) [N].
    """
    row: Row = {}
    for tool, force in zip(model.tools, forces, strict=True):
        direction = np.asarray(tool.working_direction)
        row[f"{tool.name}.stroke"] = float(displacement[tool.name] @ direction) + 0.0
        row[f"{tool.name}.force"] = -float(force @ direction) + 0.0
        row |= {f"{tool.name}.force_{axis}": float(f) for axis, f in zip("xyz", force, strict=True)}
    return row


def bead_columns(model: Model, forces: Sequence[float]) -> Row:
    """Return the history's columns of all beads: restraining force, summed along the line [N], of what is modelled."""
    return {f"{b.name}.force": f * model.whole + 0.0 for b, f in zip(model.beads, forces, strict=True)}


def tool_text(model: Model, row: Row) -> str:
    """Name the tools that have moved, with strokes and forces."""
    each = [(t.name, float(row[f"{t.name}.stroke"]), float(row[f"{t.name}.force"])) for t in model.tools]
    return "  ".join(f"{name} {stroke:.2f} mm {force / 1e3:.1f} kN" for name, stroke, force in each if stroke)


def describe_stamping(model: Model) -> Info:
    """Return what results store about a stamping."""
    planes = "".join(name for name, is_cut in zip("xy", model.symmetry, strict=True) if is_cut)
    described: dict[str, str | float | FloatArray] = {"title": model.title, "analysis": "stamping", "symmetry": planes}
    beads = [*model.beads, *(bead for operation in model.following for bead in operation.beads)]
    if beads:
        described["beads"] = "\n".join(bead.name for bead in beads)
        described["bead_points"] = _thin([bead.place for bead in beads])
    return {**described, **describe_sheet(model), "whole": float(model.whole), **describe_judged(model)}


def describe_sheet(model: Model) -> Info:
    """Return what results store about a sheet: where its layers lie, its rolling direction and elasticity."""
    section, material = model.sheet
    return {
        "layers": thickness_rule(section)[0],
        "rolling": np.array(model.rolling_direction, dtype=float),
        "young": float(material.young),
        "poisson": float(material.poisson),
    }


def _thin(lines: Sequence[FloatArray]) -> FloatArray:
    """Return number of the line, x and y of points of lines in the plan (n, 3), no more than a results file takes."""
    points = np.concatenate([np.column_stack([np.full(len(line), i), line]) for i, line in enumerate(lines)])
    return points[:: 1 + len(points) // BEAD_POINTS]


def working_direction_of(tool: Tool) -> tuple[float, float, float]:
    """Return the unit vector along which a tool of a stamping works."""
    assert tool.working_direction is not None, f"{tool.name} has no way"
    return tool.working_direction


def is_pushed(model: Model, tool: Tool) -> bool:
    """Return whether a force places the tool."""
    return any((m := s.tool_motion.get(tool.name)) is not None and m.push is not None for s in model.stages)


def is_pushed_in(model: Model, tool: Tool, number: int) -> bool:
    """Return whether a force places the tool in a stage: the last stage up to this one that names it pushes it."""
    named = [m for s in model.stages[: number + 1] if (m := s.tool_motion.get(tool.name)) is not None]
    return bool(named) and named[-1].push is not None


def find_stops(model: Model) -> dict[str, tuple[str, float]]:
    """Return on which other tool a pushed holder or die comes to rest, bare, and after which travel [mm].

    The other has then not moved. Tools that cannot strike are left out.
    """
    found: dict[str, tuple[str, float]] = {}
    for tool, other in itertools.permutations(model.tools, 2):
        if not is_pushed(model, tool) or {tool.kind, other.kind} != {"holder", "die"}:
            continue
        between, direction = np.subtract(tool.position, other.position), np.array(tool.working_direction)
        clearance = find_clearance(tool.surface, other.surface, between, direction, SHEET_CHORD * model.thickest)
        if clearance < found.get(tool.name, ("", math.inf))[1]:
            found[tool.name] = other.name, clearance
    return found


def tabulate_force(model: Model, name: str) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and forces [N] of a pushed tool on the sheet over the whole process.

    At the start of each stage the force goes over to the stage's own within its ramp; before the first it is zero, and
    a stage without a force keeps it. What closes beads is taken off a holder's.
    """

    def force_in(stage: Stage, at: FloatArray) -> FloatArray | None:
        motion = stage.tool_motion.get(name)
        if motion is None:
            return None
        if motion.push is None:  # it is moved
            return np.zeros(len(at))
        return np.interp(stroke_of(stage).position(at), *motion.push.force.T)

    times, forces = _tabulate(model, force_in)
    if any(t.name == name and t.kind == "holder" for t in model.tools):
        for bead in model.beads:
            closing = model.whole * bead.closing_force * float(bead.length.sum())
            forces = np.maximum(forces - closing * tabulate_share(model, bead)[1], 0.0)
    return times, forces


def tabulate_share(model: Model, bead: Drawbead) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and shares of a bead's force over the whole process; it goes over within a stage's ramp."""
    return _tabulate(model, lambda stage, at: np.interp(stroke_of(stage).position(at), *stage.bead_share[bead.name].T))


def share_pressures(model: Model) -> tuple[SheetPressure, ...]:
    """Return the pressures on the sheet, fluids with the room of what is modelled."""
    return tuple(
        pressure
        if pressure.fluid is None
        else replace(pressure, fluid=replace(pressure.fluid, room=pressure.fluid.room / model.whole))
        for pressure in model.sheet_pressures
    )


def sample_over_travel(model: Model, stage: Stage) -> dict[str, PressureCourse]:
    """Return the courses of share_pressures over the travel of a stage, those of its time sampled so."""
    found = {}
    for pressure in model.sheet_pressures:
        course = stage.pressure_course[pressure.name]
        parts, values = course.rows.T
        gone = parts
        if course.over == "time":
            parts = np.union1d(np.linspace(0.0, 1.0, FORCE_TIMES + 1), parts)
            values, gone = np.interp(parts, *course.rows.T), stroke_of(stage).position(parts * stage.duration)
        share = 1.0 if pressure.fluid is None else 1.0 / model.whole
        found[pressure.name] = PressureCourse(np.column_stack([gone, share * values]), held=course.held)
    return found


def tabulate_pressure(model: Model, name: str) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and values of a pressure on the sheet over the whole process, as its courses have them."""
    times, values, begin = [], [], 0.0
    for stage in model.stages:
        course = stage.pressure_course[name]
        parts = np.linspace(0.0, 1.0, FORCE_TIMES + 1)
        if course.over == "time":
            parts = gone = np.union1d(parts, course.rows[:, 0])
        else:
            gone = stroke_of(stage).position(parts * stage.duration)
        times.append(begin + parts * stage.duration)
        values.append(np.interp(gone, *course.rows.T))
        begin += stage.duration
    all_times, first = np.unique(np.concatenate(times), return_index=True)
    return all_times, np.concatenate(values)[first]


def _tabulate(
    model: Model, value_in: Callable[[Stage, FloatArray], FloatArray | None]
) -> tuple[FloatArray, FloatArray]:
    """Return times and values over the whole process.

    value_in: gives those of a stage at times since it began, or None where the value stays as it is.
    """
    times, values = [np.zeros(1)], [np.zeros(1)]
    begin, value_n = 0.0, 0.0
    for stage in model.stages:
        at = np.linspace(0.0, stage.duration, FORCE_TIMES + 1)[1:]
        own = value_in(stage, at)
        own = np.full(len(at), value_n) if own is None else own
        blend = np.minimum(at / stage.ramp, 1.0)
        own = (1 - blend) * value_n + blend * own
        times.append(begin + at)
        values.append(own)
        begin, value_n = begin + stage.duration, float(own[-1])
    return np.concatenate(times), np.concatenate(values)


def by_stage(model: Model, times: FloatArray, values: FloatArray) -> list[FloatArray]:
    """Return rows of completed travel (0 to 1) and value (n, 2) for each stage, of a table over the process."""
    rows, begin = [], 0.0
    for stage in model.stages:
        end = begin + stage.duration
        own = (times >= begin - 1e-12 * end) & (times <= end * (1 + 1e-12))
        rows.append(np.column_stack([stroke_of(stage).position(times[own] - begin), values[own]]))
        begin = end
    return rows


def stroke_of(stage: Stage) -> Motion:
    """Return the completed part of the travel of all that moves in a stage, 0 to 1, as a motion in time."""
    if stage.drive is not None:
        return DrivenStroke(stage.drive)
    return SmoothStroke(1.0, stage.duration, rise=stage.ramp / stage.duration)


def mean_speeds(stage: Stage, start: float, end: float, n: int) -> FloatArray:
    """Return the mean rate at which travel is completed in each of n equal steps from start to end (n,) [1/s]."""
    gone = stroke_of(stage).position(np.linspace(start, end, n + 1))
    return np.asarray(np.diff(gone) * n / (end - start))
