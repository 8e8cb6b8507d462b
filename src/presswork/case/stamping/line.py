# SPDX-License-Identifier: Apache-2.0
"""Turns a case with operations into the Model of a press line: each operation is checked and built as a case of its
own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import TypeVar

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.stamping.operation import Operation, Place
from presswork.case.stamping.place import find_face
from presswork.case.stamping.schema import OWN, StampingCase

Value = TypeVar("Value")


def view_operation(case: StampingCase, number: int) -> StampingCase:
    """Return the case of an operation alone, as of one operation."""
    operation = case.operations[number]
    return case.model_copy(update={"operations": (), **{key: getattr(operation, key) for key in OWN}})


@contextmanager
def name_operation(number: int) -> Iterator[None]:
    """Let the keys of an operation's problems begin with its own."""
    try:
        yield
    except CaseError as error:
        raise CaseError([_rename(problem, number) for problem in error.problems], error.source) from None


def _rename(problem: Problem, number: int) -> Problem:
    own = problem.key.partition(".")[0] in OWN
    return replace(problem, key=f"operations.{number}.{problem.key}") if own else problem


def check_operations(case: StampingCase) -> list[Problem]:
    """Return the problems of operations beside each other."""
    problems = []
    names = [each.name for each in case.operations]
    for number, operation in enumerate(case.operations):
        key = f"operations.{number}"
        if operation.name in names[:number]:
            problems.append(
                Problem(f"{key}.name", "two operations have this name", "give each its own", operation.name)
            )
        if number == 0 and operation.place is not None:
            fault = "the first operation takes the flat blank, as it is meshed"
            problems.append(Problem(f"{key}.place", fault, "leave it out, or place the tools"))
        if operation.place is not None:
            problems += _check_place(f"{key}.place", operation.place, case)
            problems += _check_tip(key, operation)
    if case.heat is not None:
        fault = "heat is not carried from one operation to the next"
        problems.append(Problem("heat", fault, "leave it out, or compute one operation alone"))
    if case.points:
        fault = "points are not followed from one operation to the next"
        problems.append(Problem("points", fault, "leave them out, or compute one operation alone"))
    if case.draw_in:
        fault = "draw-in is not followed from one operation to the next"
        problems.append(Problem("draw_in", fault, "leave it out, or compute one operation alone"))
    taken: dict[str, str] = {}
    for number, operation in enumerate(case.operations):
        beads = {f"bead_{i + 1}": f"beads.{i}" for i in range(len(operation.beads))}
        for name, key in {**{tool: f"tools.{tool}" for tool in operation.tools}, **beads}.items():
            whole = f"{operation.name}_{name}"
            if whole in taken:
                fault, remedy = f"is called {whole} in the results, as {taken[whole]} is", "give it another name"
                problems.append(Problem(f"operations.{number}.{key}", fault, remedy))
            taken[whole] = f"operations.{number}.{key}"
    return problems


def _check_place(key: str, place: Place, case: StampingCase) -> list[Problem]:
    """Return the problems of a part with symmetry planes that is moved off them."""
    problems = []
    remedy = "leave it out, or compute the whole part (blank.symmetry)"
    for axis, plane in enumerate("xy"):
        if plane in case.blank.symmetry and place.move[axis] != 0.0:
            fault = f"the part would be moved off its symmetry plane {plane} = 0"
            problems.append(Problem(f"{key}.move", fault, remedy, list(place.move)))
    if case.blank.symmetry and place.turn % 180.0 != 0.0:
        fault = f"the part would be turned off its symmetry plane {case.blank.symmetry[0]} = 0"
        problems.append(Problem(f"{key}.turn", fault, remedy, place.turn))
    return problems


def _check_tip(key: str, operation: Operation) -> list[Problem]:
    """Return the problem of a part that tips onto dies whose relative heights are not given."""
    dies = {name: tool for name, tool in operation.tools.items() if tool.kind == "die"}
    if operation.place is None or not operation.place.tip:
        return []
    if not dies:
        return [Problem(f"{key}.place.tip", "there is no die to rest on", "add one, or leave tip out")]
    fault = "one of several dies that the part tips onto: their heights relative to each other are not known"
    return [
        Problem(f"{key}.tools.{name}.position", fault, "give it, of each die")
        for name, tool in dies.items()
        if len(dies) > 1 and tool.position is None
    ]


def build_operation(operation: Operation, own: model.Model) -> model.Operation:
    """Return the Model's operation. own: the Model of this operation alone, as `name_parts` gives it."""
    laid, spaced = [], {}
    dies = [name for name, tool in operation.tools.items() if tool.kind == "die"]
    shapes = {tool.name: tool.surface for tool in own.tools}
    for name, tool in operation.tools.items():
        whole = f"{operation.name}_{name}"
        if tool.position is None and tool.gap is not None:
            die = f"{operation.name}_{dies[0]}"
            above = tool.gap + find_face(operation.tools[dies[0]], shapes[die]) - find_face(tool, shapes[whole])
            spaced[whole] = (die, above)
        elif tool.position is None:
            laid.append(whole)
    place = operation.place or Place()
    return model.Operation(
        name=operation.name,
        tools=own.tools,
        supports=own.supports,
        stages=own.stages,
        beads=own.beads,
        trim=own.trim,
        springback=own.springback,
        hem=own.hem,
        place=place.build(),
        laid=tuple(laid),
        spaced=spaced,
        closings=tuple(_list_closings(operation, [f"{operation.name}_{die}" for die in dies])),
    )


def _list_closings(operation: Operation, dies: list[str]) -> Iterator[model.Closing]:
    for number, stage in enumerate(operation.stages):
        for name, action in stage.tools.items():
            if action.close is not None:
                is_timed = stage.duration is not None
                yield model.Closing(number, f"{operation.name}_{name}", tuple(dies), action.close, is_timed)


def check_closings(case: StampingCase) -> list[Problem]:
    """Return the problems of tools that close on dies."""
    problems = []
    dies = [name for name, tool in case.tools.items() if tool.kind == "die"]
    for index, stage in enumerate(case.stages):
        for name, action in stage.tools.items():
            if action.close is None:
                continue
            key = f"stages.{index}.tools.{name}.close"
            if name in dies or not dies:
                fault = "a die is what others close on" if name in dies else "there is no die to close on"
                problems.append(Problem(key, fault, "give the stroke", action.close))
            elif stage.press is not None or (stage.ramp is not None and stage.duration is None):
                other = "a press" if stage.press is not None else "a ramp without duration"
                fault = f"how far the tool goes is not known beforehand, as {other} needs it"
                problems.append(Problem(key, fault, "give the stroke, or the duration", action.close))
    return problems


def name_parts(own: model.Model, name: str) -> model.Model:
    """Return the Model of an operation, its name before those of its tools, beads, stages and trim lines."""

    def whole(part: str) -> str:
        return f"{name}_{part}"

    def by_whole(values: Mapping[str, Value]) -> dict[str, Value]:
        return {whole(part): value for part, value in values.items()}

    stages = tuple(
        replace(
            stage,
            name=whole(stage.name),
            tool_motion=by_whole(stage.tool_motion),
            bead_share=by_whole(stage.bead_share),
        )
        for stage in own.stages
    )
    return replace(
        own,
        operation=name,
        tools=tuple(replace(tool, name=whole(tool.name)) for tool in own.tools),
        beads=tuple(replace(b, name=whole(b.name), tool=whole(b.tool) if b.tool else None) for b in own.beads),
        stages=stages,
        trim=tuple(replace(line, name=whole(line.name)) for line in own.trim),
    )
