# SPDX-License-Identifier: Apache-2.0
"""Forming limit curves as objects: between points, zones, and what is refused. Numbers: tests/verification."""

from __future__ import annotations

import re

import numpy as np
import pytest

from presswork import _core
from presswork.case.errors import CaseError
from presswork.case.material.forming_limit.build import build_formability
from presswork.case.material.forming_limit.curves import (
    curve_from_points,
    keeler_curve,
    scale_with_thickness,
    swift_hill_curve,
)
from presswork.case.material.forming_limit.marciniak import marciniak_kuczynski_curve
from presswork.case.material.sheet import check_sheet_material
from presswork.formability import ZONES, find_zones
from presswork.material import find_sheet

POINTS = [(0.3, 0.4), (-0.2, 0.5), (0.0, 0.3)]
VON_MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])


def law(kind: str, parameters: list[float]) -> _core.SheetLaw:
    return _core.SheetLaw(70e3, 0.33, VON_MISES, _core.HardeningLaw[kind], parameters)


def test_curve_from_points_is_straight_between_them_and_goes_on() -> None:
    curve = curve_from_points(POINTS)
    np.testing.assert_allclose(curve.limit(np.array([-0.3, -0.1, 0.15, 0.6])), [0.6, 0.4, 0.35, 0.6])
    assert curve.lowest() == (0.0, 0.3)


@pytest.mark.parametrize(
    ("major", "minor", "zone"),
    [
        (0.2, 0.1, "safe"),
        (0.28, 0.0, "risk of cracks"),
        (0.31, 0.0, "cracks"),
        (0.01, 0.005, "insufficient stretch"),
        (0.2, -0.15, "wrinkling tendency"),
        (0.1, -0.15, "wrinkles unless held"),
    ],
)
def test_each_of_the_six_zones_has_its_points(major: float, minor: float, zone: str) -> None:
    found = find_zones(np.array([major]), np.array([minor]), curve_from_points(POINTS))
    assert ZONES[found[0]] == zone


def test_margin_r_and_least_stretch_move_the_borders() -> None:
    curve = curve_from_points(POINTS)

    def zone(major: float, minor: float, **options: float) -> str:
        return ZONES[find_zones(np.array([major]), np.array([minor]), curve, **options)[0]]

    assert zone(0.25, 0.0, margin=0.2) == "risk of cracks"
    assert zone(0.2, -0.12, r=2.0) == "safe"
    assert zone(0.2, -0.12, r=1.0) == "wrinkling tendency"
    assert zone(0.03, 0.01, least_stretch=0.05) == "insufficient stretch"


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0.0, 0.3)], "at least two points"),
        ([(0.0, 0.3), (0.0, 0.4)], "is given twice"),
        ([(0, 30), (10, 40)], "not per cent"),
        ([(0.3, 0.0), (0.0, 0.2)], r"\[minor, major\] pairs"),
    ],
)
def test_faults_of_points_are_named(points: list[tuple[float, float]], words: str) -> None:
    with pytest.raises(CaseError, match=words):
        curve_from_points(points)


def test_keeler_refuses_sheets_that_it_was_not_measured_on() -> None:
    with pytest.raises(CaseError, match=r"thickness = 0.0008.*0.1 to 4 mm"):
        keeler_curve(0.0008, 0.2)
    with pytest.raises(CaseError, match="n = 20"):
        keeler_curve(1.0, 20)


def test_swift_hill_needs_hardening_that_slows_down() -> None:
    with pytest.raises(CaseError, match="hardens too little"):
        swift_hill_curve(VON_MISES, law("linear", [200.0, 0.0]))


def test_marciniak_kuczynski_refuses_a_groove_that_is_none() -> None:
    with pytest.raises(CaseError, match="imperfection = 1"):
        marciniak_kuczynski_curve(VON_MISES, law("swift", [500.0, 0.01, 0.2]), imperfection=1.0)


def test_marciniak_kuczynski_says_when_no_groove_stops_the_sheet() -> None:
    with pytest.raises(CaseError, match=r"no groove stops the sheet at the strain ratio -0\.3"):
        marciniak_kuczynski_curve(
            VON_MISES, law("swift", [500.0, 0.01, 0.2]), ratios=np.array([-0.3]), groove_angles=np.array([40.0])
        )


def test_keelers_own_curve_scales_into_that_of_another_thickness() -> None:
    """At plane strain and left of it exactly; right of it, where engineering strains rise by 0.6, within 1 %."""
    one, other = keeler_curve(0.8, 0.22), keeler_curve(1.5, 0.22)
    scaled = scale_with_thickness(one, 0.8, 1.5)
    left, right = np.linspace(-0.3, 0.0, 7), np.linspace(0.0, 0.3, 7)
    np.testing.assert_allclose(scaled.limit(left), other.limit(left), rtol=1e-12)
    np.testing.assert_allclose(scaled.limit(right), other.limit(right), rtol=0.03)
    assert "by Keeler from 0.8 to 1.5 mm" in scaled.method
    with pytest.raises(CaseError, match=r"0\.1 to 4 mm"):
        scale_with_thickness(one, 0.8, 8.0)


STEEL = {"young": 206e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 565.0, "e0": 0.007, "n": 0.26}}
MEASURED = {"law": "points", "points": [list(point) for point in POINTS], "thickness": 0.8}


@pytest.mark.parametrize(
    ("limit", "lowest", "note"),
    [
        ({"law": "keeler", "n": 0.26}, keeler_curve(1.0, 0.26).lowest()[1], ""),
        ({"law": "keeler", "n": 0.26, "thickness": 0.8}, keeler_curve(0.8, 0.26).lowest()[1], "leave .*thickness out"),
        (MEASURED, 0.3, "that of a sheet of 0.8 mm, and the blank is 1 mm thick"),
        (MEASURED | {"scaling": "keeler"}, np.log1p(np.expm1(0.3) * (23.3 + 14.13) / (23.3 + 14.13 * 0.8)), ""),
        (MEASURED | {"thickness": 1.0}, 0.3, ""),
    ],
)
def test_a_limit_of_another_thickness_is_scaled_or_said(limit: dict, lowest: float, note: str) -> None:
    judged = build_formability(check_sheet_material(STEEL | {"forming_limit": limit}), "materials.steel", 1.0)
    assert judged.curve is not None
    assert judged.curve.lowest()[1] == pytest.approx(lowest, rel=1e-12)
    assert re.search(note, judged.note)
    assert bool(judged.note) == bool(note)


def test_the_librarys_keeler_curve_is_that_of_the_blank() -> None:
    steel = find_sheet("numisheet93_mild_steel").material
    thin, thick = (build_formability(steel, "materials.steel", t).curve for t in (0.78, 1.0))
    assert thin is not None
    assert thick is not None
    assert thick.lowest()[1] == pytest.approx(keeler_curve(1.0, 0.2589).lowest()[1])
    assert thick.lowest()[1] > thin.lowest()[1]
