# SPDX-License-Identifier: Apache-2.0
"""Forming limit curves: Keeler's, from points, Swift-Hill.

Strains are true (logarithmic). Marciniak-Kuczynski is in marciniak.py, limits in stresses are in material/.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from presswork import _core
from presswork.case.errors import CaseError, Problem
from presswork.case.material.forming_limit.proportional import find_stress
from presswork.formability import FormingLimitCurve
from presswork.model import FloatArray

MINOR_RANGE = (-0.5, 0.5)
"""Minor strains over which Keeler's curve is drawn."""
BLANK = "the blank's thickness"
"""Name in problems of the thickness that a curve is scaled to."""
_KEELER = (23.3, 14.13)
"""FLD0 at n = 0.21: per cent, and per cent for each mm of thickness."""


def keeler_curve(thickness: float, n: float) -> FormingLimitCurve:
    """Return Keeler and Brazier's curve for mild and conventional high-strength steel.

    thickness [mm], n: exponent of hardening. FLD0 = (23.3 + 14.13 t) n / 0.21 percent of engineering strain; left of it
    major + minor is constant, right of it the engineering strains rise by 0.6 (Stoughton & Zhu 2004). Raises CaseError.
    """
    problems = _thickness_problems({"thickness": thickness})
    if not 0.01 <= n <= 0.5:
        problems.append(Problem("n", "expected a hardening exponent from 0.01 to 0.5", "about 0.2 for steel", n))
    if problems:
        raise CaseError(problems, "Keeler's curve")
    lowest = math.log1p((_KEELER[0] + _KEELER[1] * thickness) * n / 0.21 / 100)
    left = np.array([MINOR_RANGE[0], 0.0])
    right = np.linspace(0.0, MINOR_RANGE[1], 51)[1:]
    major = np.concatenate([lowest - left, np.log(0.6 * np.expm1(right) + math.exp(lowest))])
    return FormingLimitCurve(np.concatenate([left, right]), major, f"Keeler, t = {thickness:g} mm, n = {n:g}")


def _thickness_problems(thicknesses: Mapping[str, float]) -> list[Problem]:
    expected = "expected a thickness from 0.1 to 4 mm: Keeler's forming limit was measured on sheets to 3 mm"
    return [Problem(key, expected, "give it in mm", t) for key, t in thicknesses.items() if not 0.1 <= t <= 4.0]


def scale_with_thickness(curve: FormingLimitCurve, measured: float, thickness: float) -> FormingLimitCurve:
    """Return the curve of a sheet of another thickness [mm], raised as Keeler's formula rises.

    The engineering strain of the lowest point grows as 23.3 + 14.13 t; all major true strains grow by as much as that
    of the lowest point does. Raises CaseError outside the thicknesses of the formula.
    """
    if problems := _thickness_problems({"thickness": measured, BLANK: thickness}):
        raise CaseError(problems, "Keeler's rule")
    _, lowest = curve.lowest()
    ratio = (_KEELER[0] + _KEELER[1] * thickness) / (_KEELER[0] + _KEELER[1] * measured)
    rise = math.log1p(math.expm1(lowest) * ratio) - lowest
    method = f"{curve.method}, by Keeler from {measured:g} to {thickness:g} mm"
    return FormingLimitCurve(curve.minor, curve.major + rise, method)


def curve_from_points(points: Sequence[tuple[float, float]]) -> FormingLimitCurve:
    """Return the curve through measured (minor, major) true strains, in any order. Raises CaseError."""
    problems = []
    table = np.array(sorted(points), dtype=float).reshape(-1, 2)
    if len(table) < 2:
        problems.append(Problem("points", "expected at least two points", "give [[minor, major], ...]"))
    if (np.diff(table[:, 0]) <= 0).any():
        twice = float(table[1:][np.diff(table[:, 0]) <= 0][0, 0])
        problems.append(Problem("points", f"the minor strain {twice:g} is given twice", "give one limit for each"))
    if (np.abs(table) > 3).any():
        problems.append(Problem("points", "a strain beyond 3", "give true strains as fractions, not per cent"))
    if (table[:, 1] <= table[:, 0]).any():
        problems.append(Problem("points", "a major strain not above the minor", "give [minor, major] pairs"))
    if problems:
        raise CaseError(problems, "forming limit")
    return FormingLimitCurve(table[:, 0], table[:, 1], "from points")


def swift_hill_curve(
    function: _core.YieldFunction, law: _core.SheetLaw, ratios: FloatArray | None = None, angle: float = 0.0
) -> FormingLimitCurve:
    """Return Hill's localised necking (minor strain < 0) joined to Swift's diffuse necking (minor >= 0).

    With the flow stress Y(p) and n = d f/d stress on a proportional path: Hill Y'/Y = n1 + n2, Swift
    Y'/Y = (n1² s1 + n2² s2)/f, at the smaller of p where it first holds. ratios: minor over major strain, from above
    -1 to 1. angle: of the major strain from the rolling direction [degrees]. Raises CaseError where nothing hardens.
    """
    ratios = np.linspace(-0.5, 1.0, 31) if ratios is None else np.asarray(ratios, dtype=float)
    path = find_stress(function, ratios, angle)
    hill = path.rate[:, 0] + path.rate[:, 1]
    swift = path.rate[:, 0] ** 2 * path.stress[:, 0] + path.rate[:, 1] ** 2 * path.stress[:, 1]
    p = np.array([_find_necking(law, float(z)) for z in np.where(ratios < 0, hill, swift)])
    strain = p[:, None] * path.rate
    order = np.argsort(strain[:, 1])
    return FormingLimitCurve(strain[order, 1], strain[order, 0], "Swift-Hill")


def _find_necking(law: _core.SheetLaw, z: float) -> float:
    """Return the first p with Y'/Y = z, by a scan and bisection."""
    p = np.concatenate([[0.0], np.geomspace(1e-6, 5.0, 400)])
    flow, slope = law.flow_stress(p)
    soft = slope <= z * flow
    if soft[0] or not soft.any():
        where = "from the start" if soft[0] else "up to a strain of 5"
        text = f"the flow stress hardens too {'little' if soft[0] else 'much'} for necking to begin {where}"
        raise CaseError([Problem("hardening", text, "check the hardening law")], "Swift-Hill")
    i = int(np.argmax(soft))
    low, high = p[i - 1], p[i]
    for _ in range(60):
        middle = 0.5 * (low + high)
        flow, slope = law.flow_stress(np.array([middle]))
        low, high = (low, middle) if slope[0] <= z * flow[0] else (middle, high)
    return float(0.5 * (low + high))
