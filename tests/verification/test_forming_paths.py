# SPDX-License-Identifier: Apache-2.0
"""Forming limits along paths that turn, against closed forms by hand.

Von Mises in plane stress, a power law and a forming limit curve e1 = FLD0 - e2 left of plane strain, FLD0 + s e2 right
of it. With b = e2/e1 of the strain rate, p = e1 2/sqrt(3) sqrt(1 + b + b^2), so the limit of p is
2/sqrt(3) sqrt(1 + b + b^2) FLD0/(1 + b) left, FLD0/(1 - s b) in place of the last factor right.
"""

from __future__ import annotations

import numpy as np
import pytest

from presswork.evolution.contract import PointChange
from presswork.evolution.forming_path import MEMORY, FormingPath
from presswork.formability import POLAR, STRESS, Formability, FormingLimitCurve, find_margin
from presswork.model import FloatArray, Hardening, Kinematic, Material

FLD0, SLOPE = 0.3, 0.4
CURVE = FormingLimitCurve(np.array([-0.25, 0.0, 0.5]), np.array([FLD0 + 0.25, FLD0, FLD0 + 0.5 * SLOPE]), "by hand")
K, E0, N = 500.0, 1e-3, 0.2
UNIAXIAL, PLANE, BALANCED = -0.5, 0.0, 1.0


def sheet(**parts: object) -> Material:
    hardening = Hardening("swift", np.array([K, E0, N]))
    return Material("steel", 210e3, 0.3, hardening, formability=Formability(CURVE), **parts)  # type: ignore[arg-type]


def size_by_hand(b: float) -> float:
    """Equivalent plastic strain per major strain."""
    return 2.0 / np.sqrt(3.0) * np.sqrt(1.0 + b + b * b)


def limit_by_hand(b: float) -> float:
    """Equivalent plastic strain at which a straight path meets the curve."""
    return size_by_hand(b) * (FLD0 / (1.0 + b) if b < 0.0 else FLD0 / (1.0 - SLOPE * b))


def stress_by_hand(b: float) -> FloatArray:
    """Principal stresses over the flow stress: s = 2/3 (2 e1 + e2, 2 e2 + e1)/p in plane stress."""
    return 2.0 / 3.0 * np.array([2.0 + b, 1.0 + 2.0 * b, 0.0]) / size_by_hand(b)


def follow(material: Material, path: list[tuple[float, float]], *, dp: float = 1e-3, turn: float = 0.0) -> dict:
    """Take a rigid-plastic point along pieces (b, plastic strain); turn: of the major strain in the second piece."""
    law = FormingPath(material, CURVE)
    values = {name: np.full(1, start) for name, start in law.at_rest().items()}
    p, stress = 0.0, np.zeros((1, 3))
    told: dict[str, list[float]] = {"p": [], POLAR: [], STRESS: []}
    for number, (b, strain) in enumerate(path):
        for _ in range(round(strain / dp)):
            after = stress_by_hand(b) * K * (E0 + p + dp) ** N
            after = np.array([after if number == 0 or not turn else after[[1, 0, 2]]])
            values = law.advance(values, PointChange(stress, after, np.array([p]), np.array([p + dp]), 1.0))
            p, stress = p + dp, after
            told["p"].append(p)
            for name in (POLAR, STRESS):
                told[name].append(float(values[name][0]) if name in values else np.nan)
    return {name: np.array(each) for name, each in told.items()}


@pytest.mark.parametrize("b", [-0.7, UNIAXIAL, -0.25, PLANE, 0.3, 0.7, BALANCED])
def test_on_a_straight_path_strains_polar_strain_and_stresses_agree_to_the_last_digits(b: float) -> None:
    told = follow(sheet(), [(b, 0.4)])
    share = told["p"] / limit_by_hand(b)
    np.testing.assert_allclose(told[POLAR], 1.0 - share, atol=1e-13)
    flow = (E0 + told["p"]) ** N / (E0 + limit_by_hand(b)) ** N
    np.testing.assert_allclose(told[STRESS], 1.0 - flow, atol=1e-13)
    major = told["p"] / size_by_hand(b)
    np.testing.assert_allclose(1.0 - major / CURVE.meet(np.array(b)), told[POLAR], atol=1e-13)
    at_limit = np.array([limit_by_hand(b) / size_by_hand(b)])
    np.testing.assert_allclose(find_margin(at_limit, b * at_limit, CURVE), 0.0, atol=1e-13)


@pytest.mark.parametrize("second", [UNIAXIAL, PLANE, 0.5, BALANCED])
@pytest.mark.parametrize(("first", "before"), [(UNIAXIAL, 0.2), (BALANCED, 0.2), (PLANE, 0.15)])
def test_after_a_prestrain_the_neck_comes_at_the_strain_of_the_closed_form(
    first: float, before: float, second: float
) -> None:
    """What is left of p after the prestrain is strained along the second piece: e1 = before/size + rest/size."""
    told = follow(sheet(), [(first, before), (second, limit_by_hand(second) - before + 0.05)])
    for name in (POLAR, STRESS):
        necks = told["p"][np.argmax(told[name] <= 0.0)]
        assert necks == pytest.approx(limit_by_hand(second), abs=1.5e-3)  # a step, and what MEMORY still holds


