# SPDX-License-Identifier: Apache-2.0
"""From the pressures of a stamping's case to the Model's, with what is refused of them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.law_needs import TIMING
from presswork.case.shell.schema import HOLDS
from presswork.case.stamping.plan_line import draw_line
from presswork.case.stamping.pressure import SheetPressure, StagePressure
from presswork.case.stamping.schema import StampingCase
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.pressed_cells import (
    find_area_vectors,
    find_middles,
    find_pressed_cells,
    measure_bulge,
    measure_rise,
)

UNTOUCHED = 0.5
"""Distance over the thickness within which a tool lies on a face."""
FACELESS = 1e-3
"""Share of its area below which a sheet has no upper face, and of its size by which it is flat."""
STRETCHED = 3.0
"""Area of a sheet over that of its blank beyond which it has torn."""
MIRRORED = 4.0
"""Most that a whole blank has of what is meshed of it."""
SAME = 1e-6
"""Part of a pressure by which a table may begin beside the end of the stage before."""


def check_pressures(case: StampingCase) -> list[Problem]:
    """Return the problems of pressures that show without geometry."""
    problems: list[Problem] = []
    for index, stage in enumerate(case.stages):
        for name in stage.pressure:
            key = f"stages.{index}.pressure.{name}"
            if name not in case.pressure:
                problems.append(Problem(key, "no such pressure", suggest(name, case.pressure, "pressures")))
            elif stage.dwell is not None:
                problems.append(Problem(key, "nothing moves in a dwell", "change the pressure in another stage"))
            else:
                problems += _check_kind(f"{key}.{stage.pressure[name].course}", name, case)
    named = {name for stage in case.stages for name in stage.pressure}
    for name in case.pressure:
        if name not in named:
            remedy = f'name it in a stage, [stages.pressure.{name}] with p = "8 MPa", or leave it out'
            problems.append(Problem(f"pressure.{name}", "no stage sets its value", remedy))
    problems += _check_rates(case)
    for name, each in case.pressure.items():
        key = f"pressure.{name}.seal"
        if each.seal and case.procedure == "explicit":
            remedy = 'set procedure = "implicit", or bound the pressure by a line alone'
            problems.append(Problem(key, "rings of contact are found by the implicit procedure alone", remedy))
        elif each.seal and not case.tools:
            problems.append(Problem(key, "there are no tools that could seal it", "leave it out, or add the die"))
        elif each.seal and any(name in stage.pressure and stage.pressure[name].rate for stage in case.stages):
            problems.append(Problem(key, "a pressure that holds a rate does not leak", "leave it out, or give p"))
    if case.pressure and case.gradients is not None:
        problems.append(Problem("gradients", "runs with pressure have no derivatives", "leave gradients out"))
    if case.pressure and case.procedure == "explicit" and case.explicit.device != "cpu":
        fault = "pressure on the sheet is computed by the CPU alone"
        problems.append(Problem("explicit.device", fault, 'take "cpu"', case.explicit.device))
    return problems


def _check_kind(key: str, name: str, case: StampingCase) -> Iterator[Problem]:
    """Yield the problem of a pressure that is given to a fluid, or of an inflow without a fluid."""
    is_inflow, fluid = ".inflow" in key, case.pressure[name].fluid
    if is_inflow and fluid is None:
        remedy = f'add pressure.{name}.fluid = {{stiffness = "2 GPa", room = "500 cm^3"}}, or give p'
        yield Problem(key, "there is no fluid that could flow in", remedy)
    elif not is_inflow and fluid is not None:
        yield Problem(
            key, "the pressure of a fluid with a volume is found", f"give inflow, or no pressure.{name}.fluid"
        )


def _check_rates(case: StampingCase) -> Iterator[Problem]:
    """Yield the problems of strain rates that a pressure is to hold."""
    for index, stage in enumerate(case.stages):
        for name, given in stage.pressure.items():
            key = f"stages.{index}.pressure.{name}"
            before = any(name in each.pressure and each.pressure[name].rate for each in case.stages[:index])
            if given.rate is None:
                if before:
                    fault = "the stage before has left a pressure that only the run knows"
                    yield Problem(f"{key}.{given.course}", fault, "give rate here, too, or p in the stage before")
                continue
            if case.procedure == "explicit":
                fault, remedy = "a strain rate is held by the implicit procedure alone", 'set procedure = "implicit"'
                yield Problem(f"{key}.rate", fault, remedy)
            elif not any(getattr(stage, each, None) for each in TIMING if each in stage.model_fields_set):
                yield Problem(f"stages.{index}.duration", "missing key: a strain rate takes time", "add it [s]")
            else:
                yield from _check_window(f"{key}.rate.target", given.rate.target, case)


def _check_window(key: str, target: float, case: StampingCase) -> Iterator[Problem]:
    """Yield the problem of a strain rate at which a law of the blank has no value, or that it does not depend on."""
    for name in dict.fromkeys(
        [case.blank.material, *(zone.material or case.blank.material for zone in case.blank.zones)]
    ):
        table = case.materials.get(name)
        hardening = getattr(table, "hardening", None)
        if isinstance(hardening, HotLaw):
            low, high = hardening.window()[1]
            if not low <= target <= high:
                fault = f"outside the window of materials.{name}.hardening, {low:g} to {high:g} 1/s"
                yield Problem(key, fault, "take a rate within it", target)
        elif hardening is not None and getattr(table, "rate", None) is None:
            fault = f"the flow stress of materials.{name} does not depend on the rate, so no pressure holds one"
            remedy = 'give it such a law, for instance hardening.law = "norton_hoff", or give p'
            yield Problem(key, fault, remedy, target)


def build_courses(case: StampingCase, stages: Sequence[model.Stage]) -> tuple[tuple[model.Stage, ...], list[Problem]]:
    """Return the Model's stages with the courses of all pressures, and the problems of their tables."""
    found, problems = [], []
    before = dict.fromkeys(case.pressure, 0.0)
    held: dict[str, model.HeldRate] = {}
    for index, (of_case, stage) in enumerate(zip(case.stages, stages, strict=True)):
        courses = {}
        for name in case.pressure:
            key = f"stages.{index}.pressure.{name}"
            given = of_case.pressure.get(name)
            if given is not None and given.rate is not None:
                held[name] = model.HeldRate(**given.rate.model_dump())
            if name in held:
                courses[name] = model.PressureCourse(np.array([[0.0, 0.0], [1.0, 0.0]]), held=held[name])
                continue
            course = _build_course(key, given, of_case.tools, stage, before[name])
            if isinstance(course, Problem):
                problems.append(course)
                continue
            courses[name] = course
            before[name] = float(np.interp(1.0, *course.rows.T))
            problems += _check_outflow(key, case.pressure[name], float(course.rows[:, 1].min()))
        found.append(replace(stage, pressure_course=courses))
    return tuple(found), problems


