# SPDX-License-Identifier: Apache-2.0
"""What of the case of a solid in space goes with one procedure and not with the other."""

from __future__ import annotations

from presswork import _core, model
from presswork.case.errors import Problem
from presswork.case.explicit_checks import (
    CONTACTS,
    check_explicit_keys,
    check_friction,
    check_implicit_keys,
    check_loads,
    check_material,
    check_target_step,
    check_time,
)
from presswork.case.press.builder import check_in_explicit
from presswork.case.space.schema import SpaceCase, SpaceStage, SpaceWorkpiece

USUAL = "hex8_1pt"
"""The element of the explicit procedure where the case names none."""


def choose_element(case: SpaceCase, body: SpaceWorkpiece | None = None) -> model.SpaceElement:
    """Return the element of a body of a case, without it of the workpiece."""
    piece = body or case.workpiece
    return USUAL if case.procedure == "explicit" and "element" not in piece.model_fields_set else piece.element


def check_space_procedure(case: SpaceCase) -> list[Problem]:
    """Return the problems of keys that the case's procedure cannot do, or would ignore."""
    implicit = case.procedure == "implicit"
    problems = []
    known = model.list_names(_core.Family.space, in_implicit=implicit, in_explicit=not implicit)
    for key, body in _list_bodies(case).items():
        element = choose_element(case, body)
        if element not in known:
            fault = f"the {case.procedure} procedure has no such element"
            problems.append(Problem(f"{key}.element", fault, f"take {' or '.join(known)}", element))
    return problems + (_check_implicit(case) if implicit else _check_explicit(case))


def _check_implicit(case: SpaceCase) -> list[Problem]:
    return check_implicit_keys(
        case, [f"{key}.velocity" for key, body in _list_bodies(case).items() if body.velocity is not None]
    )


def _list_bodies(case: SpaceCase) -> dict[str, SpaceWorkpiece]:
    return {"workpiece": case.workpiece, **{f"bodies.{name}": body for name, body in case.bodies.items()}}


def _check_explicit(case: SpaceCase) -> list[Problem]:
    problems = [*check_material(case), *check_target_step(case)]
    for name, tool in case.tools.items():
        problems += check_friction(f"tools.{name}", tool, (*CONTACTS, "shear", "coulomb_capped"))
    for index, stage in enumerate(case.stages):
        problems += _check_stage(f"stages.{index}", stage)
        if stage.press is not None and stage.press.name in case.presses:
            press, blows = case.presses[stage.press.name], not stage.displacement
            problems += check_in_explicit(f"stages.{index}", press, stage.press, blows=blows)
    return problems + check_explicit_keys(case)


def _check_stage(key: str, stage: SpaceStage) -> list[Problem]:
    return check_time(key, stage) + check_loads(key, stage, "face_force")
