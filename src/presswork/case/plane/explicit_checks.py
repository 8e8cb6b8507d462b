# SPDX-License-Identifier: Apache-2.0
"""What of a solid's case goes with one procedure and not with the other."""

from __future__ import annotations

from presswork import _core, model
from presswork.case.errors import Problem
from presswork.case.explicit_checks import (
    check_explicit_keys,
    check_friction,
    check_implicit_keys,
    check_loads,
    check_material,
    check_target_step,
    check_time,
)
from presswork.case.plane import schema
from presswork.case.plane.bodies import list_bodies
from presswork.case.plane.tool import Tool
from presswork.case.press.builder import check_in_explicit


def check_procedure(case: schema.Case) -> list[Problem]:
    """Return the problems of keys that the case's procedure cannot do, or would ignore."""
    return _check_explicit(case) if case.procedure == "explicit" else _check_implicit(case)


def _check_implicit(case: schema.Case) -> list[Problem]:
    velocities = [f"{key}.velocity" for key, body in list_bodies(case).values() if body.velocity is not None]
    return check_implicit_keys(case, velocities) + _check_placed(case)


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
    problems = []
    known = model.list_names(_core.Family.plane, in_explicit=True)
    for key, body in list_bodies(case).values():
        if body.element not in known:
            fault = "the explicit procedure has no such element"
            problems.append(Problem(f"{key}.element", fault, f"take {' or '.join(known)}", body.element))
    problems += check_material(case)
    for name, tool in case.tools.items():
        problems += _check_tool(f"tools.{name}", tool)
    for index, stage in enumerate(case.stages):
        problems += _check_stage(f"stages.{index}", stage)
        if stage.press is not None and stage.press.name in case.presses:
            problems += check_in_explicit(
                f"stages.{index}", case.presses[stage.press.name], stage.press, blows=not stage.displacement
            )
    problems += check_target_step(case)
    if case.explicit.device != "cpu":
        small = "a mesh in the plane has too few cells to fill a card, the CPU computes it"
        remedy = 'remove it; cards compute solids in space (analysis = "solid")'
        problems.append(Problem("explicit.device", small, remedy, case.explicit.device))
    if case.solver.displacements == "small":
        small = "the explicit procedure follows the body as it moves, its displacements are large"
        problems.append(Problem("solver.displacements", small, 'remove it, or set procedure = "implicit"', "small"))
    return problems + check_explicit_keys(case, kept="displacements")


def _check_tool(key: str, tool: Tool) -> list[Problem]:
    problems = check_friction(key, tool)
    if tool.spring is not None:
        fault = "in the explicit procedure a tool rests on no spring"
        problems.append(Problem(f"{key}.spring", fault, "leave it out"))
    for index, point in enumerate(tool.profile or ()):
        if point.mu is not None and point.mu != tool.mu:
            fault = "in the explicit procedure a tool has one coefficient of friction"
            problems.append(Problem(f"{key}.profile.{index}.mu", fault, "make it two tools", point.mu))
    return problems


def _check_stage(key: str, stage: schema.Stage) -> list[Problem]:
    problems = [*check_time(key, stage), *check_loads(key, stage, "edge_force")]
    for name, motion in stage.tools.items():
        if motion.position is not None:
            fault = "in the explicit procedure a tool goes on from where it is"
            problems.append(Problem(f"{key}.tools.{name}.position", fault, "leave it out", motion.position))
        for key_of_motion in ("force", "turn"):
            if getattr(motion, key_of_motion):
                fault = "in the explicit procedure a tool can be moved only"
                problems.append(
                    Problem(
                        f"{key}.tools.{name}.{key_of_motion}",
                        fault,
                        "give stroke or move",
                        getattr(motion, key_of_motion),
                    )
                )
    return problems
