# SPDX-License-Identifier: Apache-2.0
"""Turns a sheet material's forming limit into its curve, and into the limits that a part's strains are judged by."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.case.material.forming_limit.curves import (
    BLANK,
    curve_from_points,
    keeler_curve,
    scale_with_thickness,
    swift_hill_curve,
)
from presswork.case.material.forming_limit.marciniak import marciniak_kuczynski_curve
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.laws import KeelerLimit, PointsLimit, SwiftHillLimit
from presswork.case.material.sheet import SheetLaws
from presswork.case.material.umat import UmatMaterial, build_umat
from presswork.case.material.yld2000_fit import r_value
from presswork.formability import Formability, FormingLimitCurve
from presswork.model import Material

if TYPE_CHECKING:
    from presswork.case.shell.material import HeavyShellMaterial

SAME_THICKNESS = 0.02
"""Relative difference of thickness up to which a forming limit is that of the blank."""
_ALUMINIUM = 120e3
"""Young's modulus below which a sheet is no steel [MPa]."""


def build_curve(material: SheetLaws, thickness: float | None = None) -> FormingLimitCurve:
    """Find the forming limit curve that a material asks for.

    thickness: of the sheet that it is for [mm]; without it that of the sheet that was tested. Raises CaseError; also if
    the material asks for no curve.
    """
    limit = material.forming_limit
    if limit is None:
        remedy = "add [material.forming_limit] with law = keeler, points, swift_hill or marciniak_kuczynski"
        raise CaseError([Problem("forming_limit", "missing table", remedy)], "material")
    if isinstance(limit, KeelerLimit):
        own = thickness if limit.thickness is None else limit.thickness
        if own is None:
            remedy = "give forming_limit.thickness, or --thickness"
            raise CaseError([Problem("thickness", "Keeler's curve needs the sheet's thickness", remedy)], "material")
        return keeler_curve(own, limit.n)
    if isinstance(limit, PointsLimit):
        measured = curve_from_points(limit.points)
        if limit.scaling == "none" or limit.thickness is None or thickness is None:
            return measured
        return scale_with_thickness(measured, limit.thickness, thickness)
    if material.kinematic is not None:
        text = f"{limit.law} is for isotropic hardening alone, and this material has back stresses"
        raise CaseError([Problem("forming_limit.law", text, "give keeler or points")], "material")
    if isinstance(material.hardening, HotLaw):
        hot = material.hardening.law
        text = f"{limit.law} is computed for one temperature and no strain rate, and {hot} depends on both"
        raise CaseError([Problem("forming_limit.law", text, "give keeler or points")], "material")
    function, law = material.yield_function.build(), material.build_law()
    if isinstance(limit, SwiftHillLimit):
        return swift_hill_curve(function, law)
    return marciniak_kuczynski_curve(function, law, imperfection=limit.imperfection)


def build_sheets(
    materials: Mapping[str, HeavyShellMaterial | UmatMaterial],
    used: str,
    thickness: float,
    source: Path | None,
    run_user_code: bool,
    thickness_key: str = "blank.thickness",
) -> tuple[Material, ...]:
    """Return a case's materials for the Model; that which the sheet is of with what its strains are judged by.

    thickness_key: where the case has the sheet's thickness, for errors. Raises CaseError.
    """
    judged, sheet = Formability(), materials[used]
    if not isinstance(sheet, UmatMaterial):
        try:
            judged = build_formability(sheet, f"materials.{used}", thickness, thickness_key)
        except CaseError as error:
            raise CaseError(error.problems, source) from None
    folder, built, problems = source.parent if source else Path(), [], []
    for name, table in materials.items():
        if isinstance(table, UmatMaterial):
            made = build_umat(name, table, folder, 3, run_user_code=run_user_code)
        else:
            grain = table.grain.to_model() if table.grain else None
            made = dataclasses.replace(table.to_model(name), density=table.find_density(), grain=grain)
        if isinstance(made, Problem):
            problems.append(made)
        else:
            built.append(dataclasses.replace(made, formability=judged) if name == used else made)
    if problems:
        raise CaseError(problems, source)
    return tuple(built)


def build_formability(
    material: SheetLaws, key: str, thickness: float, thickness_key: str = "blank.thickness"
) -> Formability:
    """Return what strains of a material are judged by; without a forming limit it has no curve.

    key, thickness_key: of the material and of the thickness in the case, for errors. thickness: of the blank [mm].
    Raises CaseError.
    """
    r = mean_r_value(material)
    limit = material.forming_limit
    if limit is None:
        return Formability(r=r)
    try:
        curve = build_curve(material, thickness)
    except CaseError as error:
        raise CaseError([_put_into_case(p, key, limit, thickness_key) for p in error.problems]) from None
    usual = 0.08 if material.young < _ALUMINIUM else 0.1
    margin = usual if limit.safety_margin is None else limit.safety_margin
    return Formability(curve, margin, r, _note_of_thickness(limit, key, thickness))


def _note_of_thickness(limit: object, key: str, thickness: float) -> str:
    """Note that the limit is that of a sheet of another thickness; empty where it is not."""
    remedy = ""
    if isinstance(limit, KeelerLimit):
        remedy = f"leave {key}.forming_limit.thickness out for the blank's own"
    elif isinstance(limit, PointsLimit) and limit.scaling == "none":
        remedy = f'set {key}.forming_limit.scaling = "keeler", or give a curve of this thickness'
    own = getattr(limit, "thickness", None)
    if not remedy or own is None or abs(own - thickness) <= SAME_THICKNESS * thickness:
        return ""
    return f"the forming limit is that of a sheet of {own:g} mm, and the blank is {thickness:g} mm thick: {remedy}"


def mean_r_value(material: SheetLaws) -> float:
    """Return the normal anisotropy (r00 + 2 r45 + r90)/4 of a material's yield function."""
    r00, r45, r90 = r_value(material.yield_function.build(), np.radians([0.0, 45.0, 90.0]))
    return float(r00 + 2 * r45 + r90) / 4


def _put_into_case(problem: Problem, material: str, limit: object, thickness_key: str) -> Problem:
    """Return a problem of a forming limit with its key in the case: most are of the table of the limit."""
    key = problem.key
    if key == BLANK or (key == "thickness" and getattr(limit, "thickness", None) is None):
        remedy = f'{problem.remedy}; a foil needs {material}.forming_limit = {{law = "marciniak_kuczynski"}} or points'
        return dataclasses.replace(problem, key=thickness_key, remedy=remedy)
    if not key or hasattr(limit, key):
        return dataclasses.replace(problem, key=f"{material}.forming_limit.{key}".rstrip("."))
    return dataclasses.replace(problem, key=f"{material}.{key}")
