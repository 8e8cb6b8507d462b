# SPDX-License-Identifier: Apache-2.0
"""Which laws a solid can have, with which elements and which solver."""

from __future__ import annotations

from typing import TYPE_CHECKING

from presswork.case.errors import Problem
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.law_needs import check_grain, check_needs
from presswork.case.material.umat import UmatMaterial
from presswork.case.plane import schema
from presswork.case.plane.bodies import list_bodies
from presswork.case.settings import Solver

if TYPE_CHECKING:
    from presswork.case.space.schema import SpaceCase

FRICTION_OF_FLOW = ("shear", "wanheim_bay", "levanov")
"""Laws of friction by the flow stress alone."""
PORE_HARDENING = ("linear", "swift", "ludwik", "voce", "linear_voce", "hockett_sherby", "swift_voce")
"""Hardening laws of a metal with pores: formulas of at most six parameters."""
BESIDE = (
    "kinematic", "rate", "heating", "young_decrease", "expansion", "young_factor", "poisson_by_temperature",
)  # fmt: skip
"""Keys of a material that the closed form of von Mises does not know."""


def check_laws(case: schema.Case) -> list[Problem]:
    """Return the problems of materials with solids, elements and the solver."""
    problems = []
    for name, material in case.materials.items():
        if not isinstance(material, UmatMaterial):
            if material.grain is not None:
                knows = case.heat is not None or material.heating is not None
                problems += check_grain(
                    f"materials.{name}", material.grain, knows_temperature=knows, stages=case.stages
                )
            problems += check_pores(f"materials.{name}", material) + _check_pores_in(case, name, material)
            problems += material.check_in_solids(f"materials.{name}")
            if isinstance(material.rolling_direction, tuple):
                fault, remedy = "expected an angle from x in the plane [degrees]", "e.g. 45"
                direction = list(material.rolling_direction)
                problems.append(Problem(f"materials.{name}.rolling_direction", fault, remedy, direction))
    used = sorted({body.material for _, body in list_bodies(case).values()} & set(case.materials))
    problems += check_needs(case.materials, used, case.stages, heated=case.heat is not None)
    for name in used:
        material = case.materials[name]
        if not isinstance(material, UmatMaterial):
            problems += check_integrator(name, material, case.solver)
    return problems + _check_umats(case) + check_friction_of_elastic(case)


def check_friction_of_elastic(case: schema.Case | SpaceCase) -> list[Problem]:
    """Return the problems of tools whose friction follows the flow stress of a workpiece that has none."""
    name = case.workpiece.material
    material = case.materials.get(name)
    if material is None or isinstance(material, UmatMaterial) or material.hardening is not None:
        return []
    fault = f"friction by shear is a part of the flow stress, and {name} is elastic: it has no hardening"
    remedy = f"take coulomb, with mu, or give materials.{name}.hardening"
    return [
        Problem(f"tools.{tool}.contact", fault, remedy, entry.contact)
        for tool, entry in case.tools.items()
        if entry.contact in FRICTION_OF_FLOW and entry.m > 0.0
    ]


def check_pores(key: str, material: schema.Material) -> list[Problem]:
    """Return the problems of pores in a metal whose other laws they do not go with; key: of the material."""
    if material.gtn is None:
        return []
    beside = [name for name in (*BESIDE, "grain") if name != "heating" and getattr(material, name) is not None]
    if material.yield_function.law != "von_mises":
        beside.insert(0, "yield_function")
    fault = "pores are for a metal of von Mises with isotropic hardening alone"
    problems = [Problem(f"{key}.{name}", fault, "leave it out, or gtn") for name in beside]
    if material.heating is not None and material.heating.heat_capacity is not None:
        text, remedy = "a metal with pores is not heated adiabatically", "leave it out, or take [heat]"
        problems.append(Problem(f"{key}.heating.heat_capacity", text, remedy))
    if material.hardening is not None and material.hardening.law not in PORE_HARDENING:
        remedy = f"take one of {', '.join(PORE_HARDENING)}"
        problems.append(Problem(f"{key}.hardening.law", "pores take no such law", remedy, material.hardening.law))
    return problems


def _check_pores_in(case: schema.Case, name: str, material: schema.Material) -> list[Problem]:
    """Return the problems of pores with what else the case has."""
    if material.gtn is None:
        return []
    problems, key = [], f"materials.{name}.gtn"
    if case.procedure == "explicit":
        if case.heat is not None:
            text = "in the explicit procedure heat is not computed in a metal with pores"
            problems.append(Problem(key, text, 'leave [heat] out, or set procedure = "implicit"'))
        return problems
    for _, (place, body) in list_bodies(case).items():
        if body.material == name and body.element == "quad4_1pt":
            fault = "its hourglass control needs the flow stress of a dense metal"
            problems.append(Problem(f"{place}.element", fault, "take quad4_fbar", body.element))
    return problems


def check_integrator(name: str, material: schema.Material, solver: Solver) -> list[Problem]:
    """Return the problems of an integrator or a tangent that is of von Mises with isotropic hardening alone."""
    present = [key for key in BESIDE if getattr(material, key) is not None]
    if isinstance(material.hardening, HotLaw):
        present.append(material.hardening.law)
    if material.yield_function.law != "von_mises":
        present.insert(0, "yield_function")
    if not present:
        return []
    fault, problems = f"it is for von Mises with isotropic hardening alone, and {name} has {', '.join(present)}", []
    if solver.integrator != "backward_euler":
        problems.append(Problem("solver.integrator", fault, 'take "backward_euler"', solver.integrator))
    if solver.tangent == "thesis":
        problems.append(Problem("solver.tangent", fault, 'take "consistent"', "thesis"))
    return problems


def _check_umats(case: schema.Case) -> list[Problem]:
    """Return the problems of laws from shared libraries with elements and tangents that need a flow stress."""
    users = {name for name, material in case.materials.items() if isinstance(material, UmatMaterial)}
    problems = []
    for _, (key, body) in list_bodies(case).items():
        if case.procedure == "implicit" and body.material in users and body.element == "quad4_1pt":
            fault = "its hourglass control needs a flow stress, which a UMAT does not give"
            problems.append(Problem(f"{key}.element", fault, "take quad4_fbar", body.element))
    if users and case.solver.tangent == "thesis":
        fault = "its terms are for the laws of presswork; a UMAT brings its tangent with it"
        problems.append(Problem("solver.tangent", fault, 'take "consistent"', "thesis"))
    return problems