def _build_course(
    key: str, given: StagePressure | None, tools: Mapping[str, object], stage: model.Stage, before: float
) -> model.PressureCourse | Problem:
    """Return the course of a pressure over a stage, which begins with that before [MPa]; or what is wrong with it."""
    if given is None:
        return model.PressureCourse(np.array([[0.0, before], [1.0, before]]))
    start, unit = (before, "mm3") if given.course.startswith("inflow") else (0.0, "MPa")
    whole = getattr(given, given.course)
    if given.course in ("p", "inflow"):
        return model.PressureCourse(np.array([[0.0, before], [1.0, start + whole]]))
    over, rows = given.course.rpartition("_")[2], whole
    key, as_written = f"{key}.{given.course}", [list(row) for row in rows]
    end = stage.duration * stage.slower if over == "time" else _find_stroke(stage)
    if end == 0.0:
        other = given.course.partition("_")[0]
        return Problem(key, "nothing moves by a stroke in this stage", f"give {other}_over_time, or {other}")
    table, along = np.array(rows, dtype=float), "s" if over == "time" else "mm"
    table[:, 1] += start
    if table[-1, 0] > end * (1 + 1e-9):
        fault = f"goes on to {table[-1, 0]:g} {along}, beyond the end of the stage at {end:.6g} {along}"
        return Problem(key, fault, "shorten the table, or lengthen the stage", as_written)
    if table[0, 0] == 0.0 and abs(table[0, 1] - before) > SAME * max(before, table[0, 1]):
        begins = f"begins with {table[0, 1] - start:g} {unit}, but the stage does with {before - start:g} {unit}"
        return Problem(key, f"{begins}: a fluid does not jump", f"begin it with [0, {before - start:g}]", as_written)
    if table[0, 0] > 0.0:
        table = np.vstack([(0.0, before), table])
    return model.PressureCourse(np.column_stack([table[:, 0] / end, table[:, 1]]), "time" if over == "time" else "way")


