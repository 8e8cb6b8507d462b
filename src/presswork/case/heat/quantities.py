# SPDX-License-Identifier: Apache-2.0
"""Temperatures, in degrees Celsius, and quantities that depend on temperature or on time."""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from presswork.case.units import (
    CONDUCTIVITY,
    HEAT_CAPACITY,
    HEAT_FLUX,
    HEAT_TRANSFER,
    LARGEST_FLOAT,
    PURE_NUMBER,
    STRESS,
    TIME,
    Dimension,
    fault,
    to_entries,
    to_number,
)
from presswork.model import COLDEST, HOTTEST, ZERO_CELSIUS, FloatArray

MOST_ROWS = 1000

_WITH_UNIT = re.compile(r"^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(°C|degC|K)\s*$", re.ASCII)
_REMEDY = 'write a plain number in degrees C, or for instance "20 °C" or "293 K"'

Rows = tuple[tuple[float, float], ...]


def to_temperature(value: object) -> float:
    """Convert a plain number in degrees C, or a text in °C, degC or K, to degrees C."""
    if isinstance(value, str):
        match = _WITH_UNIT.match(value) if len(value) < 40 else None
        if match is None:
            raise fault("expected a temperature (in degrees C, or with a unit)", _REMEDY)
        number = float(match.group(1)) - (ZERO_CELSIUS if match.group(2) == "K" else 0.0)
    elif isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < LARGEST_FLOAT:
        raise fault("expected a temperature (in degrees C, or with a unit)", _REMEDY)
    else:
        number = to_number(value, PURE_NUMBER)
    if not COLDEST <= number <= HOTTEST:
        raise fault(f"{number:g} degrees C is a temperature of no forming ({COLDEST:g} to {HOTTEST:g})", _REMEDY)
    return number


def to_table(value: object, argument: Callable[[object], float], quantity: Callable[[object], float]) -> Rows:
    """Convert one quantity, or rows [argument, quantity] with increasing arguments; one quantity is a single row."""
    if not isinstance(value, list | tuple):
        return ((0.0, quantity(value)),)
    rows = []
    for index, row in enumerate(value):
        if not isinstance(row, list | tuple) or len(row) != 2:
            remedy = "e.g. [[20, 45], [800, 26], [1200, 29]]"
            raise fault("expected one value, or rows [argument, value]", remedy, key=str(index))
        try:
            first, second = to_entries(row, argument, quantity)
        except PydanticCustomError as error:
            context = error.context or {}
            raise fault(context["expected"], context["remedy"], key=f"{index}.{context['key']}") from None
        rows.append((first, second))
    if not 1 <= len(rows) <= MOST_ROWS:
        raise fault(f"expected from 1 to {MOST_ROWS} rows", "e.g. [[20, 45], [800, 26], [1200, 29]]")
    if any(b[0] <= a[0] for a, b in itertools.pairwise(rows)):
        raise fault("the first column does not increase", "sort the rows, and leave out doubles")
    return tuple(rows)


def to_array(rows: Rows) -> FloatArray:
    """Return the rows of a table (n, 2)."""
    return np.array(rows, dtype=np.float64)


def _table(argument: Callable[[object], float], quantity: Callable[[object], float], example: str) -> tuple[Any, ...]:
    one = {"anyOf": [{"type": "number"}, {"type": "string", "examples": [example]}]}
    row = {"type": "array", "items": one, "minItems": 2, "maxItems": 2}
    schema = {"anyOf": [*one["anyOf"], {"type": "array", "items": row, "minItems": 1}]}
    convert = functools.partial(to_table, argument=argument, quantity=quantity)
    return BeforeValidator(convert), WithJsonSchema(schema)


def _of(dimension: Dimension, *, least: float | None = None) -> Callable[[object], float]:
    def convert(value: object) -> float:
        number = to_number(value, dimension)
        if least is not None and not number > least:
            remedy = f'plain numbers are in {dimension.unit}; with a unit: "{dimension.example}"'
            raise fault(f"expected {dimension.name} > {least:g} {dimension.unit}", remedy)
        return number

    return convert


def _not_negative(value: object) -> float:
    number = to_number(value, HEAT_TRANSFER)
    if number < 0:
        raise fault("a coefficient of heat transfer is not negative", 'e.g. "2000 W/(m^2*K)", which is 2')
    return number


_pressure = functools.partial(to_number, dimension=STRESS)
_time = functools.partial(to_number, dimension=TIME)

_TEMPERATURE = {"anyOf": [{"type": "number"}, {"type": "string", "examples": ["1200 °C"]}]}
Temperature = Annotated[float, BeforeValidator(to_temperature), WithJsonSchema(_TEMPERATURE)]
ConductivityTable = Annotated[Rows, *_table(to_temperature, _of(CONDUCTIVITY, least=0.0), "30 W/(m*K)")]
SpecificHeatTable = Annotated[Rows, *_table(to_temperature, _of(HEAT_CAPACITY, least=1e6), "460 J/(kg*K)")]
HeatTransferTable = Annotated[Rows, *_table(to_temperature, _not_negative, "2000 W/(m^2*K)")]
HeatTransferByPressure = Annotated[Rows, *_table(_pressure, _not_negative, "10 kW/(m^2*K)")]
HardnessTable = Annotated[Rows, *_table(to_temperature, _pressure, "560 HV")]
TemperatureByTime = Annotated[Rows, *_table(_time, to_temperature, "1200 °C")]
HeatFluxByTime = Annotated[Rows, *_table(_time, _of(HEAT_FLUX), "50 kW/m^2")]
