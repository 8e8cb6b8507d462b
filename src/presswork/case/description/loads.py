# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about the loads of a stage: their values at its start and end."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import model
from presswork.mesh.node_weights import find_weights
from presswork.mesh.pressed_cells import find_area_vectors, find_pressed_cells
from presswork.model import FloatArray

NAMES = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")


def describe_loads(problem: model.Model, number: int) -> Iterator[str]:
    """Describe the loads of a stage, and what it no longer holds; number: of the stage, from 0."""
    stage = problem.stages[number]
    before = problem.stages[number - 1] if number else model.Stage("rest")
    start, end = _add_up(before), _add_up(stage)
    for name, unit in dict.fromkeys([*end, *start]):
        nothing = np.zeros_like({**start, **end}[name, unit])
        first, last = start.get((name, unit), nothing), end.get((name, unit), nothing)
        if np.array_equal(first, last):
            yield f"{name}: stays {_write(last)} {unit}"
        else:
            yield f"{name}: {_write(first)} to {_write(last)} {unit}"
    held = {(entry.node_set, entry.component) for entry in stage.prescribed}
    force = "at once" if problem.explicit is not None else "over the stage"
    for entry in before.prescribed:
        if (entry.node_set, entry.component) not in held:
            yield f"{entry.node_set} is no longer held, {NAMES[entry.component]}: its force goes to zero {force}"


def describe_loads_of_sheet(problem: model.Model) -> Iterator[str]:
    """Describe the weight of a sheet and the pressures on it: face, and shells and area of the whole part."""
    yield from describe_gravity(problem)
    points, cells = problem.mesh.points, problem.mesh.corners
    for pressure in problem.sheet_pressures:
        pressed = cells[find_pressed_cells(points, cells, pressure)]
        area = problem.whole * float(np.linalg.norm(find_area_vectors(points[pressed]), axis=2).sum())
        shells = "all shells" if len(pressed) == len(cells) else f"{len(pressed)} of {len(cells)} shells"
        yield f"pressure {pressure.name}: on the {pressure.face} face, {shells}, {area:.4g} mm2 of the whole part"


def describe_courses(problem: model.Model, stage: model.Stage) -> Iterator[str]:
    """Describe how the pressures on a sheet go over a stage."""
    for pressure in problem.sheet_pressures:
        name, course = pressure.name, stage.pressure_course[pressure.name]
        if course.held is not None:
            goal = course.held
            limits = f"between {goal.least:g} and {goal.most:g} MPa"
            yield f"pressure {name}: holds the {goal.of} strain rate at {goal.target:g} 1/s, {limits}"
            continue
        if pressure.fluid is not None:
            start, end = course.rows[0, 1], course.rows[-1, 1]
            room = pressure.fluid.room
            yield f"pressure {name}: {end - start:g} mm3 flow in, {end:g} since the start, into {room:g} mm3 of room"
            continue
        start, end, most = course.rows[0, 1], course.rows[-1, 1], course.rows[:, 1].max()
        over = f", at most {most:g} MPa" if most > max(start, end) else ""
        yield (
            f"pressure {name}: {start:g} to {end:g} MPa{over}"
            if start != end or over
            else f"pressure {name}: stays {end:g} MPa"
        )


def describe_gravity(problem: model.Model) -> Iterator[str]:
    """Describe the weight of the bodies, where there is gravity."""
    if problem.gravity:
        when = "from the first cycle on" if problem.explicit is not None else "from 0 over the first stage"
        weight = float(np.linalg.norm(find_weights(problem).sum(axis=0)))
        yield f"gravity: {_write(np.asarray(problem.gravity))} mm/s2 {when}; what is modelled weighs {weight:.4g} N"


def _add_up(stage: model.Stage) -> dict[tuple[str, str], FloatArray]:
    """Return the loads that a stage gives, by what they are and where, and unit."""
    found: dict[tuple[str, str], FloatArray] = {}
    for name, unit, value in _list(stage):
        array = np.atleast_1d(np.asarray(value, dtype=np.float64))
        found[name, unit] = found.get((name, unit), np.zeros_like(array)) + array
    return {key: value for key, value in found.items() if value.any()}


def _list(stage: model.Stage) -> Iterator[tuple[str, str, tuple[float, ...] | float]]:
    for force in stage.forces:
        yield f"force on {force.node_set}", "N", force.force[:3]
        yield f"moment on {force.node_set}", "N mm", force.force[3:]
    for edge in stage.edge_forces:
        yield f"force along {edge.edge_set}", "MPa" if len(edge.force) == 2 else "N/mm", edge.force[:3]
        yield f"moment along {edge.edge_set}", "N", edge.force[3:]
    for face in stage.face_forces:
        yield f"force on the faces of {face.face_set}", "MPa", face.force
    for pressure in stage.pressures:
        yield f"pressure on {pressure.edge_set}", "MPa", pressure.value
    for face_pressure in stage.face_pressures:
        yield f"pressure on the faces of {face_pressure.face_set}", "MPa", face_pressure.value
    for shell_pressure in stage.shell_pressures:
        yield f"pressure on {shell_pressure.node_set}", "MPa", shell_pressure.value
    for body in stage.body_forces:
        yield "force on the whole sheet", "N/mm3", body.force


def _write(value: FloatArray) -> str:
    if not value.any():
        return "0"
    numbers = [f"{v:g}" for v in value]
    return numbers[0] if len(numbers) == 1 else f"({', '.join(numbers)})"
