# SPDX-License-Identifier: Apache-2.0
"""What of a solid's case goes with one procedure and not with the other."""

from __future__ import annotations

import numpy as np

from presswork import _core, model
from presswork.case.errors import Problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.press.builder import check_in_explicit
from presswork.case.solid import schema
from presswork.case.solid.bodies import list_bodies
from presswork.case.solid.tool import Tool

CONTACTS = ("frictionless", "coulomb")
LARGEST_MU = 2.0
STEPS_OF_A_STAGE = 20
"""Time steps that the shortest stage has at least, where a step is asked for."""


def check_procedure(case: schema.Case) -> list[Problem]:
    """Return the problems of keys that the case's procedure cannot do, or would ignore."""
    return _check_explicit(case) if case.procedure == "explicit" else _check_implicit(case)


def _check_implicit(case: schema.Case) -> list[Problem]:
    fault, remedy = "is for the explicit procedure", 'remove it, or set procedure = "explicit"'
    keys = [f"{key}.velocity" for key, body in list_bodies(case).values() if body.velocity is not None]
    keys += [f"explicit.{key}" for key in sorted(case.explicit.model_fields_set)]
    keys += [f"stages.{number}.ramp" for number, stage in enumerate(case.stages) if stage.ramp is not None]
    keys += ["output.rows"] if "rows" in case.output.model_fields_set else []
    return [Problem(key, fault, remedy) for key in keys] + _check_placed(case)


def _check_placed(case: schema.Case) -> list[Problem]:
    """Return problems of tools that a stage places anew."""
    problems = []
    for index, stage in enumerate(case.stages):
        for name, motion in stage.tools.items():
            key = f"stages.{index}.tools.{name}.position"
            if motion.position is None:
                continue
            if index == 0:
                remedy = f"give tools.{name}.position"
                problems.append(Problem(key, "the first stage begins where the tool starts", remedy, motion.position))
            elif name in case.tools and case.tools[name].spring is not None:
                fault = "a tool on a spring stays on it"
                problems.append(Problem(key, fault, "leave it out, or take the spring away", motion.position))
    return problems


def _check_explicit(case: schema.Case) -> list[Problem]:
    fault, remedy = "the explicit procedure of solids has one workpiece", 'leave it out, or set procedure = "implicit"'
    problems = [Problem(f"bodies.{name}", fault, remedy) for name in case.bodies]
    fault = "the explicit procedure knows no contact of bodies or of a body with itself"
    problems += [Problem(f"contacts.{name}", fault, remedy) for name in case.contacts]
    element = case.workpiece.element
    known = model.list_names(_core.Family.plane, in_explicit=True)
    if element not in known:
        fault = "the explicit procedure has no such element"
        problems.append(Problem("workpiece.element", fault, f"take {' or '.join(known)}", element))
    problems += _check_material(case)
    for name, tool in case.tools.items():
        problems += _check_tool(f"tools.{name}", tool)
    for index, stage in enumerate(case.stages):
        problems += _check_stage(f"stages.{index}", stage)
        if stage.press is not None and stage.press.name in case.presses:
            problems += check_in_explicit(
                f"stages.{index}", case.presses[stage.press.name], stage.press, blows=not stage.displacement
            )
    problems += _check_magnitudes(case) + _check_target_step(case)
    fault = "is for the implicit procedure"
    keys = [f"solver.{key}" for key in sorted(case.solver.model_fields_set - {"displacements"})]
    if case.solver.displacements == "small":
        small = "the explicit procedure follows the body as it moves, its displacements are large"
        problems.append(Problem("solver.displacements", small, 'remove it, or set procedure = "implicit"', "small"))
    keys += [f"output.{key}" for key in ("every", "at") if key in case.output.model_fields_set]
    problems += [Problem(key, fault, "remove it; steps, rows and [explicit] take its place") for key in keys]
    if case.output.steps > case.output.rows:
        remedy = "a step is saved where a row is"
        problems.append(
            Problem("output.steps", f"expected no more than rows = {case.output.rows}", remedy, case.output.steps)
        )
    return problems


