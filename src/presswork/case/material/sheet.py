# SPDX-License-Identifier: Apache-2.0
"""A sheet material: elasticity, yield function and hardening, as a table of a case or of a material file."""

from __future__ import annotations

import functools
from typing import Any

from pydantic import Field, ValidationError

from presswork.case.errors import CaseError
from presswork.case.heat.thermal import Thermal
from presswork.case.material.hardening import Hardening
from presswork.case.material.laws import FormingLimit
from presswork.case.material.plastic import PlasticLaws
from presswork.case.material.yield_function import Yld2000
from presswork.case.reader import list_problems
from presswork.case.units import Density


class SheetLaws(PlasticLaws):
    """The laws of an elastic-plastic sheet in plane stress; x is the rolling direction."""

    forming_limit: FormingLimit | None = Field(default=None, description="forming limit curve")


class NamedLaws(SheetLaws):
    """What a material file has: the laws of a metal, and its thermal properties."""

    hardening: Hardening = Field(description="flow stress along the rolling direction against plastic strain")
    density: Density | None = Field(default=None, description='density [t/mm^3], e.g. "7850 kg/m^3"')
    thermal: Thermal | None = Field(default=None, description="thermal properties of the sheet, needed with [heat]")

    def list_laws(self, *names: str) -> dict[str, Any]:
        """Return the keys that the case of a solid has: those of the laws that are given, and of `names`.

        Yld2000-2d is a function of plane stress: from r-values a solid has Hill's function instead.
        """
        keys = {*PlasticLaws.model_fields, *names}
        laws = self.model_dump(include=keys, exclude_none=True)
        chosen = self.yield_function
        hill = chosen.find_hill() if isinstance(chosen, Yld2000) and chosen.alpha is None else None
        return laws if hill is None else {**laws, "yield_function": hill.model_dump(exclude_none=True)}


@functools.cache
def _schema() -> dict[str, Any]:
    return NamedLaws.model_json_schema()


def check_sheet_material(data: object, source: str | None = None) -> NamedLaws:
    """Turn the table of a material file into its laws. Raises CaseError with every problem, named by key."""
    try:
        return NamedLaws.model_validate(data)
    except ValidationError as error:
        raise CaseError(list_problems(error, data, _schema()), source) from None
