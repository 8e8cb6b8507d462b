# SPDX-License-Identifier: Apache-2.0
"""A material whose law is a compiled Abaqus UMAT: its table in a case, and its trial before anything is computed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from pydantic import Field

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.thermal import Thermal
from presswork.case.names import FileName
from presswork.case.part import Part
from presswork.case.settings import Whole
from presswork.case.units import Density, Number, Stress
from presswork.law.allowed import is_allowed
from presswork.law.umat import elastic_constants, try_umat

_FAULTS = {
    "not_finite": (
        "its first call gives stresses or a tangent that are not numbers",
        "it may read more than the {n_props} props given, or need more than {n_state} state variables",
    ),
    "overrun": (
        "it writes beyond its {n_state} state variables",
        "give state_variables as in its *DEPVAR",
    ),
    "components": (
        "it writes more than NTENS = {components} stresses",
        "it is not written for {family}: take a routine that asks for NDI and NTENS",
    ),
    "stopped": ("it stops (XIT) at its first call", "look at its own message; check props"),
}


FAMILIES = {3: "plane stress, as shells need it", 4: "solids in the plane", 6: "solids in space"}
"""Families of elements by the number of components of their stress."""


def kind_of_material(data: object) -> str:
    """Distinguish a table with a UMAT from others, as a discriminator of unions."""
    has_umat = "umat" in data if isinstance(data, dict) else isinstance(data, UmatMaterial)
    return "umat" if has_umat else "laws"


class UmatMaterial(Part):
    """A material law from a shared library with Abaqus's interface UMAT."""

    umat: FileName = Field(description="the shared library (.so) with the routine UMAT, relative to the case")
    props: tuple[Number, ...] = Field(
        default=(), description="PROPS, in mm, s, MPa: as the routine wants them, without units"
    )
    state_variables: Whole = Field(default=0, ge=0, description="NSTATV, as in its *DEPVAR")
    plastic_strain: Whole | None = Field(
        default=None, ge=1, description="which state variable, from 1, is the equivalent plastic strain"
    )
    jacobian: model.UmatJacobian = Field(
        default="stress_increment",
        description="what DDSDDE is: stress_increment, d(stress increment)/d(strain increment), or jaumann_kirchhoff, "
        "of laws of the whole deformation gradient",
    )
    density: Density | None = Field(
        default=None, description='density [t/mm^3], e.g. "7850 kg/m^3", for dynamics and heat'
    )
    thermal: Thermal | None = Field(default=None, description="thermal properties, needed with [heat]")
    thread_safe: bool = Field(
        default=False, description="whether several threads may call the routine at once; most Fortran routines may not"
    )
    yield_stress: Stress | None = Field(
        default=None,
        gt=0,
        description="first flow stress [MPa] of the sheet of a stamping, by which forces and energies are judged",
    )

    def find_density(self) -> float:
        """Return the density, 0 where none is given [t/mm3]."""
        return self.density or 0.0

    def is_metal(self) -> bool:
        """Whether there is a density."""
        return self.density is not None


def build_umat(
    name: str, material: UmatMaterial, folder: Path, components: int, *, run_user_code: bool = True
) -> model.Material | Problem:
    """Open and try the library of a material, if it may run; return the Model's, with the elastic constants it shows.

    components: of the stress: 3 of shells, 4 of solids in the plane, 6 of solids in space.
    run_user_code: without it the library is not opened, and the constants are nan.
    """
    key = f"materials.{name}"
    path = folder / material.umat
    if not path.is_file():  # also for names that no file can have
        remedy = f"no such file: {path}; `presswork material compile law.f` makes one"
        return Problem(f"{key}.umat", "cannot be opened", remedy, material.umat)
    path = path.resolve()
    n_state, n_props = material.state_variables, len(material.props)
    thermal = material.thermal.to_thermal(material.find_density()) if material.thermal and material.density else None
    if material.thermal is not None and components != 4:
        fault = f"{FAMILIES[components]}: heat of a UMAT is for implicit solids in the plane and in axisymmetry"
        return Problem(f"{key}.thermal", fault, "leave it out")
    if (material.plastic_strain or 0) > n_state:
        fault = f"there are only {n_state} state variables"
        return Problem(f"{key}.plastic_strain", fault, "count from 1", material.plastic_strain)
    if components == 3 and material.jacobian != "stress_increment":
        fault = "no shell takes it: the rate of stress asks for the strain across the sheet, which no routine gives"
        return Problem(f"{key}.jacobian", fault, 'take "stress_increment"', material.jacobian)
    law = model.Umat(
        str(path),
        material.props,
        n_state,
        material.jacobian,
        material.thread_safe,
        material.plastic_strain or 0,
        material.yield_stress or 0.0,
    )
    density = material.find_density()
    made = model.Material(name, math.nan, math.nan, hardening=None, umat=law, density=density, thermal=thermal)
    if not run_user_code:
        return made
    if not is_allowed(path):
        remedy = "if you trust where it comes from, add --run-user-code, or `presswork material allow` it for good"
        return Problem(f"{key}.umat", "its code has not been allowed to run here", remedy, material.umat)
    trial = try_umat(law, components)
    if trial.fault:
        remedy = "compile it with `presswork material compile`"
        return Problem(f"{key}.umat", f"cannot be used: {trial.fault}", remedy, material.umat)
    if trial.status in _FAULTS:
        words = {"n_props": n_props, "n_state": n_state, "components": components, "family": FAMILIES[components]}
        fault, remedy = (text.format(**words) for text in _FAULTS[trial.status])
        return Problem(f"{key}.umat", fault, remedy, material.umat)
    tangent = np.array(trial.tangent)
    if trial.status != "done" or not (np.diag(tangent) > 0.0).all() or not tangent[:2, :2].mean() > 0.0:
        fault = "its first call, at a strain of one millionth, gives no tangent (DDSDDE) of a solid"
        return Problem(f"{key}.umat", fault, f"check the {n_props} props and their units (MPa, mm, s)", material.umat)
    young, poisson = elastic_constants(tangent)
    return replace(made, young=young, poisson=poisson)
