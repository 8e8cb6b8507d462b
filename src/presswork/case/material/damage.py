# SPDX-License-Identifier: Apache-2.0
"""Criteria of ductile fracture in a case. Formulas: docs/theory/damage.md."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from presswork import model
from presswork.case.part import Part
from presswork.case.units import Length, Number, Stress, fault

CRITICAL = "value at which a crack begins, found by `presswork calibrate damage`; without it no crack is reported"


class _Damage(Part):
    """What every criterion has."""

    critical: Number | None = Field(default=None, gt=0, description=CRITICAL)
    length: Length | None = Field(
        default=None,
        gt=0,
        description="radius over which the mean of the damage decides, of the undeformed material [mm]; without it a "
        "tenth of a solid's thickness (the largest ball inside), of a sheet two sizes of a shell",
    )

    def to_model(self) -> model.Damage:
        """Return the Model's criterion."""
        values = self.model_dump()
        criterion, critical, length = (values.pop(key) for key in ("criterion", "critical", "length"))
        return model.Damage(criterion, values, critical, length)


class CockcroftLatham(_Damage):
    """Integral of the largest principal stress, where it pulls, over the effective stress."""

    criterion: Literal["cockcroft_latham"] = Field(default="cockcroft_latham", description="criterion of fracture")


class RiceTracey(_Damage):
    """Integral of factor exp(exponent x), x the mean stress over the effective stress: growth of voids."""

    criterion: Literal["rice_tracey"] = Field(default="rice_tracey", description="criterion of fracture")
    factor: Number = Field(default=0.283, gt=0, description="factor of the exponential; 0.283 by Rice and Tracey")
    exponent: Number = Field(
        default=1.5, gt=0, description="factor of the triaxiality in the exponential; 1.5 by Rice and Tracey"
    )


class Oyane(_Damage):
    """Integral of 1 + x/A where that is positive, x the mean stress over the effective stress."""

    criterion: Literal["oyane"] = Field(default="oyane", description="criterion of fracture")
    A: Number = Field(gt=0, description="Oyane's constant of the material, about 0.3")


class Freudenthal(_Damage):
    """Plastic work per volume."""

    criterion: Literal["freudenthal"] = Field(default="freudenthal", description="criterion of fracture")
    critical: Stress | None = Field(default=None, gt=0, description=f"{CRITICAL} [MPa]")


class _FractureStrain(_Damage):
    """Integral of 1/ef, ef the equivalent plastic strain at fracture; a crack begins at 1."""

    critical: Number | None = Field(default=1.0, gt=0, description="value at which a crack begins; 1 by the law")


class JohnsonCookFracture(_FractureStrain):
    """Integral of 1/ef, ef the fracture strain by triaxiality, strain rate and temperature; a crack begins at 1."""

    criterion: Literal["johnson_cook"] = Field(default="johnson_cook", description="criterion of fracture")
    d1: Number = Field(description="part of the fracture strain that does not depend on triaxiality")
    d2: Number = Field(ge=0, description="part of the fracture strain that depends on triaxiality")
    d3: Number = Field(le=0, description="how fast that part falls with the triaxiality x, as exp(d3 x); below zero")
    d4: Number = Field(
        default=0.0,
        description="how much the fracture strain rises with the logarithm of the strain rate; 0: not at all",
    )
    d5: Number = Field(default=0.0, description="how much the fracture strain rises with temperature; 0: not at all")
    reference_rate: Number = Field(
        default=1.0,
        gt=0,
        description="plastic strain rate beyond which d4 acts, the rate of the tests of d1 to d3 [1/s]",
    )
    reference: Number = Field(default=20.0, description="temperature above which d5 acts [degrees C]")
    melting: Number = Field(default=1500.0, description="melting temperature, at which d5 acts in full [degrees C]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.d1 + self.d2 > 0:
            raise fault("no fracture strain is left: d1 + d2 must be above zero", "check the signs", key="d1")
        if not self.melting > self.reference:
            raise fault(f"not above reference = {self.reference:g}", "steel melts at 1500 degrees C", key="melting")
        if self.d5 != 0.0 and "melting" not in self.model_fields_set:
            raise fault("missing key: d5 needs it", "add it, e.g. 1500 (degrees C)", key="melting")
        if self.d4 != 0.0 and "reference_rate" not in self.model_fields_set:
            raise fault("missing key: d4 needs it", "add it, e.g. 1.0 (1/s)", key="reference_rate")
        return self


class ModifiedMohrCoulomb(_FractureStrain):
    """Integral of 1/ef, ef the fracture strain of Bai and Wierzbicki (2010) by triaxiality and Lode angle."""

    criterion: Literal["modified_mohr_coulomb"] = Field(
        default="modified_mohr_coulomb", description="criterion of fracture"
    )
    A: Stress = Field(gt=0, description="strength of the flow curve A p^n by which strains come from stresses [MPa]")
    n: Number = Field(gt=0, description="exponent of the flow curve A p^n")
    c1: Number = Field(ge=0, description="friction of the Mohr-Coulomb plane: how much pressure holds it together")
    c2: Stress = Field(gt=0, description="shear strength of the plane [MPa]")
    c3: Number = Field(
        default=1.0, gt=0, description="how much the Lode angle counts: from shear to tension; 1: by the plane alone"
    )


class HosfordCoulomb(_FractureStrain):
    """Integral of 1/ef, ef the fracture strain of Mohr and Marcadet (2015) by triaxiality and Lode angle."""

    criterion: Literal["hosford_coulomb"] = Field(default="hosford_coulomb", description="criterion of fracture")
    a: Number = Field(ge=1.0, le=8.0, description="exponent of Hosford's norm; 1: Tresca's, 2: von Mises's")
    b: Number = Field(gt=0, description="fracture strain in tension and in equibiaxial tension")
    c: Number = Field(ge=0, description="how much the largest and least principal stress count: friction")
    n: Number = Field(default=0.1, gt=0, description="exponent from stresses to strains; 0.1 by Mohr and Marcadet")


class BaiWierzbicki(_FractureStrain):
    """Integral of 1/ef, ef the fracture strain of Bai and Wierzbicki (2008): a parabola over the Lode angle."""

    criterion: Literal["bai_wierzbicki"] = Field(default="bai_wierzbicki", description="criterion of fracture")
    d1: Number = Field(gt=0, description="fracture strain in axisymmetric tension at no mean stress")
    d2: Number = Field(ge=0, description="how fast it falls with the triaxiality x, as exp(-d2 x)")
    d3: Number = Field(gt=0, description="fracture strain in shear and plane strain at no mean stress")
    d4: Number = Field(ge=0, description="how fast it falls with the triaxiality x, as exp(-d4 x)")
    d5: Number = Field(gt=0, description="fracture strain in axisymmetric compression at no mean stress")
    d6: Number = Field(ge=0, description="how fast it falls with the triaxiality x, as exp(-d6 x)")


def assume_cockcroft_latham(table: Any) -> Any:
    """Take a table without a criterion for that of Cockcroft and Latham."""
    return {"criterion": "cockcroft_latham", **table} if isinstance(table, dict) else table


Damage = Annotated[
    Annotated[
        CockcroftLatham
        | RiceTracey
        | Oyane
        | Freudenthal
        | JohnsonCookFracture
        | ModifiedMohrCoulomb
        | HosfordCoulomb
        | BaiWierzbicki,
        Field(discriminator="criterion"),
    ],
    BeforeValidator(assume_cockcroft_latham),
]
