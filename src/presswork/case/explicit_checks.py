# SPDX-License-Identifier: Apache-2.0
"""What the explicit procedure requires of the case of a solid, in the plane and in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from presswork.case.errors import Problem
from presswork.case.material.umat import UmatMaterial

if TYPE_CHECKING:
    from presswork.case.plane.schema import Case, Stage
    from presswork.case.plane.tool import Tool
    from presswork.case.plane.workpiece import Workpiece
    from presswork.case.space.schema import SpaceCase, SpaceStage, SpaceWorkpiece
    from presswork.case.space.tools import SpaceTool

CONTACTS = ("frictionless", "sticking", "coulomb")
LARGEST_MU = 2.0
STEPS_OF_A_STAGE = 20
"""Least number of time steps in the shortest stage, where a step is given."""


def check_implicit_keys(case: Case | SpaceCase, velocities: Sequence[str]) -> list[Problem]:
    """Return the problems of keys of the explicit procedure in an implicit case; velocities: the keys of those."""
    stages: Sequence[Stage | SpaceStage] = case.stages
    keys = [*velocities, *(f"explicit.{key}" for key in sorted(case.explicit.model_fields_set))]
    keys += [f"stages.{number}.ramp" for number, stage in enumerate(stages) if stage.ramp is not None]
    keys += ["output.rows"] if "rows" in case.output.model_fields_set else []
    fault, remedy = "is for the explicit procedure", 'remove it, or set procedure = "explicit"'
    return [Problem(key, fault, remedy) for key in keys]


def check_explicit_keys(case: Case | SpaceCase, *, kept: str = "") -> list[Problem]:
    """Return the problems of keys of the implicit procedure in an explicit case; kept: a key of both procedures."""
    keys = [f"solver.{key}" for key in sorted(case.solver.model_fields_set - {kept})]
    keys += [f"output.{key}" for key in ("every", "at") if key in case.output.model_fields_set]
    fault, remedy = "is for the implicit procedure", "remove it; steps, rows and [explicit] take its place"
    problems = [Problem(key, fault, remedy) for key in keys]
    if case.output.steps > case.output.rows:
        fault = f"expected no more than rows = {case.output.rows}"
        problems.append(Problem("output.steps", fault, "a step is saved where a row is", case.output.steps))
    return problems


def check_target_step(case: Case | SpaceCase) -> list[Problem]:
    """Return the problem of a time step of which the shortest stage has too few."""
    target = case.explicit.target_step
    durations = [stage.duration for stage in case.stages if "duration" in stage.model_fields_set]
    if target is None or not durations or target * STEPS_OF_A_STAGE <= min(durations):
        return []
    fault = f"the shortest stage, of {min(durations):.3g} s, has fewer than {STEPS_OF_A_STAGE} such steps"
    return [Problem("explicit.target_step", fault, "take a few times the step without it", target)]


def check_material(case: Case | SpaceCase) -> list[Problem]:
    """Return the problems of a missing density, and of a velocity beyond that of sound: a unit taken for another."""
    parts: dict[str, Workpiece | SpaceWorkpiece] = {"workpiece": case.workpiece}
    parts |= {f"bodies.{name}": body for name, body in case.bodies.items()}
    problems = []
    for key, part in parts.items():
        name, velocity = part.material, part.velocity
        material = case.materials.get(name)
        if material is None:
            continue
        if material.density is None:
            remedy = 'add it: the explicit procedure needs it; steel has "7850 kg/m^3"'
            problems.append(Problem(f"materials.{name}.density", "missing key", remedy))
            continue
        if isinstance(material, UmatMaterial) or velocity is None:
            continue
        sound = float(np.sqrt(material.young / material.density))
        if float(np.linalg.norm(velocity)) > sound:
            fault = f"faster than sound in the material, {sound:.3g} mm/s"
            problems.append(
                Problem(f"{key}.velocity", fault, 'plain numbers are mm/s; "200 m/s" is 2e5', list(velocity))
            )
    return list({problem.key: problem for problem in problems}.values())


def check_friction(key: str, tool: Tool | SpaceTool, laws: Sequence[str] = CONTACTS) -> list[Problem]:
    """Return the problems of a tool's law of contact, which must be one of these."""
    problems = []
    if tool.contact not in laws:
        remedy = f"take {', '.join(laws[:-1])} or {laws[-1]}"
        problems.append(Problem(f"{key}.contact", "the explicit procedure has no such law", remedy, tool.contact))
    if tool.friction is not None:
        text, remedy = "friction that depends on the state is for implicit runs", "remove it, or take that procedure"
        problems.append(Problem(f"{key}.friction", text, remedy))
    if tool.mu > LARGEST_MU:
        problems.append(Problem(f"{key}.mu", f"expected a value <= {LARGEST_MU:g}", "steel on steel has 0.1", tool.mu))
    return problems


def check_time(key: str, stage: Stage | SpaceStage) -> list[Problem]:
    """Return the problems of how long a stage takes, and of how it starts and stops; a ram has a time of its own."""
    if stage.press is not None or stage.velocity is not None:
        fault = "a ram neither starts nor stops smoothly"
        return [Problem(f"{key}.ramp", fault, "leave it out", stage.ramp)] if stage.ramp is not None else []
    if "duration" not in stage.model_fields_set:
        return [Problem(f"{key}.duration", "missing key", 'add it: dynamics take their time, e.g. "80 us"')]
    if stage.ramp is not None and stage.ramp > 0.5 * stage.duration * (1 + 1e-12):
        fault = f"start and end do not fit into {stage.duration:g} s"
        return [Problem(f"{key}.ramp", fault, f"take at most {0.5 * stage.duration:.3g} s", stage.ramp)]
    return []


def check_loads(key: str, stage: Stage | SpaceStage, spread: str) -> list[Problem]:
    """Return the problems of a stage's loads; spread: the key of forces spread over the surface."""
    fault = "the explicit procedure has tools and displacements that move, and a velocity at the start, no loads"
    loads = [load for load in ("force", spread, "pressure") if getattr(stage, load)]
    return [Problem(f"{key}.{load}", fault, "leave it out") for load in loads]
