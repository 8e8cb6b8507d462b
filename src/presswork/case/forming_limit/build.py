# SPDX-License-Identifier: Apache-2.0
"""From a sheet material's forming limit to its curve, and to what a part's strains are judged by."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.case.forming_limit.curves import curve_from_points, keeler_curve, swift_hill_curve
from presswork.case.forming_limit.marciniak import marciniak_kuczynski_curve
from presswork.case.sheet import SheetLaws
from presswork.case.sheet_laws import KeelerLimit, PointsLimit, SwiftHillLimit
from presswork.case.yield_function import r_value
from presswork.formability import Formability, FormingLimitCurve
from presswork.model import Material

_ALUMINIUM = 120e3
"""Young's modulus below which a sheet is no steel [MPa]."""


def build_curve(material: SheetLaws) -> FormingLimitCurve:
    """Find the forming limit curve that a material asks for. Raises CaseError; also if it asks for none."""
    limit = material.forming_limit
    if limit is None:
        remedy = "add [material.forming_limit] with law = keeler, points, swift_hill or marciniak_kuczynski"
        raise CaseError([Problem("forming_limit", "missing table", remedy)], "material")
    if isinstance(limit, KeelerLimit):
        return keeler_curve(limit.thickness, limit.n)
    if isinstance(limit, PointsLimit):
        return curve_from_points(limit.points)
    if material.kinematic is not None:
        text = f"{limit.law} knows isotropic hardening alone, and this material has back stresses"
        raise CaseError([Problem("forming_limit.law", text, "give keeler or points")], "material")
    function, law = material.yield_function.build(), material.build_law()
    if isinstance(limit, SwiftHillLimit):
        return swift_hill_curve(function, law)
    return marciniak_kuczynski_curve(function, law, imperfection=limit.imperfection)


def build_sheets(materials: Mapping[str, SheetLaws], used: str, source: Path | None) -> tuple[Material, ...]:
    """Return a case's materials for the Model; that which the sheet is of with what its strains are judged by.

    Raises CaseError.
    """
    try:
        judged = build_formability(materials[used], f"materials.{used}")
    except CaseError as error:
        raise CaseError(error.problems, source) from None
    return tuple(
        dataclasses.replace(sheet.to_model(name), formability=judged if name == used else Formability())
        for name, sheet in materials.items()
    )


def build_formability(material: SheetLaws, key: str) -> Formability:
    """Return what strains of a material are judged by; without a forming limit it has no curve.

    key: of the material in the case, for errors. Raises CaseError.
    """
    r = mean_r_value(material)
    limit = material.forming_limit
    if limit is None:
        return Formability(r=r)
    try:
        curve = build_curve(material)
    except CaseError as error:
        raise CaseError([dataclasses.replace(p, key=_place(key, p.key, limit)) for p in error.problems]) from None
    usual = 0.08 if material.young < _ALUMINIUM else 0.1
    return Formability(curve, usual if limit.safety_margin is None else limit.safety_margin, r)


def mean_r_value(material: SheetLaws) -> float:
    """Return the normal anisotropy (r00 + 2 r45 + r90)/4 of a material's yield function."""
    r00, r45, r90 = r_value(material.yield_function.build(), np.radians([0.0, 45.0, 90.0]))
    return float(r00 + 2 * r45 + r90) / 4


def _place(material: str, key: str, limit: object) -> str:
    """Return the key in the case of a problem's key: most are of the table of the limit."""
    if not key or hasattr(limit, key):
        return f"{material}.forming_limit.{key}".rstrip(".")
    return f"{material}.{key}"