def _check_material(case: schema.Case) -> list[Problem]:
    name = case.workpiece.material
    material = case.materials.get(name)
    if material is not None and material.density is None:
        remedy = 'add it: the explicit procedure needs it; steel has "7850 kg/m^3"'
        return [Problem(f"materials.{name}.density", "missing key", remedy)]
    return []


def _check_magnitudes(case: schema.Case) -> list[Problem]:
    """Return the problem of a velocity beside the material's own stiffness: a unit taken for another."""
    name = case.workpiece.material
    material = case.materials.get(name)
    if material is None or isinstance(material, UmatMaterial) or material.density is None:
        return []
    velocity = case.workpiece.velocity
    sound = float(np.sqrt(material.young / material.density))
    if velocity is not None and np.hypot(*velocity) > sound:
        fault = f"faster than sound in the material, {sound:.3g} mm/s"
        return [Problem("workpiece.velocity", fault, 'plain numbers are mm/s; "200 m/s" is 2e5', velocity)]
    return []


def _check_target_step(case: schema.Case) -> list[Problem]:
    target = case.explicit.target_step
    durations = [stage.duration for stage in case.stages if "duration" in stage.model_fields_set]
    if target is None or not durations or target * STEPS_OF_A_STAGE <= min(durations):
        return []
    fault = f"the shortest stage, of {min(durations):.3g} s, has fewer than {STEPS_OF_A_STAGE} such steps"
    return [Problem("explicit.target_step", fault, "take a few times the step without it", target)]


def _check_tool(key: str, tool: Tool) -> list[Problem]:
    problems = []
    if tool.contact not in CONTACTS:
        remedy = f"take {' or '.join(CONTACTS)}"
        problems.append(Problem(f"{key}.contact", "the explicit procedure has no such law", remedy, tool.contact))
    if tool.mu > LARGEST_MU:
        problems.append(Problem(f"{key}.mu", f"expected a value <= {LARGEST_MU:g}", "steel on steel has 0.1", tool.mu))
    if tool.spring is not None:
        fault = "in the explicit procedure a tool rests on no spring"
        problems.append(Problem(f"{key}.spring", fault, "leave it out"))
    for index, point in enumerate(tool.profile or ()):
        if point.mu is not None and point.mu != tool.mu:
            fault = "in the explicit procedure a tool has one coefficient of friction"
            problems.append(Problem(f"{key}.profile.{index}.mu", fault, "make it two tools", point.mu))
    return problems


def _check_stage(key: str, stage: schema.Stage) -> list[Problem]:
    problems = []
    if stage.press is not None or stage.velocity is not None:
        if stage.ramp is not None:
            fault = "a ram neither starts nor stops smoothly"
            problems.append(Problem(f"{key}.ramp", fault, "leave it out", stage.ramp))
    elif "duration" not in stage.model_fields_set:
        problems.append(Problem(f"{key}.duration", "missing key", 'add it: dynamics take their time, e.g. "80 us"'))
    elif stage.ramp is not None and stage.ramp > 0.5 * stage.duration * (1 + 1e-12):
        longest = 0.5 * stage.duration
        fault = f"start and end do not fit into {stage.duration:g} s"
        problems.append(Problem(f"{key}.ramp", fault, f"take at most {longest:.3g} s", stage.ramp))
    fault = "the explicit procedure has tools and displacements that move, and a velocity at the start, no loads"
    for load in ("force", "edge_force", "pressure"):
        if getattr(stage, load):
            problems.append(Problem(f"{key}.{load}", fault, "leave it out"))
    for name, motion in stage.tools.items():
        if motion.position is not None:
            fault = "in the explicit procedure a tool goes on from where it is"
            problems.append(Problem(f"{key}.tools.{name}.position", fault, "leave it out", motion.position))
        for way in ("force", "turn"):
            if getattr(motion, way):
                fault = "in the explicit procedure a tool can be moved only"
                problems.append(
                    Problem(f"{key}.tools.{name}.{way}", fault, "give stroke or move", getattr(motion, way))
                )
    return problems
