# SPDX-License-Identifier: Apache-2.0
"""The laws of an elastic-plastic material, of a sheet or of a solid: their keys, and which go together."""

from __future__ import annotations

from typing import Any, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from presswork import _core, model
from presswork.case.errors import Problem
from presswork.case.magnitudes import DESCRIPTION, Magnitudes, require_metal
from presswork.case.material.damage import Damage
from presswork.case.material.hardening import Hardening, Linear, build_hardening
from presswork.case.material.heating import Heating
from presswork.case.material.hot_hardening import HotLaw, check_heating
from presswork.case.material.laws import Kinematic, RateLaw, YoshidaUemori, YoungDecrease
from presswork.case.material.thermoelastic import Factors, PoissonRows, ThermalExpansion, build_thermoelastic
from presswork.case.material.yield_function import OF_GRADE, Barlat1989, VonMisesYield, YieldFunction, Yld2000
from presswork.case.part import Part
from presswork.case.units import STRESS, Number, Stress, fault, to_number
from presswork.law.elastic_plastic import make_sheet_law
from presswork.model import FloatArray

LIGHT = 1e5
"""Young's modulus [MPa] below which a sheet has the exponent of aluminium."""
OF_FLOW = ("kinematic", "rate", "young_decrease", "damage", "yield_function")
"""Keys of laws that mean nothing in an elastic material."""


def _is_light(young: object) -> bool:
    """Return whether a Young's modulus, as a case gives it, is that of aluminium or magnesium rather than of steel."""
    try:
        return float(to_number(young, STRESS)) < LIGHT
    except (PydanticCustomError, TypeError, ValueError):
        return False


