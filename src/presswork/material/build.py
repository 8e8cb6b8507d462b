# SPDX-License-Identifier: Apache-2.0
"""From a sheet material's forming limit to its curve."""

from __future__ import annotations

from presswork.case.errors import CaseError, Problem
from presswork.case.sheet import SheetMaterial
from presswork.case.sheet_laws import KeelerLimit, PointsLimit, SwiftHillLimit
from presswork.material.forming_limit import FormingLimitCurve, curve_from_points, keeler_curve, swift_hill_curve
from presswork.material.marciniak import marciniak_kuczynski_curve


def build_curve(material: SheetMaterial) -> FormingLimitCurve:
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
