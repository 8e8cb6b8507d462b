# SPDX-License-Identifier: Apache-2.0
"""The case of the one-step solver: a finished part, its sheet, and what holds the sheet back. Units as in schema.py."""

from __future__ import annotations

import logging
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
import tomli_w
from pydantic import Field, model_validator

from presswork.case.case_file import CaseFile
from presswork.case.errors import CaseError, Problem
from presswork.case.material.forming_limit.build import build_formability
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.library import add_library_materials, find_material_problem, find_sheet
from presswork.case.material.yield_function import Hill1948, VonMisesYield, Yld2000
from presswork.case.names import FileName, Name, Title
from presswork.case.part import Part
from presswork.case.shell.material import ShellMaterial
from presswork.case.stamping.bead import Bead
from presswork.case.tool_sizes import check_thickness, warn_of_thickness
from presswork.case.units import LENGTH, Angle, Force, Length, Number, fault, unit_factor
from presswork.mesh import MeshError
from presswork.mesh.files.part_file import PartMesh, read_part
from presswork.model import OneStepModel, PartBead

logger = logging.getLogger(__name__)

_TRIANGLES = 10_000
"""Number of triangles, roughly, to which a triangulated part is refined where no element_size is given."""
LAYERS = 3


class PartFile(Part):
    """The finished part's mid-surface."""

    path: FileName = Field(description="STL, gmsh, Abaqus, VTK or I-DEAS file, beside the case")
    unit: str = Field(default="mm", description="unit of the file's coordinates")
    draw_direction: Literal["x", "-x", "y", "-y", "z", "-z"] = Field(
        default="-z", description="the direction of the punch in the file's axes"
    )
    element_size: Length | None = Field(
        default=None,
        gt=0,
        description="longer edges of triangles are halved [mm]; without it: so that about 10,000 come out. "
        "Quadrilaterals stay as they are",
    )
    symmetry: tuple[Literal["x", "y"], ...] = Field(
        default=(), description='planes through the origin that mirror the part: "x" is the plane x = 0'
    )
    addendum: Length = Field(
        default=0.0, ge=0, description="width of a level flange that is added to the part's outline [mm]"
    )


class FlatBlank(Part):
    """The sheet."""

    material: FileName = Field(
        description='name of one of the [materials], or of the library, or "my_steel.toml", a material file of your own'
    )
    thickness: Length = Field(gt=0, description="thickness of the blank [mm]")
    rolling_direction: Angle = Field(default=0.0, description="angle of the rolling direction from x [degree]")
    points: int = Field(
        default=LAYERS, strict=True, ge=1, le=11, description="points through the thickness; 1: no bending"
    )


class Process(Part):
    """What holds the sheet back."""

    holder_force: Force = Field(default=0.0, ge=0, description="blank-holder force on the whole part [N]")
    mu: Number = Field(default=0.1, ge=0, lt=1, description="coefficient of friction under the holder and on radii")
    beads: tuple[Bead, ...] = Field(default=(), description="drawbeads")
    stages: int = Field(
        default=1,
        strict=True,
        ge=1,
        le=9,
        description="shapes that the sheet goes through, the part among them; 1: one step. 3 for deep parts",
    )


NOT_IN_ONE_STEP = {
    "kinematic": "back stresses",
    "rate": "strain rate",
    "heating": "temperature",
    "young_decrease": "change of Young's modulus",
    "expansion": "temperature",
    "young_factor": "temperature",
    "poisson_by_temperature": "temperature",
    "damage": "path of stress and strain, along which damage accumulates",
}
"""Keys of a material that one step cannot use; what a material of the library brings of them is not heeded."""


class OneStepCase(CaseFile):
    """A complete case of the one-step solver. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line; it is the title of pictures")
    analysis: Literal["onestep"] = Field(description="onestep")
    part: PartFile = Field(description="the finished part")
    blank: FlatBlank = Field(description="the sheet")
    materials: dict[Name, ShellMaterial] = Field(default={}, description="materials by name")
    process: Process = Field(default=Process(), description="what holds the sheet back")

    @model_validator(mode="before")
    @classmethod
    def _prepare(cls, data: Any) -> Any:
        return add_library_materials(data, "blank") if isinstance(data, dict) else data

    def check_together(self) -> None:
        """Refuse laws that the solver cannot take."""
        material = self.materials.get(self.blank.material)
        if material is not None and not isinstance(simplify_yield(material).yield_function, VonMisesYield | Hill1948):
            raise fault(
                f"{material.yield_function.law} gives no strain for a stress in closed form",
                "give the material hill1948 with its r-values, or von_mises",
                key="blank",
            )
        if material is not None and material.hardening is None:
            fault_text, key = "missing key: one step needs a flow stress", f"materials.{self.blank.material}.hardening"
            raise fault(fault_text, 'for instance {law = "swift", K = 565, e0 = 0.007, n = 0.26}', key=key)
        if material is not None and isinstance(material.hardening, HotLaw):
            raise fault(
                f"one step has no strain rate and temperature, which {material.hardening.law} depends on",
                "give the flow stress against plastic strain alone, e.g. a table at one rate and temperature",
                key=f"materials.{self.blank.material}.hardening",
            )
        library = find_sheet(material.library, self._folder()).material if material and material.library else None
        for key, words in NOT_IN_ONE_STEP.items():
            if material is not None and getattr(material, key) not in (None, getattr(library, key, None)):
                raise fault(
                    f"one step has no {words}: it goes from the blank to the part at once",
                    f"leave {key} out of the material",
                    key=f"materials.{self.blank.material}.{key}",
                )

    def _folder(self) -> Path | None:
        return self.source.parent if self.source else None

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Self:
        """Validate a case given as the tables of its file, and write that file's text from them. Raises CaseError."""
        case = cls.model_validate(data)
        case._text = tomli_w.dumps(data)
        return case


