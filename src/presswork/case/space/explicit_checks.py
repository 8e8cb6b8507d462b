# SPDX-License-Identifier: Apache-2.0
"""What of the case of a solid in space goes with one procedure and not with the other."""

from __future__ import annotations

import numpy as np

from presswork import _core, model
from presswork.case.errors import Problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.solid.explicit_checks import CONTACTS, LARGEST_MU, STEPS_OF_A_STAGE
from presswork.case.space.schema import SpaceCase, SpaceStage
from presswork.case.space.tools import SpaceTool

USUAL = "hex8_1pt"
"""The element of the explicit procedure where the case names none."""


def choose_element(case: SpaceCase) -> model.SpaceElement:
    """Return the element of a case."""
    given = "element" in case.workpiece.model_fields_set
    return USUAL if case.procedure == "explicit" and not given else case.workpiece.element


def check_space_procedure(case: SpaceCase) -> list[Problem]:
    """Return the problems of keys that the case's procedure cannot do, or would ignore."""
    element = choose_element(case)
    implicit = case.procedure == "implicit"
    problems = []
    known = model.list_names(_core.Family.space, in_implicit=implicit, in_explicit=not implicit)
    if element not in known:
        fault = f"the {case.procedure} procedure has no such element"
        problems.append(Problem("workpiece.element", fault, f"take {' or '.join(known)}", element))
    return problems + (_check_implicit(case) if implicit else _check_explicit(case))


def _check_implicit(case: SpaceCase) -> list[Problem]:
    keys = ["workpiece.velocity"] if case.workpiece.velocity is not None else []
    keys += [f"explicit.{key}" for key in sorted(case.explicit.model_fields_set)]
    keys += [f"stages.{number}.ramp" for number, stage in enumerate(case.stages) if stage.ramp is not None]
    keys += ["output.rows"] if "rows" in case.output.model_fields_set else []
    fault, remedy = "is for the explicit procedure", 'remove it, or set procedure = "explicit"'
    return [Problem(key, fault, remedy) for key in keys]


def _check_explicit(case: SpaceCase) -> list[Problem]:
    problems = [*_check_material(case), *_check_target_step(case)]
    if case.heat is not None:
        fault = "the explicit procedure conducts no heat in space, so far"
        problems.append(Problem("heat", fault, "leave it out; materials.NAME.heating heats each cell by its own work"))
    for name, tool in case.tools.items():
        problems += _check_tool(f"tools.{name}", tool)
    for index, stage in enumerate(case.stages):
        problems += _check_stage(f"stages.{index}", stage)
    keys = [f"solver.{key}" for key in sorted(case.solver.model_fields_set)]
    keys += [f"output.{key}" for key in ("every", "at") if key in case.output.model_fields_set]
    fault = "is for the implicit procedure"
    problems += [Problem(key, fault, "remove it; steps, rows and [explicit] take its place") for key in keys]
    if case.output.steps > case.output.rows:
        fault = f"expected no more than rows = {case.output.rows}"
        problems.append(Problem("output.steps", fault, "a step is saved where a row is", case.output.steps))
    return problems


def _check_material(case: SpaceCase) -> list[Problem]:
    name = case.workpiece.material
    material = case.materials.get(name)
    if material is None:
        return []
    if isinstance(material, UmatMaterial):
        fault = "the explicit procedure calls no UMAT in space, so far"
        return [Problem(f"materials.{name}.umat", fault, "give a law of presswork")]
    if material.density is None:
        remedy = 'add it: the explicit procedure needs it; steel has "7850 kg/m^3"'
        return [Problem(f"materials.{name}.density", "missing key", remedy)]
    velocity = case.workpiece.velocity
    sound = float(np.sqrt(material.young / material.density))
    if velocity is not None and float(np.linalg.norm(velocity)) > sound:
        fault = f"faster than sound in the material, {sound:.3g} mm/s"
        return [Problem("workpiece.velocity", fault, 'plain numbers are mm/s; "200 m/s" is 2e5', list(velocity))]
    return []


def _check_target_step(case: SpaceCase) -> list[Problem]:
    target = case.explicit.target_step
    durations = [stage.duration for stage in case.stages if "duration" in stage.model_fields_set]
    if target is None or not durations or target * STEPS_OF_A_STAGE <= min(durations):
        return []
    fault = f"the shortest stage, of {min(durations):.3g} s, has fewer than {STEPS_OF_A_STAGE} such steps"
    return [Problem("explicit.target_step", fault, "take a few times the step without it", target)]


def _check_tool(key: str, tool: SpaceTool) -> list[Problem]:
    problems = []
    if tool.contact not in CONTACTS:
        remedy = f"take {' or '.join(CONTACTS)}"
        problems.append(Problem(f"{key}.contact", "the explicit procedure has no such law", remedy, tool.contact))
    if tool.mu > LARGEST_MU:
        problems.append(Problem(f"{key}.mu", f"expected a value <= {LARGEST_MU:g}", "steel on steel has 0.1", tool.mu))
    for name, fault in (("spring", "a tool rests on no spring"), ("rotation", "a tool stands as it is drawn")):
        if getattr(tool, name) is not None:
            problems.append(Problem(f"{key}.{name}", f"in the explicit procedure {fault}, so far", "leave it out"))
    return problems


def _check_stage(key: str, stage: SpaceStage) -> list[Problem]:
    problems = []
    if "duration" not in stage.model_fields_set:
        problems.append(Problem(f"{key}.duration", "missing key", 'add it: dynamics take their time, e.g. "80 us"'))
    elif stage.ramp is not None and stage.ramp > 0.5 * stage.duration * (1 + 1e-12):
        fault = f"start and end do not fit into {stage.duration:g} s"
        problems.append(Problem(f"{key}.ramp", fault, f"take at most {0.5 * stage.duration:.3g} s", stage.ramp))
    for name in ("press", "velocity"):
        if getattr(stage, name) is not None:
            fault = "the explicit procedure in space knows no ram, so far"
            problems.append(Problem(f"{key}.{name}", fault, "give duration"))
    for tool, motion in stage.tools.items():
        for name in ("force", "turn", "position"):
            if getattr(motion, name):
                fault = "in the explicit procedure a tool in space can be moved only, so far"
                problems.append(Problem(f"{key}.tools.{tool}.{name}", fault, "give stroke or move"))
    fault = "the explicit procedure has tools and displacements that move, and a velocity at the start, no loads"
    for load in ("force", "face_force", "pressure"):
        if getattr(stage, load):
            problems.append(Problem(f"{key}.{load}", fault, "leave it out"))
    return problems
