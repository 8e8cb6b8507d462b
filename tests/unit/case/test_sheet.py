# SPDX-License-Identifier: Apache-2.0
"""Sheet materials: what each key changes, and what is refused."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from pydantic_core import PydanticCustomError

from presswork import _core
from presswork.case.errors import CaseError
from presswork.case.material.sheet import check_sheet_material
from presswork.case.material.yield_function import Hill1948, Yld2000, check_surface
from presswork.case.material.yld2000_fit import r_value, tension
from presswork.law.elastic_plastic import make_solid_law

STEEL: dict[str, Any] = {
    "young": "206 GPa",
    "poisson": 0.3,
    "yield_function": {"law": "hill1948", "r00": 1.79, "r45": 1.51, "r90": 2.27},
    "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589},
}
YOSHIDA = {"law": "yoshida_uemori", "B": 300, "C": 200, "m": 12, "b": 40, "Rsat": 190, "h": 0.4}
CONSTANT = {"law": "linear", "yield_stress": 200}


def changed(**tables: Any) -> dict[str, Any]:
    """STEEL with other tables; None takes a key out of its table."""
    data = copy.deepcopy(STEEL)
    for key, value in tables.items():
        if isinstance(value, dict) and isinstance(data.get(key), dict) and "law" not in value:
            data[key] = {k: v for k, v in {**data[key], **value}.items() if v is not None}
        else:
            data[key] = value
    return data


def end_stress(data: dict[str, Any]) -> np.ndarray:
    """Stress after a turn of the strain path in 0.1 s increments."""
    law = check_sheet_material(data).build_law()
    stress, history = np.zeros((1, 3)), np.zeros((1, law.history_size))
    for strain in ([0.01, 0.02, 0.01], [-0.01, 0.0, 0.01], [0.0, -0.01, 0.0]):
        stress, history, *_ = law.update(np.array([strain]), stress, history, dt=0.1)
    return stress[0]


CHANGES: dict[str, dict[str, Any]] = {
    "young": {"young": "190 GPa"},
    "poisson": {"poisson": 0.25},
    "von_mises": {"yield_function": {"law": "von_mises"}},
    "r00": {"yield_function": {"r00": 1.2}},
    "r45": {"yield_function": {"r45": 1.2}},
    "r90": {"yield_function": {"r90": 1.2}},
    "stresses": {"yield_function": {"law": "hill1948", "stress_45": 1.05, "stress_90": 1.02, "stress_biaxial": 1.1}},
    "barlat1989": {"yield_function": {"law": "barlat1989", "r00": 1.79, "r45": 1.51, "r90": 2.27, "exponent": 6}},
    "yld2000": {"yield_function": {"law": "yld2000", "alpha": [1.0] * 8, "exponent": 8}},
    "hardening": {"hardening": {"n": 0.2}},
    "chaboche": {"kinematic": {"law": "chaboche", "C": [2000], "gamma": [20]}},
    "yoshida_uemori": {"kinematic": YOSHIDA, "hardening": CONSTANT},
    "cowper_symonds": {"rate": {"law": "cowper_symonds", "D": 40, "q": 5}},
    "johnson_cook": {"rate": {"law": "johnson_cook", "C": 0.02, "reference_rate": 0.001}},
    "logarithmic": {"rate": {"law": "logarithmic", "C": 0.02, "reference_rate": 0.001}},
    "young_decrease": {"young_decrease": {"saturated": "160 GPa", "rate": 60}},
}


@pytest.mark.parametrize("name", CHANGES)
def test_every_key_changes_the_stress(name: str) -> None:
    assert np.abs(end_stress(changed(**CHANGES[name])) - end_stress(STEEL)).max() > 0.1


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"kinematic": YOSHIDA}, {"kinematic": {**YOSHIDA, key: value}})
        for key, value in {"B": 350, "C": 100, "m": 24, "b": 80, "Rsat": 50}.items()
    ],
)
def test_every_parameter_of_yoshida_uemori_changes_the_stress(first: dict[str, Any], second: dict[str, Any]) -> None:
    one, other = (end_stress(changed(hardening=CONSTANT, **change)) for change in (first, second))
    assert np.abs(one - other).max() > 0.1


@pytest.mark.parametrize(("name", "index"), [("L", 4), ("M", 5)])
def test_out_of_plane_parameters_of_hill_are_felt_in_three_dimensions(name: str, index: int) -> None:
    strain = np.zeros((1, 6))
    strain[0, index] = 0.02

    def stress(data: dict[str, Any]) -> float:
        law = make_solid_law(check_sheet_material(data).to_model("steel"))
        return float(law.update(strain, np.zeros((1, 6)), np.zeros((1, 1)))[0][0, index])

    assert stress(changed(yield_function={name: 1.1})) > 1.1 * stress(STEEL)


def test_a_plane_stress_function_has_no_law_in_three_dimensions() -> None:
    table = {"law": "yld2000", "alpha": [1.0] * 8, "exponent": 8}
    material = check_sheet_material(changed(yield_function=table)).to_model("steel")
    with pytest.raises(ValueError, match="yld2000 is a yield function of plane stress alone"):
        make_solid_law(material)


REFUSED: dict[str, tuple[dict[str, Any], list[str]]] = {
    "r_zero": ({"yield_function": {"r45": 0.0}}, ["yield_function.r45 = 0.0", "> 0"]),
    "r_negative": ({"yield_function": {"r00": -1.0}}, ["yield_function.r00 = -1.0", "> 0"]),
    "r_missing": ({"yield_function": {"r90": None}}, ["yield_function.r90", "missing key", "r00, r45 and r90"]),
    "r_and_stress": ({"yield_function": {"stress_45": 1.0}}, ["yield_function.stress_45", "the same quantity"]),
    "concave": (
        {"yield_function": {"law": "hill1948", "stress_45": 1.0, "stress_90": 1.0, "stress_biaxial": 0.4}},
        ["yield_function.stress_biaxial = 0.4", "not closed"],
    ),
    "unbounded": (
        {"yield_function": {"law": "yld2000", "alpha": [0, 0, 0, 0, 0, 0, 1, 1], "exponent": 8}},
        ["yield_function.alpha", "not closed"],
    ),
    "seven_alphas": (
        {"yield_function": {"law": "yld2000", "alpha": [1.0] * 7, "exponent": 8}},
        ["yield_function.alpha", "at least 8"],
    ),
    "exponent": (
        {"yield_function": {"law": "yld2000", "alpha": [1.0] * 8, "exponent": 7}},
        ["yield_function.exponent = 7", "6, 8"],
    ),
    "unknown_yield": ({"yield_function": {"law": "hil1948"}}, ["yield_function.law", "did you mean `hill1948`?"]),
    "steel_of_0.3_MPa": (
        {"hardening": {"law": "linear", "yield_stress": 0.3}},
        ["hardening", "0.3 MPa", "1.5e-06 of Young's modulus", "plain numbers are MPa"],
    ),
    "stress_in_pascal": (
        {"hardening": {"law": "linear", "yield_stress": 3e8}},
        ["hardening", "3e+08 MPa", "plain numbers are MPa"],
    ),
    "young_in_gpa": ({"young": 206}, ["young = 206", "that of no metal", '"206 GPa"']),
    "softening": (
        {"hardening": {"law": "monotone_table", "points": [[0, 300], [0.1, 290]]}},
        ["hardening.points", "stress decreases in row 1", "softening = true"],
    ),
    "one_row": (
        {"hardening": {"law": "monotone_table", "points": [[0, 300]]}},
        ["hardening.points", "at least two rows"],
    ),
    "keeler_without_n": ({"forming_limit": {"law": "keeler", "thickness": 1}}, ["forming_limit.n", "missing key"]),
    "scaling_without_t": (
        {"forming_limit": {"law": "points", "points": [[0, 0.3], [0.1, 0.4]], "scaling": "keeler"}},
        ["forming_limit.thickness", "missing key"],
    ),
    "no_groove": (
        {"forming_limit": {"law": "marciniak_kuczynski", "imperfection": 1.0}},
        ["forming_limit.imperfection = 1.0", "< 1"],
    ),
    "lengths_of_back_stresses": (
        {"kinematic": {"law": "chaboche", "C": [1000, 2000], "gamma": [10]}},
        ["kinematic.gamma", "as many as C, 2"],
    ),
    "negative_back_stress": (
        {"kinematic": {"law": "chaboche", "C": [1000], "gamma": [-10]}},
        ["kinematic.gamma", ">= 0"],
    ),
    "yoshida_with_swift": ({"kinematic": YOSHIDA}, ["hardening", "keeps its size", "linear"]),
    "bound_inside_yield": (
        {"kinematic": {**YOSHIDA, "B": 150}, "hardening": CONSTANT},
        ["kinematic", "B = 150 MPa lies inside", "200 MPa"],
    ),
    "modulus_rises": (
        {"young_decrease": {"saturated": "250 GPa", "rate": 60}},
        ["young_decrease", "above Young's modulus"],
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_bad_input_is_refused_by_key_value_and_remedy(name: str) -> None:
    change, words = REFUSED[name]
    with pytest.raises(CaseError) as caught:
        check_sheet_material(changed(**change))
    for word in words:
        assert word in str(caught.value), str(caught.value)


def test_a_surface_with_a_dent_is_refused_as_not_convex() -> None:
    with pytest.raises(PydanticCustomError, match="not convex"):
        check_surface(_core.YieldFunction.barlat1989(1.0, -0.005, 1.0, 1.0, 8), "a")


def test_softening_table_is_taken_when_asked_for() -> None:
    table = {"law": "table", "points": [[0, 300], [0.1, 290]], "softening": True}
    law = check_sheet_material(changed(hardening=table)).build_law()
    assert law.flow_stress(np.array([0.05]))[0][0] == pytest.approx(295)


GRADE = {"r00": 1.7, "r45": 1.3, "r90": 1.9}


def test_r_values_without_a_law_add_no_strength() -> None:
    """Yld2000-2d with the yield stresses given, those that are not equal to that at 0; exponent by the metal."""
    steel = check_sheet_material({**STEEL, "yield_function": GRADE})
    assert isinstance(steel.yield_function, Yld2000)
    tests = np.concatenate([tension(np.radians([0.0, 45.0, 90.0])), [[1.0, 1.0, 0.0]]])
    np.testing.assert_allclose(steel.yield_function.build().evaluate(tests)[0], 1.0, rtol=1e-9)
    np.testing.assert_allclose(r_value(steel.yield_function.build(), np.radians([0.0, 45.0, 90.0])), [1.7, 1.3, 1.9])
    assert steel.yield_function.exponent == 6
    known = {**GRADE, "stress_45": 1.04, "stress_biaxial": 1.1}
    light = check_sheet_material({**STEEL, "young": "70 GPa", "yield_function": known})
    stress = 1.0 / light.yield_function.build().evaluate(tests)[0]
    np.testing.assert_allclose(stress, [1.0, 1.04, 1.0, 1.1], rtol=1e-9)
    assert light.yield_function.exponent == 8


def test_hill_of_the_same_r_values_is_stronger() -> None:
    """Where r-values make strength (issue of grades): yield at 45 degrees 11 % above that at 0, biaxial 19 %."""
    hill = Hill1948(law="hill1948", **GRADE).build()
    stress = 1.0 / hill.evaluate(np.array([[0.5, 0.5, 0.5], [1.0, 1.0, 0.0]]))[0]
    np.testing.assert_allclose(stress, [1.113, 1.194], atol=1e-3)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"law": "yld2000", "exponent": 6}, "alpha: missing key"),
        ({"law": "yld2000", "exponent": 6, "r00": 1.7, "r45": 1.3}, "r90: missing key"),
        ({"law": "yld2000", "exponent": 6, "alpha": [1.0] * 8, "r00": 1.7}, "give the same quantity"),
        ({**GRADE, "stress_biaxial": 40.0}, "no parameters give"),
    ],
)
def test_data_of_a_grade_that_do_not_go_together_are_refused(table: dict[str, Any], words: str) -> None:
    with pytest.raises(CaseError, match=words):
        check_sheet_material({**STEEL, "yield_function": table})


def test_one_step_takes_hills_function_of_the_r_values_that_alpha_gives() -> None:
    alpha = (0.97241, 0.96969, 0.98421, 0.98559, 1.0099, 0.96496, 1.0152, 1.0156)
    chosen = Yld2000(alpha=alpha, exponent=6)
    hill = chosen.find_hill()
    angles = np.radians([0.0, 45.0, 90.0])
    assert hill is not None
    assert r_value(hill.build(), angles) == pytest.approx(r_value(chosen.build(), angles), rel=1e-6)
