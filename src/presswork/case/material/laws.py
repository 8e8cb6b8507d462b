# SPDX-License-Identifier: Apache-2.0
"""Parts of a sheet material: back stresses, strain rate, falling modulus, forming limit.

Formulas: docs/theory/sheet_material.md.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.part import Part
from presswork.case.units import Length, Number, Stress, fault

MOST_BACK_STRESSES = 10
"""Number of back stresses that a layer of a shell has room for."""


class Chaboche(Part):
    """Back stresses that each grow by C and fade by gamma; gamma 0 is the linear law of Prager and Ziegler."""

    law: Literal["chaboche"] = Field(default="chaboche", description="chaboche: Chaboche's back stresses")
    C: tuple[Stress, ...] = Field(
        min_length=1,
        max_length=MOST_BACK_STRESSES,
        description="rate of growth of each back stress per plastic strain [MPa]",
    )
    gamma: tuple[Number, ...] = Field(
        min_length=1, description="rate at which each fades per plastic strain; each saturates at C/gamma"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(self.C) != len(self.gamma):
            raise fault(
                f"expected as many as C, {len(self.C)}", "give one gamma for each C, 0 for a linear one", key="gamma"
            )
        for name in ("C", "gamma"):
            if min(getattr(self, name)) < 0:
                raise fault("expected values >= 0", "a back stress that shrinks by itself has no meaning", key=name)
        return self

    def to_model(self) -> model.Kinematic:
        """Return the Model's back stresses."""
        return model.Kinematic(self.law, {"C": self.C, "gamma": self.gamma})


class YoshidaUemori(Part):
    """Two surfaces of Yoshida and Uemori (2002); their Y is the yield stress of the hardening law."""

    law: Literal["yoshida_uemori"] = Field(
        default="yoshida_uemori", description="yoshida_uemori: two surfaces of Yoshida and Uemori"
    )
    B: Stress = Field(gt=0, description="initial size of the bounding surface [MPa]")
    C: Number = Field(gt=0, description="rate at which the yield surface follows")
    m: Number = Field(ge=0, description="rate of the bounding surface")
    b: Stress = Field(ge=0, description="saturation of the bounding surface's centre [MPa]")
    Rsat: Stress = Field(ge=0, description="saturation of the bounding surface's growth [MPa]")
    h: Number = Field(ge=0, le=1, description="how fast the stagnation surface grows")

    def to_model(self) -> model.Kinematic:
        """Return the Model's back stresses."""
        return model.Kinematic(self.law, {name: (getattr(self, name),) for name in ("B", "C", "m", "b", "Rsat", "h")})


class CowperSymonds(Part):
    """Flow stress times 1 + (rate/D)^(1/q)."""

    law: Literal["cowper_symonds"] = Field(
        default="cowper_symonds", description="cowper_symonds: Cowper and Symonds' factor"
    )
    D: Number = Field(gt=0, description="plastic strain rate at which the flow stress doubles [1/s]")
    q: Number = Field(ge=1, description="exponent")

    def to_model(self) -> model.Rate:
        """Return the Model's rate law."""
        return model.Rate(self.law, {"D": self.D, "q": self.q})


class JohnsonCookRate(Part):
    """Flow stress times 1 + C ln(rate/reference_rate), above the reference rate."""

    law: Literal["johnson_cook"] = Field(default="johnson_cook", description="johnson_cook: Johnson and Cook's factor")
    C: Number = Field(ge=0, description="sensitivity")
    reference_rate: Number = Field(gt=0, description="plastic strain rate of the hardening law [1/s]")

    def to_model(self) -> model.Rate:
        """Return the Model's rate law."""
        return model.Rate(self.law, {"C": self.C, "reference_rate": self.reference_rate})


class LogarithmicRate(Part):
    """Flow stress times 1 + C ln(1 + rate/reference_rate)."""

    law: Literal["logarithmic"] = Field(
        default="logarithmic", description="logarithmic: a factor that grows with the logarithm of the rate"
    )
    C: Number = Field(ge=0, description="sensitivity")
    reference_rate: Number = Field(gt=0, description="plastic strain rate from which it is felt [1/s]")

    def to_model(self) -> model.Rate:
        """Return the Model's rate law."""
        return model.Rate(self.law, {"C": self.C, "reference_rate": self.reference_rate})


class YoungDecrease(Part):
    """Young's modulus = saturated + (young - saturated) exp(-rate e), e the equivalent plastic strain."""

    saturated: Stress = Field(gt=0, description="Young's modulus after large plastic strain [MPa]")
    rate: Number = Field(gt=0, description="rate of the decrease per unit of plastic strain")


class _Limit(Part):
    """What every forming limit has."""

    safety_margin: Number | None = Field(
        default=None,
        ge=0,
        lt=1,
        description="part of the limit's height held in reserve; 0.1 is usual, 0.08 for aluminium",
    )


class KeelerLimit(_Limit):
    """Keeler and Brazier's curve for mild and conventional high-strength steel."""

    law: Literal["keeler"] = Field(default="keeler", description="keeler: Keeler and Brazier's curve")
    thickness: Length | None = Field(
        default=None, gt=0, description="thickness of the sheet t [mm]; without it that of the blank"
    )
    n: Number = Field(gt=0, description="hardening exponent n")


class PointsLimit(_Limit):
    """A measured forming limit."""

    law: Literal["points"] = Field(default="points", description="points: a measured curve")
    points: tuple[tuple[Number, Number], ...] = Field(description="[minor, major] true strains")
    thickness: Length | None = Field(default=None, gt=0, description="thickness of the sheet that was tested [mm]")
    scaling: Literal["none", "keeler"] = Field(
        default="none",
        description='how the curve of another thickness is applied: "none", as it was measured, or "keeler", raised as '
        "Keeler's formula rises with thickness",
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.scaling != "none" and self.thickness is None:
            raise fault("missing key", "give the thickness at which the points were measured", key="thickness")
        return self


class SwiftHillLimit(_Limit):
    """Hill's localised and Swift's diffuse necking."""

    law: Literal["swift_hill"] = Field(default="swift_hill", description="swift_hill: Swift's and Hill's necking")


class MarciniakKuczynskiLimit(_Limit):
    """Marciniak and Kuczynski's computed limit."""

    law: Literal["marciniak_kuczynski"] = Field(
        default="marciniak_kuczynski", description="marciniak_kuczynski: a curve computed from a groove in the sheet"
    )
    imperfection: Number = Field(default=0.996, gt=0.5, lt=1, description="thickness of the groove over the sheet's")


Kinematic = Annotated[Chaboche | YoshidaUemori, Field(discriminator="law")]
RateLaw = Annotated[CowperSymonds | JohnsonCookRate | LogarithmicRate, Field(discriminator="law")]
FormingLimit = Annotated[
    KeelerLimit | PointsLimit | SwiftHillLimit | MarciniakKuczynskiLimit, Field(discriminator="law")
]
