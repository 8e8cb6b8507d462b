# SPDX-License-Identifier: Apache-2.0
"""Quantities: everything arrives in mm, s, t, N, MPa."""

from __future__ import annotations

import pytest
from pydantic_core import PydanticCustomError

from presswork.case.units import (
    _USUAL,
    FORCE,
    LENGTH,
    PURE_NUMBER,
    STRESS,
    TIME,
    Dimension,
    _ask_pint,
    to_number,
    to_pair,
    unit_factor,
)


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("200 kN/mm^2", STRESS, 200e3),
        ("0.7 GPa", STRESS, 700.0),
        ("1 bar", STRESS, 0.1),
        ("2 cm", LENGTH, 20.0),
        ("-1.5e1 mm", LENGTH, -15.0),
        ("2 inch", LENGTH, 50.8),
        ("20 ms", TIME, 0.02),
        ("3 kN", FORCE, 3000.0),
        ("1 t*mm/s^2", FORCE, 1.0),
        ("30 %", PURE_NUMBER, 0.3),
    ],
)
def test_string_with_unit_is_converted(text: str, dimension: Dimension, value: float) -> None:
    assert to_number(text, dimension) == pytest.approx(value, rel=1e-12)


def test_plain_number_is_kept() -> None:
    assert to_number(7, STRESS) == 7.0


@pytest.mark.parametrize(
    "value", ["5 kg", "mm", "9**9**9 mm", "five mm", "1 mm; 2 mm", True, None, [1], float("inf"), ""]
)
def test_anything_else_is_refused(value: object) -> None:
    with pytest.raises(PydanticCustomError, match="expected a length"):
        to_number(value, LENGTH)


def test_pair_takes_units_per_value() -> None:
    assert to_pair([1, "2 cm"], LENGTH) == (1.0, 20.0)


def test_unit_factor_names_the_dimension_that_is_wrong() -> None:
    with pytest.raises(ValueError, match="has the dimension time"):
        unit_factor("s", LENGTH)


def test_factors_of_usual_units_are_those_of_pint() -> None:
    for dimension, factors in _USUAL.items():
        for unit, factor in factors.items():
            if unit == "HV":  # kgf/mm2, which pint does not have by this name
                assert factor == _ask_pint("kgf/mm^2", dimension)
                continue
            assert _ask_pint(unit, dimension) == factor


@pytest.mark.parametrize(
    ("text", "remedy"), [("0,8", "write 0.8"), ("0,8 mm", "write 0.8 mm"), ("-1,25", "write -1.25")]
)
def test_decimal_comma_is_named_with_the_number_to_write(text: str, remedy: str) -> None:
    with pytest.raises(PydanticCustomError) as error:
        to_number(text, LENGTH)
    assert "decimal comma" in str(error.value)
    assert str(error.value).endswith(remedy)


def test_a_number_whose_square_vanishes_is_refused() -> None:
    with pytest.raises(PydanticCustomError, match="1e-300 is none that a computer can square; check its exponent"):
        to_number(1e-300, LENGTH)
    assert to_number(0, LENGTH) == 0.0
