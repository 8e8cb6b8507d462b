# SPDX-License-Identifier: Apache-2.0
"""Gravity of a case, and what theory forbids of it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

from pydantic import AfterValidator

from presswork.case.errors import Problem
from presswork.case.units import AccelerationVector, AccelerationVector3, fault
from presswork.model import Model

if TYPE_CHECKING:
    from presswork.case.case_file import CaseFile

DESCRIPTION = (
    "acceleration of gravity, by which the weight of all bodies acts: [x, y], in space and on sheets [x, y, z] "
    '[mm/s^2], for instance [0, 0, "-9.81 m/s^2"]. An implicit run applies it linearly over its first stage, an '
    "explicit one from the first cycle on"
)
METRES = (9.0, 10.5)
"""Size of gravity in m/s2, which as mm/s2 is a slip."""


def _check_size(gravity: tuple[float, ...]) -> tuple[float, ...]:
    """Refuse gravity in m/s2 where mm/s2 are meant."""
    size = math.hypot(*gravity)
    if METRES[0] < size < METRES[1]:
        raise fault(f"{size:g} mm/s^2 is a thousandth of the earth's", 'plain numbers are mm/s^2; write "-9.81 m/s^2"')
    return gravity


Gravity = Annotated[AccelerationVector, AfterValidator(_check_size)]
Gravity3 = Annotated[AccelerationVector3, AfterValidator(_check_size)]


def find_gravity(gravity: tuple[float, ...] | None) -> tuple[float, ...]:
    """Return the Model's gravity; empty where there is none."""
    return gravity if gravity is not None and any(gravity) else ()


def check_gravity(case: CaseFile, model: Model) -> list[Problem]:
    """Return the problems of a weight without density, across an axis, and across a plane of symmetry."""
    if not model.gravity:
        return []
    problems = [
        Problem(f"materials.{name}.density", "missing key", 'add it: gravity needs it; steel has "7850 kg/m^3"')
        for name in dict.fromkeys(model.materials[block.material].name for block in model.mesh.blocks)
        if next(m for m in model.materials if m.name == name).density == 0.0
    ]
    along, value = [part != 0.0 for part in model.gravity], list(model.gravity)
    if model.analysis == "axisymmetric" and along[0]:
        fault = "has a part across the axis, under which the body would not stay axisymmetric"
        return [*problems, Problem("gravity", fault, "give x = 0, or compute in space", value)]
    if model.cyclic is not None and (along[0] or along[1]):
        fault = "has a part across the axis z of a sector, under which its n sectors would not stay alike"
        return [*problems, Problem("gravity", fault, "give x = y = 0, or compute the whole body", value)]
    return problems + [
        Problem("gravity", f"has a part across the symmetry plane {key}", remedy, value)
        for key, axis, remedy in _list_planes(case, model)
        if along[axis]
    ]


def _list_planes(case: CaseFile, model: Model) -> list[tuple[str, int, str]]:
    """Return the planes that a case calls symmetric: key, axis of the normal, and remedy."""
    remedy = "leave the plane out and compute the whole, or turn gravity into the plane"
    planes = [(f"{'xy'[axis]} = 0", axis, remedy) for axis in range(2) if model.symmetry[axis]]
    for name, entry in getattr(case, "boundary", {}).items():
        if getattr(entry, "symmetry", None):
            planes += [(f"boundary.{name}", "xyz".index(held), remedy) for held in entry.fix if held in ("x", "y", "z")]
    return planes