def _check_outflow(key: str, given: SheetPressure, least: float) -> Iterator[Problem]:
    """Yield the problem of a fluid of which more flows out than there is; least: inflow since the start [mm3]."""
    if given.fluid is not None and given.fluid.room + least <= 0.0:
        fault = f"{-least:g} mm3 flow out of the room of {given.fluid.room:g} mm3"
        yield Problem(key, fault, "let less flow out, or make the room larger")


def _find_stroke(stage: model.Stage) -> float:
    """Return how far goes in a stage what is moved farthest [mm]."""
    moved = [float(np.linalg.norm(motion.move)) for motion in stage.tool_motion.values() if motion.push is None]
    return max([*moved, *(abs(each.value) for each in stage.prescribed if each.component < 3)], default=0.0)


def build_pressures(
    case: StampingCase, mesh: model.Mesh, tools: Sequence[model.Tool], *, is_flat: bool
) -> tuple[tuple[model.SheetPressure, ...], list[Problem]]:
    """Return the Model's pressures, and their problems on the meshed blank beside the placed tools.

    is_flat: the sheet lies as it is meshed, so that tools that lie on it are known.
    """
    folder = case.source.parent if case.source is not None else Path()
    pressures, problems = [], []
    for name, given in case.pressure.items():
        built = _build_pressure(name, given, folder)
        if isinstance(built, Problem):
            problems.append(built)
        else:
            pressures.append(built)
    if problems or not pressures:
        return tuple(pressures), problems
    cells = mesh.corners
    pressed = {each.name: find_pressed_cells(mesh.points, cells, each) for each in pressures}
    problems = [
        Problem(_key_of_line(each), "the middle of no shell lies there", "draw the line on the blank, in mm")
        for each in pressures
        if not len(pressed[each.name])
    ]
    problems += [problem for each in pressures for problem in _check_face(each, mesh.points, cells)]
    problems += _check_apart(pressures, pressed)
    problems += [
        problem
        for each in pressures
        if each.fluid is not None and not tools and each.face != "inside"
        for problem in _check_closed(each, cells[pressed[each.name]], case, mesh)
    ]
    problems += [problem for each in pressures for problem in _check_inflow(each.name, mesh, cells, case)]
    middles = find_middles(mesh.points, cells)
    for each in pressures if is_flat else ():
        problems += _check_tools(each, middles[pressed[each.name]], tools, case.blank.thickest)
    return tuple(pressures), problems


def _build_pressure(name: str, given: SheetPressure, folder: Path) -> model.SheetPressure | Problem:
    keep: Literal["inside", "outside"] = "inside" if given.inside is not None else "outside"
    line = given.inside or given.outside
    fluid = None if given.fluid is None else model.EnclosedFluid(given.fluid.stiffness, given.fluid.room)
    if line is None:
        return model.SheetPressure(name, given.face, None, fluid)
    polygon = draw_line(line, f"pressure.{name}.{keep}", folder)
    if isinstance(polygon, Problem):
        return polygon
    return model.SheetPressure(name, given.face, model.PressedRegion(polygon, keep), fluid, given.seal is not None)


def _key_of_line(pressure: model.SheetPressure) -> str:
    return f"pressure.{pressure.name}" + (f".{pressure.region.keep}" if pressure.region else "")


def _check_apart(
    pressures: Sequence[model.SheetPressure], pressed: Mapping[str, model.IndexArray]
) -> Iterator[Problem]:
    """Yield the problems of two fluids on one face."""
    for one, other in itertools.combinations(pressures, 2):
        shared = np.intersect1d(pressed[one.name], pressed[other.name])
        if one.face == other.face and len(shared):
            fault = f"pushes {len(shared)} shells on the {one.face} face that {one.name} pushes, too"
            remedy = "bound both by lines that do not overlap, or take the other face"
            yield Problem(f"pressure.{other.name}", fault, remedy)