class PlasticLaws(Part):
    """Elasticity, yield function, hardening, strain rate and temperature; x is the rolling direction."""

    DEFAULT_LAW: ClassVar[str] = "yld2000"
    """Yield function of r-values that come without a law."""

    young: Stress = Field(gt=0, description="Young's modulus [MPa]; needed without library")
    poisson: Number = Field(
        gt=-1, lt=0.5, description="Poisson's ratio, between -1 and 0.5, e.g. 0.3 for steel; needed without library"
    )
    yield_function: YieldFunction = Field(
        default=VonMisesYield(),
        description="anisotropic yield function; r00, r45 and r90 without a law: of a sheet yld2000 with the yield "
        "stresses that are given, the others as along the rolling direction; of a solid hill1948",
    )
    hardening: Hardening | None = Field(
        default=None,
        description="flow stress along the rolling direction against plastic strain; without it: the body is elastic",
    )
    kinematic: Kinematic | None = Field(default=None, description="back stresses")
    rate: RateLaw | None = Field(default=None, description="factor on the flow stress by strain rate")
    heating: Heating | None = Field(default=None, description="softening by temperature, and heating by plastic work")
    young_decrease: YoungDecrease | None = Field(
        default=None, description="how Young's modulus falls with plastic strain"
    )
    damage: Damage | None = Field(default=None, description="criterion of fracture, and its critical value")
    expansion: ThermalExpansion | None = Field(default=None, description="thermal expansion")
    young_factor: Factors | None = Field(
        default=None,
        description="rows [degrees C, factor on `young`], e.g. [[20, 1], [600, 0.31]]",
    )
    poisson_by_temperature: PoissonRows | None = Field(
        default=None, description="rows [degrees C, Poisson's ratio], in place of `poisson`"
    )
    magnitudes: Magnitudes = Field(default="metal", description=DESCRIPTION)

    @model_validator(mode="before")
    @classmethod
    def _choose_yield_function(cls, data: Any) -> Any:
        """Give r-values without a law that of `DEFAULT_LAW`, with the exponent of steel or aluminium."""
        chosen = data.get("yield_function") if isinstance(data, dict) else None
        if not isinstance(chosen, dict) or "law" in chosen or not set(chosen) & set(OF_GRADE):
            return data
        given = {"law": cls.DEFAULT_LAW, **chosen}
        if cls.DEFAULT_LAW == "yld2000":
            given.setdefault("exponent", 8 if _is_light(data.get("young")) else 6)
        return {**data, "yield_function": given}

    @model_validator(mode="after")
    def _check_laws(self) -> Self:
        """Refuse laws that do not go together."""
        if self.hardening is None:
            self._check_elastic()
        softens = self.hardening is not None and self.follows_temperature() is None
        check_heating(self.heating, self.hardening, softens=softens)
        if isinstance(self.hardening, HotLaw) and self.rate is not None:
            remedy = f"remove it: {self.hardening.law} depends on the rate by itself"
            raise fault("the flow stress would depend on the rate twice", remedy, key="rate")
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
            require_metal(self.young, self._usual_flow_stress if self.hardening else None)
        return self

    def _check_elastic(self) -> None:
        """Refuse laws of plastic flow beside no hardening."""
        for key in (*OF_FLOW, *(key for key in ("gtn", "grain", "forming_limit") if key in type(self).model_fields)):
            if key in self.model_fields_set and getattr(self, key) is not None:
                remedy = "add it, or leave the key out: a material without hardening is elastic"
                raise fault(f"missing key, which {key} goes with", remedy, key="hardening")
        softening = self.heating.model_fields_set & {"melting", "exponent", "heat_capacity"} if self.heating else ()
        if softening:
            keys = sorted(softening)
            remedy = f"leave {' and '.join(keys)} out: a material without hardening is elastic"
            raise fault("has no meaning without hardening", remedy, key=f"heating.{keys[0]}")

    def _usual_flow_stress(self, strain: FloatArray) -> FloatArray:
        """Return the flow stress [MPa] at rest and unsoftened, or in the middle of a hot law's window."""
        rate, degrees = 0.0, self.heating.reference if self.heating else 0.0
        if isinstance(self.hardening, HotLaw):
            window = self.hardening.window()
            rate, degrees = float(np.sqrt(np.prod(window[1]))), float(window[2].mean())
        return self.build_law().flow_stress(strain, np.full(len(strain), rate), np.full(len(strain), degrees))[0]

    def follows_temperature(self) -> str | None:
        """Return the key by which elasticity depends on temperature, if there is one."""
        keys = ("expansion", "young_factor", "poisson_by_temperature")
        return next((key for key in keys if getattr(self, key) is not None), None)

    def needs_time(self) -> str | None:
        """Return the key of the law that depends on the strain rate, if there is one."""
        return "hardening" if isinstance(self.hardening, HotLaw) else "rate" if self.rate is not None else None

    def to_model(self, name: str) -> model.Material:
        """Return the Model's material."""
        return model.Material(
            name,
            self.young,
            self.poisson,
            build_hardening(self.hardening) if self.hardening else model.never_yield(self.young),
            yield_function=self.yield_function.to_model(),
            kinematic=self.kinematic.to_model() if self.kinematic else None,
            rate=self.rate.to_model() if self.rate else None,
            heating=self.heating.to_model() if self.heating else None,
            damage=self.damage.to_model() if self.damage else None,
            young_decrease=(self.young_decrease.saturated, self.young_decrease.rate) if self.young_decrease else None,
            thermoelastic=build_thermoelastic(self.expansion, self.young_factor, self.poisson_by_temperature),
        )

    def build_law(self) -> _core.SheetLaw:
        """Return the compiled law of plane stress."""
        return make_sheet_law(self.to_model("sheet"))

    def check_in_solids(self, key: str) -> list[Problem]:
        """Return the problem of a yield function that has no form in three dimensions; key: of the material."""
        if not isinstance(self.yield_function, Barlat1989 | Yld2000):
            return []
        name = self.yield_function.law
        fault = f"{name} is a yield function of plane stress alone, and a solid's stress has three dimensions"
        return [Problem(f"{key}.yield_function.law", fault, "take von_mises, hill1948 or yld2004", name)]
