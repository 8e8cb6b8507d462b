# SPDX-License-Identifier: Apache-2.0
"""A sheet material: elasticity, yield function and hardening, as a table of a case or of a material file."""

from __future__ import annotations

import functools
from typing import Any, Self

from pydantic import Field, ValidationError, model_validator

from presswork import _core, model
from presswork.case.errors import CaseError, Problem
from presswork.case.magnitudes import DESCRIPTION, Magnitudes, require_metal
from presswork.case.material.hardening import Hardening, Linear, build_hardening
from presswork.case.material.laws import FormingLimit, Kinematic, RateLaw, YoshidaUemori, YoungDecrease
from presswork.case.material.yield_function import VonMisesYield, YieldFunction
from presswork.case.part import Part
from presswork.case.reader import list_problems
from presswork.case.units import Number, Stress, fault
from presswork.law.sheet_law import make_sheet_law, make_solid_law


class SheetLaws(Part):
    """The laws of an elastic-plastic sheet in plane stress; x is the rolling direction."""

    young: Stress = Field(gt=0, description="Young's modulus [MPa]")
    poisson: Number = Field(gt=-1, lt=0.5, description="Poisson's ratio, e.g. 0.3 for steel")
    yield_function: YieldFunction = Field(default=VonMisesYield(), description="anisotropic yield function")
    hardening: Hardening = Field(description="flow stress along the rolling direction against plastic strain")
    kinematic: Kinematic | None = Field(default=None, description="back stresses")
    rate: RateLaw | None = Field(default=None, description="factor on the flow stress by strain rate")
    young_decrease: YoungDecrease | None = Field(
        default=None, description="how Young's modulus falls with plastic strain"
    )
    forming_limit: FormingLimit | None = Field(default=None, description="forming limit curve")
    magnitudes: Magnitudes = Field(default="metal", description=DESCRIPTION)

    @model_validator(mode="after")
    def _check_laws(self) -> Self:
        """Refuse laws that do not go together."""
        if isinstance(self.kinematic, YoshidaUemori):
            if not isinstance(self.hardening, Linear) or self.hardening.modulus != 0.0:
                raise fault(
                    "Yoshida and Uemori's yield surface keeps its size",
                    'give hardening = {law = "linear", yield_stress = Y}, without a modulus',
                    key="hardening",
                )
            if self.hardening.yield_stress >= self.kinematic.B:
                raise fault(
                    f"the bounding surface B = {self.kinematic.B:g} MPa lies inside the yield surface",
                    f"B must be above the yield stress of {self.hardening.yield_stress:g} MPa",
                    key="kinematic",
                )
        if self.young_decrease is not None and self.young_decrease.saturated > self.young:
            raise fault("the saturated modulus is above Young's modulus", "it falls", key="young_decrease")
        if self.magnitudes == "metal":
            require_metal(self.young, lambda strain: self.build_law().flow_stress(strain)[0])
        return self

    def to_model(self, name: str) -> model.Material:
        """Return the Model's material."""
        return model.Material(
            name,
            self.young,
            self.poisson,
            build_hardening(self.hardening),
            yield_function=self.yield_function.to_model(),
            kinematic=self.kinematic.to_model() if self.kinematic else None,
            rate=self.rate.to_model() if self.rate else None,
            young_decrease=(self.young_decrease.saturated, self.young_decrease.rate) if self.young_decrease else None,
        )

    def build_law(self) -> _core.SheetLaw:
        """Return the compiled law of plane stress."""
        return make_sheet_law(self.to_model("sheet"))

    def build_solid_law(self) -> _core.SolidLaw:
        """Return the compiled law of three dimensions. Raises CaseError for a yield function of plane stress alone."""
        try:
            return make_solid_law(self.to_model("sheet"))
        except ValueError as error:
            problem = Problem("yield_function.law", str(error), "take von_mises or hill1948")
            raise CaseError([problem], "material") from None


@functools.cache
def _schema() -> dict[str, Any]:
    return SheetLaws.model_json_schema()


def check_sheet_material(data: object, source: str | None = None) -> SheetLaws:
    """Turn a table into a SheetLaws. Raises CaseError with every problem, named by key."""
    try:
        return SheetLaws.model_validate(data)
    except ValidationError as error:
        raise CaseError(list_problems(error, data, _schema()), source) from None
