# SPDX-License-Identifier: Apache-2.0
"""Grain size in a case: laws of recrystallisation and growth. Formulas: docs/theory/microstructure.md."""

from __future__ import annotations

from typing import Any, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.heat.quantities import Temperature
from presswork.case.part import Part
from presswork.case.units import Number, fault

DEFORMATION = "deformation_energy"


class PowerLaw(Part):
    """A d0^grain strain^strain rate^rate exp(energy/(R T)), or with zener: times Z^zener, Z = rate exp(Q/(R T))."""

    A: Number = Field(gt=0, description="coefficient A of the law, with grain sizes in um and times in s")
    grain: Number = Field(default=0.0, description="exponent of the grain size before deformation (in um)")
    strain: Number = Field(default=0.0, description="exponent of the strain")
    rate: Number = Field(default=0.0, description="exponent of the strain rate (in 1/s)")
    energy: Number = Field(default=0.0, description="activation energy [J/mol]; above zero where heat makes it smaller")
    zener: Number = Field(
        default=0.0, description="exponent of Zener and Hollomon's Z = rate exp(deformation_energy/(R T)) [1/s]"
    )

    def build(self, deformation: float) -> model.PowerLaw:
        """Return the Model's law; deformation: energy of Z [J/mol]."""
        return model.PowerLaw(
            A=self.A,
            grain=self.grain,
            strain=self.strain,
            rate=self.rate + self.zener,
            energy=self.energy + self.zener * deformation,
        )


class Dynamic(Part):
    """Recrystallisation during deformation."""

    critical_strain: PowerLaw = Field(description="strain at which it begins")
    half_strain: PowerLaw = Field(description="strain beyond that in which the first half recrystallises")
    size: PowerLaw = Field(description="size of the new grains [um]")
    exponent: Number = Field(default=2.0, gt=0, description="Avrami's exponent")

    def build(self, deformation: float) -> model.DynamicRecrystallisation:
        """Return the Model's law."""
        laws = (self.critical_strain, self.half_strain, self.size)
        critical, half, size = (law.build(deformation) for law in laws)
        return model.DynamicRecrystallisation(
            critical_strain=critical, half_strain=half, size=size, exponent=self.exponent
        )


class AfterDeformation(Part):
    """Recrystallisation after deformation."""

    half_time: PowerLaw = Field(description="time in which the first half recrystallises [s]")
    size: PowerLaw = Field(description="size of the new grains [um]")
    exponent: Number = Field(default=1.0, gt=0, description="Avrami's exponent")

    def build(self, deformation: float) -> model.Recrystallisation:
        """Return the Model's law."""
        half, size = (law.build(deformation) for law in (self.half_time, self.size))
        return model.Recrystallisation(half_time=half, size=size, exponent=self.exponent)


class Growth(Part):
    """Growth of recrystallised grains: d^exponent = d0^exponent + A t exp(-energy/(R T))."""

    A: Number = Field(gt=0, description="coefficient [um^exponent/s]")
    exponent: Number = Field(ge=1, description="exponent of the grain size, often 7 to 10")
    energy: Number = Field(gt=0, description="activation energy [J/mol]")

    def build(self) -> model.GrainGrowth:
        """Return the Model's law."""
        return model.GrainGrowth(A=self.A, exponent=self.exponent, energy=self.energy)


STEELS: dict[str, dict[str, Any]] = {
    "C-Mn": {
        "deformation_energy": 300e3,
        "dynamic": {
            "critical_strain": {"A": 5.6e-4, "grain": 0.3, "zener": 0.17},
            "half_strain": {"A": 1.144e-3, "grain": 0.28, "rate": 0.05, "energy": 6420.0 * 8.314462618},
            "size": {"A": 1.6e4, "zener": -0.23},
            "exponent": 2.0,
        },
        "metadynamic": {
            "half_time": {"A": 1.1, "zener": -0.8, "energy": 230e3},
            "size": {"A": 2.6e4, "zener": -0.23},
            "exponent": 1.5,
        },
        "static": {
            "half_time": {"A": 2.3e-15, "grain": 2.0, "strain": -2.5, "energy": 230e3},
            "size": {"A": 343.0, "grain": 0.4, "strain": -0.5, "energy": -45e3},
            "exponent": 1.0,
        },
    }
}
"""Laws of named steels. C-Mn: low-carbon steel with manganese, of hot rolling (Hodgson & Gibbs 1992, ISIJ Int. 32,
1329-1338); the strain of half dynamic recrystallisation by Senuma & Yada (1986, 7th Riso Symposium, 547-552)."""


class Grain(Part):
    """Grain size, and the laws by which it changes: those that are left out do not act."""

    steel: Literal["C-Mn"] | None = Field(
        default=None, description="a steel whose laws are known; those given beside it replace its own"
    )
    initial: Number = Field(gt=0, le=10000, description="mean grain size at the start [um]")
    deformation_energy: Number | None = Field(default=None, gt=0, description="energy Q of Z [J/mol]")
    dynamic: Dynamic | None = Field(default=None, description="recrystallisation during deformation")
    metadynamic: AfterDeformation | None = Field(
        default=None, description="recrystallisation after a deformation in which it began"
    )
    static: AfterDeformation | None = Field(default=None, description="recrystallisation after any other deformation")
    growth: Growth | None = Field(default=None, description="growth of recrystallised grains")
    temperature: Temperature | None = Field(
        default=None, description="temperature of a run without [heat] and `heating` [degrees C]"
    )
    softens: bool = Field(default=False, description="whether what is recrystallised no longer hardens")

    @model_validator(mode="before")
    @classmethod
    def _take_steel(cls, data: Any) -> Any:
        return {**STEELS[data["steel"]], **data} if isinstance(data, dict) and data.get("steel") in STEELS else data

    @model_validator(mode="after")
    def _check(self) -> Self:
        laws = (self.dynamic, self.metadynamic, self.static)
        if all(law is None for law in (*laws, self.growth)):
            remedy = "add a table dynamic, metadynamic, static or growth"
            raise fault("no law changes the grain size", remedy, key="dynamic")
        by_zener = any(part.zener for law in laws if law for part in vars(law).values() if isinstance(part, PowerLaw))
        if by_zener and self.deformation_energy is None:
            raise fault("missing key: zener needs it", "e.g. 312e3 (J/mol) of carbon steels", key=DEFORMATION)
        if self.metadynamic is not None and self.dynamic is None:
            raise fault("missing key: metadynamic needs it", "add it, or leave metadynamic out", key="dynamic")
        if self.dynamic and any(law.strain for law in (self.dynamic.critical_strain, self.dynamic.half_strain)):
            raise fault("the strain is what is sought", "leave the exponent out", key="dynamic")
        return self

    def to_model(self) -> model.Grain:
        """Return the Model's laws."""
        energy = self.deformation_energy or 0.0
        return model.Grain(
            initial=self.initial,
            dynamic=self.dynamic.build(energy) if self.dynamic else None,
            metadynamic=self.metadynamic.build(energy) if self.metadynamic else None,
            static=self.static.build(energy) if self.static else None,
            growth=self.growth.build() if self.growth else None,
            temperature=self.temperature,
            softens=self.softens,
        )
