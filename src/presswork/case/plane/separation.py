# SPDX-License-Identifier: Apache-2.0
"""Cracks that are cut into the mesh: the keys, what they go with, and the Model's settings."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic import Field

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.part import Part
from presswork.case.plane.clearance import check_clearance
from presswork.case.units import Length, Number

if TYPE_CHECKING:
    from presswork.case.plane.schema import Case

OF_LENGTH = 0.5
"""Size of cells where cracks grow over the length over which damage is averaged."""
LARGEST = 0.75
"""Largest such size over the length: cracks step by half of it."""
NAME = "crack_faces"
"""Name of the contact of the faces."""


class Separation(Part):
    """Where the mean damage of the workpiece is critical, cracks are cut into its mesh; they may divide it."""

    size: Length | None = Field(
        default=None,
        gt=0,
        description="largest edge of cells where cracks grow [mm]; without it: half of the length over which the "
        "damage of the material is averaged",
    )
    mu: Number = Field(default=0.1, ge=0, le=10, description="coefficient of friction between the faces of cracks")


def check_separation(case: Case) -> list[Problem]:
    """Return the problems of a case that asks for separation without what it takes."""
    if case.separation is None:
        return []
    problems = []
    if case.procedure != "explicit":
        remedy = 'set procedure = "explicit" and give the density, or leave out [separation]: cracks are reported'
        problems.append(Problem("separation", "the implicit procedure cuts no cracks", remedy))
    if case.remesh is None or not case.remesh.enabled:
        problems.append(Problem("separation", "a crack needs a new mesh", "add [remesh]"))
    for key in ("bodies", "contacts", "heat"):
        if getattr(case, key):
            fault = "does not go together with [separation]: one body without heat is cut"
            problems.append(Problem(key, fault, "leave it out, or leave out [separation]"))
    material = case.materials.get(case.workpiece.material)
    if material is None:
        return problems
    key = f"materials.{case.workpiece.material}"
    damage = getattr(material, "damage", None)
    if damage is None or damage.critical is None:
        fault = "missing table: it decides where a crack begins" if damage is None else "missing key"
        remedy = 'add it, for instance criterion = "modified_mohr_coulomb", or "cockcroft_latham" with critical'
        problems.append(Problem(f"{key}.damage" + ("" if damage is None else ".critical"), fault, remedy))
    if getattr(material, "gtn", None) is not None:
        fault = "pores have a crack of their own: they do not go together with [separation]"
        problems.append(Problem(f"{key}.gtn", fault, "leave out one of them"))
    return problems


def add_separation(case: Case, built: model.Model) -> model.Model:
    """Return a Model with the separation that its case asks for, and the contact of the faces. Raises CaseError."""
    remeshing, material = built.remeshing, built.materials[built.mesh.blocks[0].material]
    if case.separation is None or remeshing is None:
        return built
    length = None if material.damage is None else material.damage.length
    size, problems = case.separation.size, check_clearance(built.plane_tools, built.stages, built.mesh.points)
    if size is None and length is not None:
        size = OF_LENGTH * length
    if size is not None and length is not None and size > LARGEST * length:
        fault = f"cells of {size:.3g} mm are too large for damage averaged over {length:.3g} mm"
        remedy = f"give {OF_LENGTH * length:.2g} or less, or a larger length"
        problems.append(Problem("separation.size", fault, remedy))
    if size is not None and size < remeshing.smallest_size:
        fault = f"cells of {size:.3g} mm are wanted where cracks grow: the smallest size is above it"
        remedy = f"give {0.75 * size:.2g} or less"
        problems.append(Problem("remesh.smallest_size", fault, remedy, remeshing.smallest_size))
    contact = model.BodyContact(NAME, (0, 0), 0, "coulomb", mu=case.separation.mu, keeps_slave=True, by_itself=True)
    if problems:
        raise CaseError(problems, case.source)
    return replace(built, separation=model.Separation(size), contacts=(contact,))