def _check_face(pressure: model.SheetPressure, points: model.FloatArray, cells: model.IntArray) -> Iterator[Problem]:
    """Yield the problem of a face that a sheet lacks: the upper one of a tube, the inner one of a flat sheet."""
    upright = pressure.face in ("top", "bottom")
    if abs(measure_rise(points, cells) if upright else measure_bulge(points, cells)) > FACELESS:
        return
    shape, other = ("a tube", "inside or outside") if upright else ("flat", "top or bottom")
    fault = f"the sheet is {shape}, which has no such face"
    yield Problem(f"pressure.{pressure.name}.face", fault, f"take {other}", pressure.face)


def _check_closed(
    pressure: model.SheetPressure, cells: model.IntArray, case: StampingCase, mesh: model.Mesh
) -> Iterator[Problem]:
    """Yield the problem of a fluid whose space is open where nothing holds the edge of the sheet."""
    held = np.zeros(len(mesh.points), dtype=bool)
    for name in ("symmetry_x", "symmetry_y"):
        held[mesh.node_sets.get(name, np.zeros(0, dtype=np.int32))] = True
    for entry in case.boundary.values():
        if "z" in (entry.fix or HOLDS[entry.hold or "clamped"]):
            held[mesh.node_sets[entry.set]] = True
    rim = np.intersect1d(np.unique(mesh.boundary_edges[:, :2]), np.unique(cells))
    free = int((~held[rim]).sum())
    if free:
        fault = f"its space is open: neither tools nor [boundary] hold {free} nodes of the edge that bounds it"
        remedy = 'hold them, for instance boundary.clamp = {set = "edge", hold = "clamped"}'
        yield Problem(f"pressure.{pressure.name}.fluid", fault, remedy)


def _check_inflow(name: str, mesh: model.Mesh, cells: model.IntArray, case: StampingCase) -> Iterator[Problem]:
    """Yield the problem of a fluid of which more flows in than a sphere holds that the whole sheet could become."""
    if case.pressure[name].fluid is None:
        return
    area = np.linalg.norm(find_area_vectors(mesh.points[cells]).sum(axis=1), axis=1).sum()
    most, inflow = (STRETCHED * MIRRORED * area) ** 1.5 / (6.0 * np.sqrt(np.pi)), 0.0
    for index, stage in enumerate(case.stages):
        given = stage.pressure.get(name)
        if given is None:
            continue
        course = getattr(given, given.course)
        inflow += course if given.course == "inflow" else course[-1][1]
        if inflow > most:
            fault = f"{inflow:.4g} mm3 have flowed in, and the sheet could hold {most:.4g} mm3 if it became a sphere"
            remedy = 'plain numbers are mm3; for instance 20000, or "20 cm^3"'
            yield Problem(f"stages.{index}.pressure.{name}.{given.course}", fault, remedy, course)
            return


def _check_tools(
    pressure: model.SheetPressure, middles: model.FloatArray, tools: Sequence[model.Tool], thickness: float
) -> Iterator[Problem]:
    """Yield the problems of tools that lie on the face that a fluid pushes."""
    inwards = {"bottom": 1.0, "top": -1.0}.get(pressure.face)  # along z, as tools on that side work
    for tool in tools if inwards is not None else ():
        assert tool.working_direction is not None
        assert inwards is not None
        if tool.working_direction[2] * inwards <= 0.0:
            continue
        gap = make_surface(tool.surface).nearest(middles - np.asarray(tool.position))[0] - 0.5 * thickness
        n = int((gap < UNTOUCHED * thickness).sum())
        if n:
            key = f"pressure.{pressure.name}" + (f".{pressure.region.keep}" if pressure.region else ".face")
            fault = f"the {tool.kind} {tool.name} lies on {n} of its shells: no fluid is between a tool and the sheet"
            yield Problem(key, fault, f"bound it by a line inside the opening of the {tool.kind}")
