# SPDX-License-Identifier: Apache-2.0
"""What austenite becomes on cooling: a steel by its composition, or martensite alone by its start."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.quantities import Temperature
from presswork.case.material.phases import Phases
from presswork.case.material.time_tables import TimeTables
from presswork.case.part import Part
from presswork.case.units import HeatOfMass, Number, fault

Percent = Annotated[Number, Field(ge=0, le=10)]
Delay = Annotated[Number, Field(gt=0)]
STEELS = {
    # composition: Karbasian & Tekkaya 2010, table 1; delays: boron, fitted to the critical cooling rate of 27 K/s there
    # (docs/theory/microstructure.md)
    "22MnB5": ({"C": 0.23, "Mn": 1.2, "Si": 0.25, "Cr": 0.2}, (12.0, 12.0, 6.5)),
}
LATENT_HEAT = (75.2e9, 81.5e9)
"""Latent heat of ferrite, pearlite and bainite, and of martensite [mm2/s2]: 590 and 640 MJ/m3 (Akerstrom 2006) at 7850
kg/m3."""
MOST_CARBON = 1.0
"""Mass per cent of carbon above which no formula here holds."""
HOTTEST_FURNACE = 1350.0
"""Temperature beyond which no steel is austenitised [degrees C]."""


def find_starts(composition: dict[str, float]) -> tuple[float, float, float, float]:
    """Return Ae3, Ae1 (Andrews 1965), bainite start (Li et al. 1998) and Ms (Kung & Rayment 1982) [degrees C].

    >>> [round(t) for t in find_starts({"C": 0.23, "Mn": 1.2, "Si": 0.25, "Cr": 0.2})]
    [824, 721, 575, 409]
    """
    c, mn, si, ni, cr, mo = (composition.get(e, 0.0) for e in model.ELEMENTS_OF_STEEL)
    return (
        910 - 203 * c**0.5 - 15.2 * ni + 44.7 * si + 31.5 * mo,
        723 - 10.7 * mn - 16.9 * ni + 29.1 * si + 16.9 * cr,
        637 - 58 * c - 35 * mn - 15 * ni - 34 * cr - 41 * mo,
        561 - 474 * c - 33 * mn - 17 * ni - 17 * cr - 21 * mo,
    )


class Transformation(Part):
    """Ferrite, pearlite and bainite by diffusion, and martensite, from austenite that cools; with latent heat."""

    steel: Literal["22MnB5"] | None = Field(default=None, description="a steel whose composition is known")
    composition: dict[Literal["C", "Mn", "Si", "Ni", "Cr", "Mo"], Percent] | None = Field(
        default=None, description="mass per cents, e.g. {C = 0.23, Mn = 1.2}; without it, and steel: martensite alone"
    )
    grain_size: Number = Field(default=8.0, ge=0, le=14, description="ASTM number of the austenite's grains")
    ms: Temperature | None = Field(
        default=None, description="start of martensite [degrees C]; without it: by the composition (Kung & Rayment)"
    )
    martensite_rate: Number = Field(default=0.011, gt=0, le=0.1, description="of Koistinen and Marburger [1/K]")
    ae3: Temperature | None = Field(default=None, description="start of ferrite; without it: by Andrews [degrees C]")
    ae1: Temperature | None = Field(default=None, description="start of pearlite; without it: by Andrews [degrees C]")
    bs: Temperature | None = Field(default=None, description="start of bainite; without it: by Li [degrees C]")
    delay: tuple[Delay, Delay, Delay] | None = Field(
        default=None,
        description="factors on the times of ferrite, pearlite and bainite, for elements beside the "
        "composition, such as boron; without it: those of the steel, or 1",
    )
    latent_heat: tuple[HeatOfMass, HeatOfMass] = Field(
        default=LATENT_HEAT,
        description='heat set free by ferrite, pearlite and bainite, and by martensite [mm^2/s^2]; e.g. ["75 kJ/kg", '
        '"82 kJ/kg"]',
    )
    times: TimeTables | None = Field(
        default=None, description="isothermal transformation (TTT) by tables, instead of the kinetics by composition"
    )
    phases: Phases | None = Field(
        default=None, description="strain and yield stress by phase, for distortion and residual stress of solids"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.steel is not None and self.composition is not None:
            raise fault("steel and composition both give the composition", "give one of them", key="composition")
        if self.find_composition() == {} and self.ms is None:
            raise fault("the start of martensite is not given", "give steel, composition or ms", key="ms")
        carbon = self.find_composition().get("C", 0.0)
        if carbon > MOST_CARBON:
            raise fault(
                f"{carbon:g} % of carbon is outside the range of stamping steels",
                "mass per cent, e.g. 0.23",
                key="composition",
            )
        if min(self.latent_heat) < 0:
            raise fault("a transformation on cooling sets heat free", "give values >= 0", key="latent_heat")
        if self.times is not None and self.steel is not None:
            raise fault("steel and times both give kinetics", "give composition in place of steel", key="times")
        made = self.to_model()
        if self.times is not None:
            self.times.check_above(made.martensite_start)
        starts = (made.martensite_start, made.bainite_start, made.pearlite_start, made.ferrite_start)
        if made.composition and not made.times and any(b <= a for a, b in itertools.pairwise(starts)):
            listed = ", ".join(f"{value:.0f}" for value in starts)
            raise fault(f"Ms, Bs, Ae1 and Ae3 do not increase: {listed} degrees C", "check what is given", key="ms")
        lacking = self.phases.find_missing(made) if self.phases else None
        if lacking is not None:
            remedy = f"add {lacking} = {{expansion = 1.4e-5, strain = 0.008}}"
            raise fault("missing key: it forms by the kinetics", remedy, key=f"phases.{lacking}")
        return self

    def find_composition(self) -> dict[str, float]:
        """Return the mass per cents by element; empty where martensite alone forms."""
        return dict(STEELS[self.steel][0]) if self.steel else {str(k): v for k, v in (self.composition or {}).items()}

    def to_model(self) -> model.Transformation:
        """Return the Model's."""
        mechanics = self.phases.to_model() if self.phases else None
        made = replace(self._find_kinetics(), mechanics=mechanics)
        if self.times is None:
            return made
        start = made.ferrite_start or self.times.hottest if self.ae3 is None else self.ae3
        return replace(made, times=self.times.to_model(), ferrite_start=start)

    def _find_kinetics(self) -> model.Transformation:
        composition = self.find_composition()
        slow, fast = self.latent_heat
        own = self.ms
        if not composition:
            assert own is not None
            return model.Transformation(
                martensite_start=own, martensite_rate=self.martensite_rate, latent_heat=(slow, slow, slow, fast)
            )
        ae3, ae1, bs, ms = find_starts(composition)
        made = model.Transformation(
            martensite_start=ms if own is None else own,
            martensite_rate=self.martensite_rate,
            composition=composition,
            grain_size=self.grain_size,
            ferrite_start=ae3 if self.ae3 is None else self.ae3,
            pearlite_start=ae1 if self.ae1 is None else self.ae1,
            bainite_start=bs if self.bs is None else self.bs,
            latent_heat=(slow, slow, slow, fast),
        )
        delay = self.delay or (STEELS[self.steel][1] if self.steel else None)
        return made if delay is None else replace(made, delay=delay)


def check_austenite(transformation: Transformation, key: str, start: float) -> Iterator[Problem]:
    """Yield a problem where a body is no austenite at the start, or hotter than in any furnace.

    key: of the temperature at the start [degrees C].
    """
    austenite = transformation.to_model().ferrite_start
    remedy = 'plain numbers are degrees C; with a unit: "1223 K"'
    if start < austenite:
        text = f"it is not austenite at {start:g} degrees C: Ae3 is {austenite:.0f} degrees C"
        yield Problem(key, text, f"heat it further, or leave transformation out; {remedy}", start)
    if start > HOTTEST_FURNACE:
        yield Problem(key, f"hotter than any furnace for steel, {HOTTEST_FURNACE:g} degrees C", remedy, start)
