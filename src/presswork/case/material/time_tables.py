# SPDX-License-Identifier: Apache-2.0
"""Tables of isothermal transformation: temperatures, and times in which a phase begins and ends to form."""

from __future__ import annotations

import itertools
from typing import Annotated, Self

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from presswork.case.heat.quantities import MOST_ROWS, to_temperature
from presswork.case.part import Part
from presswork.case.units import PURE_NUMBER, TIME, fault, to_entries, to_number
from presswork.model import FloatArray

Row = tuple[float, float, float, float]
_EXAMPLE = "e.g. [[450, 3, 90], [500, 1, 30], [550, 4, 120]]: degrees C, seconds to 1 % and to 99 %"
DIFFUSIVE = ("ferrite", "pearlite", "bainite")


def _to_row(value: object, index: int) -> Row:
    if not isinstance(value, list | tuple) or len(value) not in (3, 4):
        raise fault("expected [temperature, first time, last time], or these and a part", _EXAMPLE, key=str(index))
    degrees, first, last = to_entries(value[:3], to_temperature, _to_time, _to_time)
    part = to_number(value[3], PURE_NUMBER) if len(value) == 4 else 1.0
    if not 0.0 < first < last:
        text = f"the times do not increase: {first:g} s to 1 %, {last:g} s to 99 %"
        raise fault(text, _EXAMPLE, key=str(index))
    if not 0.0 < part <= 1.0:
        raise fault(f"{part:g} is no part of the austenite", "above 0, up to 1", key=f"{index}.3")
    return degrees, first, last, part


def _to_time(value: object) -> float:
    return to_number(value, TIME)


def _to_rows(value: object) -> tuple[Row, ...]:
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= MOST_ROWS:
        raise fault(f"expected from 2 to {MOST_ROWS} rows", _EXAMPLE)
    rows = tuple(_to_row(row, index) for index, row in enumerate(value))
    if any(b[0] <= a[0] for a, b in itertools.pairwise(rows)):
        raise fault("the temperatures do not increase", "sort the rows, and leave out doubles")
    return rows


_ROW = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 3, "maxItems": 4}
Rows = Annotated[
    tuple[Row, ...], BeforeValidator(_to_rows), WithJsonSchema({"type": "array", "items": _ROW, "minItems": 2})
]
_MEANING = "rows [degrees C, seconds to 1 %, seconds to 99 %], or with the part of the austenite that forms besides"


class TimeTables(Part):
    """Times of isothermal transformation by phase; above the last row and below the first nothing forms."""

    ferrite: Rows | None = Field(default=None, description=_MEANING)
    pearlite: Rows | None = Field(default=None, description=_MEANING)
    bainite: Rows | None = Field(default=None, description=_MEANING)

    @model_validator(mode="after")
    def _check_any(self) -> Self:
        if not self._given():
            raise fault("no table is given", f"give bainite, pearlite or ferrite, {_EXAMPLE}", key="bainite")
        return self

    def check_above(self, martensite_start: float) -> None:
        """Refuse a table that lies below the start of martensite [degrees C]."""
        for name, rows in self._given().items():
            if rows[-1][0] <= martensite_start:
                text = f"it ends at {rows[-1][0]:g} degrees C, below the start of martensite at {martensite_start:g}"
                raise fault(text, "plain numbers are degrees C", key=f"times.{name}")

    def _given(self) -> dict[str, tuple[Row, ...]]:
        return {name: getattr(self, name) for name in DIFFUSIVE if getattr(self, name) is not None}

    @property
    def hottest(self) -> float:
        """Highest temperature of a table [degrees C]."""
        return max(rows[-1][0] for rows in self._given().values())

    def to_model(self) -> dict[str, FloatArray]:
        """Return the Model's."""
        return {name: np.array(rows) for name, rows in self._given().items()}
