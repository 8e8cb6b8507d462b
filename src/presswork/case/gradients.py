# SPDX-License-Identifier: Apache-2.0
"""The table [gradients]: which columns of the history are differentiated by which numbers of the case."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from presswork import model
from presswork.case.case_file import CaseFile
from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.part import Part
from presswork.case.reader import apply_overrides

STEP = 1e-4
"""Relative step: the difference between a number and that of the run's neighbours. Its error is h^2, that of round-off
1/h."""
OF_LAWS = 3e-4
"""The same of numbers of the materials of solids: a modulus changes damage so little that round-off counts for more."""
WEAK = 1e-3
"""The same of what conducts and exchanges heat, and of friction of sheets: they change forces less still."""
NEAR, NEAREST = 1e-5, 1e-4
"""The same of sizes and places in a stamping, and the largest step over the sheet's thickness: contact begins within a
thousandth of that (sheet_contact.py). And where bodies get new meshes in space: values are carried within the range of
those around (remesh/space/transfer.py), which has corners."""
COARSE, ONE_SIDED = 1e-7, 1e-5
"""Force tolerance above which one neighbour is enough, and its step: the error is h."""
MOST = 50
"""Numbers by which a run is differentiated."""


class Gradients(Part):
    """Derivatives of columns of history.csv by numbers of the case, found in the run itself."""

    by: tuple[Annotated[str, Field(min_length=1)], ...] = Field(
        min_length=1,
        max_length=MOST,
        description="keys of the case with a number, as --set takes them, e.g. tools.punch.m or "
        "stages.0.tools.punch.stroke; the derivative is per mm, MPa, N, s",
    )
    of: tuple[str, ...] = Field(
        default=(), description="columns of history.csv; without it the forces of all tools, e.g. punch.force"
    )


def add_gradients(
    case: CaseFile, wanted: Gradients, built: model.Model, build: Callable[[CaseFile], model.Model]
) -> model.Model:
    """Return the Model with its neighbours, of which each has one number a little less or more.

    build: makes a Model of a case. Raises CaseError with every key that has no number or no room on both sides, and
    for what has no derivatives.
    """
    problems = _refuse(built)
    data = case.model_dump(mode="json", exclude_unset=True)
    data.pop("gradients", None)
    found = []
    for number, key in enumerate(wanted.by):
        place = f"gradients.by.{number}"
        value = _look_up(data, key)
        if isinstance(value, Problem):
            problems.append(replace(value, key=place))
            continue
        if value == 0.0:
            remedy = "give it a value that is not zero: the step is a part of it"
            problems.append(Problem(place, f"`{key}` is zero", remedy, key))
            continue
        is_coarse = built.solver.force_tolerance > COARSE
        step = ONE_SIDED * abs(value) if is_coarse else _find_step(built, key, abs(value))
        try:
            less, more = (build(_vary(case, data, key, value + change)) for change in (-step, step))
        except CaseError as error:
            reason = "; ".join(str(problem) for problem in error.problems)
            remedy = "take a value with room on both sides, or another key"
            problems.append(Problem(place, f"`{key}` cannot be a little less and more: {reason}", remedy, key))
            continue
        if not all(_has_mesh_of(side, built) for side in (less, more)):
            remedy = "take a key that moves the nodes and leaves the cells as they are"
            problems.append(Problem(place, f"`{key}` changes which cells there are", remedy, key))
            continue
        less, more = (_keep_slaves(side, built) for side in (less, more))
        found.append(model.Parameter(key, value, step, None if is_coarse else less, more))
    if problems:
        raise CaseError(problems, case.source)
    return replace(built, gradients=model.Gradients(wanted.of, tuple(found)))


def find_number(case: CaseFile, key: str) -> float:
    """Return the number at a key of a case, in the units of the Model. Raises CaseError where there is none."""
    found = _look_up(case.model_dump(mode="json", exclude_unset=True), key)
    if isinstance(found, Problem):
        raise CaseError([replace(found, key=key)], case.source)
    return found


def _keep_slaves(side: model.Model, built: model.Model) -> model.Model:
    """Return a Model whose contacts of bodies have the slaves of another: a number may decide which body is softer."""
    pairs = zip(side.contacts, built.contacts, strict=True)
    return replace(side, contacts=tuple(replace(own, slave=led.slave, keeps_slave=True) for own, led in pairs))


def _refuse(built: model.Model) -> list[Problem]:
    """Return the problems of what a run does that has no derivatives yet."""
    stages = [*built.stages, *(stage for operation in built.following for stage in operation.stages)]
    strikes = any(stage.drive is not None and isinstance(stage.drive.motion, model.Blow) for stage in stages)
    feels_time = built.heat is not None or built.solver.inertia > 0.0 or any(m.rate or m.umat for m in built.materials)
    refused = (
        (built.explicit is not None, "procedure", "dynamics", "implicit runs alone have"),
        (built.formed is not None, "blank", "formed blanks", "a flat blank has"),
        (built.series is not None, "series", "series of parts", "a run of one part has"),
        (built.solver.control == "arc_length", "solver.control", "paths by arc length", "load control has"),
        (
            strikes and feels_time,
            "stages",
            "blows with heat, inertia, a strain rate or a UMAT",
            "blows without these have",
        ),
    )
    return [
        Problem(f"gradients ({place})", f"derivatives of {what} are not available", f"{remedy} them")
        for applies, place, what, remedy in refused
        if applies
    ]


def _find_step(built: model.Model, key: str, value: float) -> float:
    """Return by how much neighbours on both sides differ from a number."""
    *path, name = key.split(".")
    if name != "initial_temperature" and not {"thermal", "heat"}.isdisjoint(path):
        return WEAK * value
    if name == "mu" and built.analysis == "stamping":
        return WEAK * value
    is_place = not key.startswith("materials.") and name not in ("mu", "m", "force")
    if built.dimension == 3 and is_place and built.remeshing is not None and not built.remeshing.keeps_first:
        return NEAR * value
    if built.analysis == "stamping" and is_place:
        return min(NEAR * value, NEAREST * built.thickest)
    is_law = key.startswith("materials.") and built.analysis not in ("stamping", "shell")
    return (OF_LAWS if is_law else STEP) * value


def _look_up(data: Any, key: str) -> float | Problem:
    """Return the number at a key of a case, or what is wrong with the key."""
    here = data
    for depth, name in enumerate(names := key.split(".")):
        choices = list(here) if isinstance(here, dict) else []
        if isinstance(here, list):
            choices = [str(i) for i in range(len(here))]
        if name not in choices:
            above = f"keys of `{'.'.join(names[:depth])}` in the case" if depth else "keys of the case"
            return Problem("", f"the case has no key `{key}`", suggest(name, choices, above), key)
        here = here[name] if isinstance(here, dict) else here[int(name)]
    if isinstance(here, list) and len(here) == 1 and isinstance(here[0], list) and len(here[0]) == 2:
        here = here[0][1]  # a table of one row, for which a case may give a number
    if isinstance(here, bool) or not isinstance(here, int | float):
        return Problem("", f"`{key}` is not a number", "name a key with one number", key)
    return float(here)


def _vary(case: CaseFile, data: dict[str, Any], key: str, value: float) -> CaseFile:
    """Return the case with another number at a key. Raises CaseError where it is not valid."""
    changed = copy.deepcopy(data)
    apply_overrides(changed, [f"{key}={value!r}"], case.source)
    return case.beside(changed)


def _has_mesh_of(side: model.Model, built: model.Model) -> bool:
    """Return whether a Model has the cells of another, wherever their nodes are."""
    own, other = side.mesh, built.mesh
    return own.points.shape == other.points.shape and all(
        np.array_equal(a.connectivity, b.connectivity) for a, b in zip(own.blocks, other.blocks, strict=True)
    )