def test_a_prestrain_beyond_the_limit_of_the_second_path_necks_within_the_memory() -> None:
    """Balanced stretching to p = 0.8 of 1.0, then plane strain, whose limit is 0.346."""
    told = follow(sheet(), [(BALANCED, 0.8), (PLANE, 0.05)])
    assert told[POLAR][round(0.8 / 1e-3) - 1] == pytest.approx(1.0 - 0.8 / limit_by_hand(BALANCED))
    after = told["p"][np.argmax(told[POLAR] < 0.0)] - 0.8
    rest = (1.0 / 0.8 - 1.0 / limit_by_hand(PLANE)) / (1.0 / limit_by_hand(BALANCED) - 1.0 / limit_by_hand(PLANE))
    assert after == pytest.approx(-MEMORY * np.log(rest), rel=0.5)


def test_balanced_prestrain_lowers_the_plane_strain_limit_and_uniaxial_prestrain_raises_it() -> None:
    """As in Graf & Hosford's tests of AA2008-T4: the lowest point of the curve comes down, or goes up."""
    plane = limit_by_hand(PLANE)
    for first, sense in ((BALANCED, -1), (UNIAXIAL, 1)):
        told = follow(sheet(), [(first, 0.1), (PLANE, 0.4)])
        rest = told["p"][np.argmax(told[POLAR] < 0.0)] - 0.1
        major = 0.1 / size_by_hand(first) + rest / size_by_hand(PLANE)
        by_hand = 0.1 / size_by_hand(first) + (plane - 0.1) / size_by_hand(PLANE)
        assert major == pytest.approx(by_hand, abs=1.5e-3)
        assert np.sign(major - FLD0) == sense


def test_with_back_stresses_the_direction_is_that_of_the_relative_stress_and_stresses_have_no_limit() -> None:
    material = sheet(kinematic=Kinematic("chaboche", {"C": (2000.0,), "gamma": (20.0,)}))
    law = FormingPath(material, CURVE)
    values = {name: np.full(1, start) for name, start in law.at_rest().items()}
    assert STRESS not in values
    stress, back = np.array([stress_by_hand(PLANE) * 300.0]), np.array([[-80.0, 150.0, 20.0]])
    change = PointChange(stress, stress + back, np.array([0.1]), np.array([0.2]), 1.0, back_stress=back)
    assert law.advance(values, change)[POLAR][0] == pytest.approx(1.0 - 0.2 / limit_by_hand(PLANE), abs=1e-13)


def bend(values: dict, p: list[float], sides: list[float], dp: float = 1e-3) -> None:
    """Take two layers of a place through a step, each pulled (1) or pressed (-1) in plane strain, or at rest (0)."""
    law, before = FormingPath(sheet(), CURVE), np.array(p)
    p[:] = [each + dp * abs(side) for each, side in zip(p, sides, strict=True)]
    flow = K * (E0 + np.array(p)) ** N
    stress = np.array([side * flow[i] * stress_by_hand(PLANE) for i, side in enumerate(sides)])
    values.update(law.advance(values, PointChange(stress, stress, before, np.array(p), 1.0, layers=2)))


def test_a_sheet_bent_and_straightened_does_not_neck_until_all_its_layers_are_stretched_at_once() -> None:
    """Each face in turn is far beyond the limit, 0.346; then both are stretched."""
    values = {name: np.full(2, start) for name, start in FormingPath(sheet(), CURVE).at_rest().items()}
    p = [0.0, 0.0]
    for sides in ([1.0, -1.0], [-1.0, 1.0]):
        for _ in range(500):
            bend(values, p, sides)
    assert p == pytest.approx([1.0, 1.0])
    np.testing.assert_array_equal(values[POLAR], 1.0)
    assert values[STRESS].min() > 0.1
    for _ in range(200):
        bend(values, p, [1.0, 0.0])  # the other layer rests
    np.testing.assert_array_equal(values[POLAR], 1.0)
    for _ in range(100):
        bend(values, p, [1.0, 1.0])
    np.testing.assert_allclose(values[POLAR], 1.0 - p[1] / limit_by_hand(PLANE), rtol=1e-3)


def test_what_unloads_keeps_its_least_margin() -> None:
    told = follow(sheet(), [(PLANE, 0.2)])
    law = FormingPath(sheet(), CURVE)
    values = {name: np.full(1, start) for name, start in law.at_rest().items()}
    values[POLAR][:] = told[POLAR][-1]
    p, elastic = np.array([0.2]), np.zeros((1, 3))
    assert law.advance(values, PointChange(elastic, elastic, p, p, 1.0))[POLAR] == told[POLAR][-1]
