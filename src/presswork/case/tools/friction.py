# SPDX-License-Identifier: Apache-2.0
"""How the friction of a tool depends on pressure, speed, temperature and the path slid."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, Protocol, Self

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.quantities import Rows, to_table, to_temperature
from presswork.case.part import Part
from presswork.case.units import LENGTH, PURE_NUMBER, STRESS, VELOCITY, Number, Stress, fault, to_number

LARGEST_FACTOR = 100.0
"""Factor by which no friction changes."""


def _to_factors(value: object, argument: Callable[[object], float], lowest: float | None) -> Rows:
    """Convert rows of a quantity and its factor, of which there must be two at least."""
    rows = to_table(value, argument, functools.partial(to_number, dimension=PURE_NUMBER))
    if len(rows) < 2:
        raise fault("expected two rows or more", "e.g. [[0, 1], [100, 0.8]]")
    for number, (at, factor) in enumerate(rows):
        if lowest is not None and at < lowest:
            raise fault(f"expected a value >= {lowest:g}", "begin with 0", key=f"{number}.0")
        if not 0.0 <= factor <= LARGEST_FACTOR:
            text = f"expected a factor from 0 to {LARGEST_FACTOR:g}"
            raise fault(text, "1 leaves m and mu as they are", key=f"{number}.1")
    return rows


def _factors(argument: Callable[[object], float], lowest: float | None = 0.0) -> tuple[Any, ...]:
    row = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
    convert = functools.partial(_to_factors, argument=argument, lowest=lowest)
    return BeforeValidator(convert), WithJsonSchema({"type": "array", "items": row, "minItems": 2})


ByPressure = Annotated[Rows, *_factors(functools.partial(to_number, dimension=STRESS))]
BySpeed = Annotated[Rows, *_factors(functools.partial(to_number, dimension=VELOCITY))]
ByTemperature = Annotated[Rows, *_factors(to_temperature, None)]
ByPath = Annotated[Rows, *_factors(functools.partial(to_number, dimension=LENGTH))]


class FrictionFactors(Part):
    """Factors on m and mu; beyond the ends of a table its end values hold."""

    pressure: ByPressure | None = Field(default=None, description="rows [contact pressure in MPa, factor]")
    speed: BySpeed | None = Field(default=None, description="rows [speed of sliding in mm/s, factor]")
    temperature: ByTemperature | None = Field(
        default=None,
        description="rows [temperature of the workpiece in degrees C, factor]; needs [heat]",
    )
    path: ByPath | None = Field(
        default=None, description="rows [path that the surface of the workpiece has slid on tools in mm, factor]"
    )
    exponent: Number = Field(
        default=1.0,
        gt=0,
        le=1,
        description="another factor, (p / reference_pressure)^(exponent - 1): below 1 friction grows more slowly than "
        "the pressure, as of sheets in drawing",
    )
    reference_pressure: Stress | None = Field(
        default=None, gt=0, description="pressure at which m and mu hold, needed with exponent [MPa]"
    )

    @model_validator(mode="after")
    def _check_exponent(self) -> Self:
        if self.exponent != 1.0 and self.reference_pressure is None:
            raise fault("missing key", "the pressure at which mu holds, e.g. 4", key="reference_pressure")
        if self.exponent == 1.0 and self.reference_pressure is not None:
            raise fault("has no meaning without exponent", "remove it, or give exponent", key="reference_pressure")
        if self.exponent == 1.0 and not any((self.pressure, self.speed, self.temperature, self.path)):
            raise fault("no factor is given", "give pressure, speed, temperature, path or exponent, or leave it out")
        return self

    def build(self) -> model.FrictionFactors:
        """Return the Model's."""
        tables = {name: getattr(self, name) for name in ("pressure", "speed", "temperature", "path")}
        return model.FrictionFactors(
            **{name: None if rows is None else np.array(rows) for name, rows in tables.items()},
            exponent=self.exponent,
            reference=self.reference_pressure or 1.0,
        )


class _Rough(Protocol):
    @property
    def friction(self) -> FrictionFactors | None: ...

    @property
    def heat(self) -> object: ...


def list_friction_problems(
    tools: Mapping[str, _Rough], *, heated: bool, laws: Mapping[str, str] | None = None
) -> Iterator[Problem]:
    """Yield the problems of friction that depends on what a case does not know. laws: of contact, by tool."""
    for name, tool in tools.items():
        if tool.friction is None:
            continue
        law = "coulomb" if laws is None else laws[name]
        if law in ("frictionless", "sticking"):
            text = f'has no meaning with contact = "{law}"'
            yield Problem(f"tools.{name}.friction", text, "remove it, or choose a friction law")
        if tool.friction.temperature is not None and not heated:
            text = "friction by temperature, and no temperature is known"
            yield Problem(f"tools.{name}.friction.temperature", text, "give [heat], or leave the table out")