def build_onestep_model(case: OneStepCase) -> OneStepModel:
    """Read the part and build the Model. Raises CaseError."""
    if problem := find_material_problem("blank", case.blank.material, case.materials):
        raise CaseError([problem], case.source)
    part, notes = _read(case)
    span = float(np.ptp(part.points, axis=0).max())
    if case.blank.thickness > 0.1 * span:
        text = f"expected a sheet: the part is only {span:.4g} mm across"
        raise CaseError([Problem("blank.thickness", text, "check the units", case.blank.thickness)], case.source)
    if (thin := check_thickness(case.blank.thickness, span)) is not None:
        raise CaseError([thin], case.source)
    for warning in warn_of_thickness(case.blank.thickness, span):
        logger.warning("%s", warning)
    given = case.materials[case.blank.material]
    sheet = simplify_yield(given)
    if sheet is not given:
        notes += ("one step takes Hill's yield function of the r-values in place of yld2000",)
    judged = build_formability(sheet, f"materials.{case.blank.material}", case.blank.thickness)
    return OneStepModel(
        title=case.title,
        points=part.points,
        triangles=part.triangles,
        quadrilaterals=part.quadrilaterals,
        rims=part.rims,
        material=replace(sheet.to_model(case.blank.material), formability=judged),
        thickness=case.blank.thickness,
        rolling_direction=radians(case.blank.rolling_direction),
        symmetry=("x" in case.part.symmetry, "y" in case.part.symmetry),
        holder_force=case.process.holder_force,
        mu=case.process.mu,
        beads=tuple(PartBead(bead.polyline(), bead.force) for bead in case.process.beads),
        layers=case.blank.points,
        stages=case.process.stages,
        notes=notes,
        case_text=case.text,
    )


def simplify_yield(material: ShellMaterial) -> ShellMaterial:
    """Return the material of one step: with Hill's yield function of the same r-values in place of Yld2000-2d."""
    chosen = material.yield_function
    hill = chosen.find_hill() if isinstance(chosen, Yld2000) else None
    return material if hill is None else material.model_copy(update={"yield_function": hill})


def _read(case: OneStepCase) -> tuple[PartMesh, tuple[str, ...]]:
    try:
        scale = unit_factor(case.part.unit, LENGTH)
    except ValueError as error:
        problem = Problem("part.unit", f"expected a unit of length, but {error}", "e.g. mm, m, inch", case.part.unit)
        raise CaseError([problem], case.source) from error
    path = (case.source.parent if case.source else Path()) / case.part.path
    planes = ("x" in case.part.symmetry, "y" in case.part.symmetry)

    def read(element_size: float | None) -> tuple[PartMesh, tuple[str, ...]]:
        return read_part(
            path,
            scale=scale,
            draw_direction=case.part.draw_direction,
            element_size=element_size,
            addendum=case.part.addendum,
            symmetry=planes,
        )

    try:
        part, notes = read(case.part.element_size)
        if case.part.element_size is None and len(part.triangles) and not len(part.quadrilaterals):
            part, notes = read(_default_size(part))
    except MeshError as error:
        remedied = (key for key in ("unit", "element_size") if key in error.remedy)
        key = next(remedied, "addendum" if "addendum" in error.fault else "path")
        problem = Problem(f"part.{key}", error.fault, error.remedy, getattr(case.part, key))
        raise CaseError([problem], case.source) from error
    return part, notes


def _default_size(part: PartMesh) -> float:
    """Return the edge length of equilateral triangles of which about _TRIANGLES cover the part, times 1.5."""
    a, b, c = (part.points[part.triangles[:, k]] for k in range(3))
    area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    return 1.5 * float(np.sqrt(4.0 / np.sqrt(3.0) * area / _TRIANGLES))
