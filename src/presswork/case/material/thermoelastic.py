# SPDX-License-Identifier: Apache-2.0
"""Thermal expansion, and elastic constants that depend on temperature."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, WithJsonSchema

from presswork import model
from presswork.case.heat.quantities import Rows, Temperature, to_array, to_table, to_temperature
from presswork.case.part import Part
from presswork.case.units import PURE_NUMBER, fault, to_number

LARGEST_COEFFICIENT = 1e-3
"""Largest accepted coefficient of thermal expansion [1/K]: twelve times that of zinc or lead."""
LARGEST_FACTOR = 3.0
"""Young's modulus over that of the material."""


def _to_coefficient(value: object) -> float:
    number = to_number(value, PURE_NUMBER)
    if not 0.0 <= number <= LARGEST_COEFFICIENT:
        raise fault(f"{number:g} 1/K is the thermal expansion of no metal", "steel has 1.2e-5, aluminium 2.4e-5")
    return number


def _to_factor(value: object) -> float:
    number = to_number(value, PURE_NUMBER)
    if not 0.0 < number <= LARGEST_FACTOR:
        raise fault(f"expected a factor on `young` above 0 and up to {LARGEST_FACTOR:g}", "e.g. [[20, 1], [600, 0.31]]")
    return number


def _to_poisson(value: object) -> float:
    number = to_number(value, PURE_NUMBER)
    if not -1.0 < number < 0.5:
        raise fault("expected Poisson's ratio, between -1 and 0.5", "e.g. [[20, 0.3], [1200, 0.35]]")
    return number


_ROW = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2}
_ROWS = WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "array", "items": _ROW, "minItems": 1}]})
Coefficients = Annotated[Rows, BeforeValidator(lambda v: to_table(v, to_temperature, _to_coefficient)), _ROWS]
Factors = Annotated[Rows, BeforeValidator(lambda v: to_table(v, to_temperature, _to_factor)), _ROWS]
PoissonRows = Annotated[Rows, BeforeValidator(lambda v: to_table(v, to_temperature, _to_poisson)), _ROWS]


class ThermalExpansion(Part):
    """Strain of a change of temperature."""

    coefficient: Coefficients = Field(
        description="coefficient of thermal expansion [1/K], about 1.2e-5 of steel, or rows [degrees C, it]"
    )
    secant_from: Temperature | None = Field(
        default=None,
        description="temperature from which the coefficient is the mean one [degrees C], as handbooks have it; without "
        "this key it is that of the next degree",
    )


def build_thermoelastic(
    expansion: ThermalExpansion | None, young_factor: Rows | None, poisson: Rows | None
) -> model.Thermoelastic | None:
    """Return the Model's, or None where nothing depends on temperature."""
    if expansion is None and young_factor is None and poisson is None:
        return None
    return model.Thermoelastic(
        expansion=to_array(expansion.coefficient) if expansion else None,
        secant_from=expansion.secant_from if expansion else None,
        young_factor=to_array(young_factor) if young_factor else None,
        poisson=to_array(poisson) if poisson else None,
    )
