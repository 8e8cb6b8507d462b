# SPDX-License-Identifier: Apache-2.0
"""Hardening laws of a case, and their parameters in the order of model.Hardening.

Formulas, with e the equivalent plastic strain: docs/theory/material.md.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork import _core, model
from presswork.case.material.hot_hardening import HenselSpittel, HotLaw, JohnsonCookHardening, NortonHoff, SinhArrhenius
from presswork.case.material.hot_table import HotTable
from presswork.case.part import Part
from presswork.case.units import Number, Stress, fault


class _Named(Part):
    """A law whose keys are the names of the compiled law's parameters."""

    law: str

    def parameters(self) -> list[float]:
        """Return the parameters in the order of the compiled law."""
        return [float(getattr(self, name)) for name in _core.parameter_names(_core.HardeningLaw[self.law])]


class Linear(_Named):
    """Flow stress = yield_stress + modulus e."""

    law: Literal["linear"] = Field(default="linear", description="linear: a straight line")
    yield_stress: Stress = Field(gt=0, description="initial flow stress [MPa]")
    modulus: Stress = Field(
        default=0.0, ge=0, description="plastic modulus H' = d(flow stress)/d(plastic strain) [MPa]"
    )


class Swift(_Named):
    """Flow stress = K (e0 + e)^n."""

    law: Literal["swift"] = Field(default="swift", description="swift: Swift's power law")
    K: Stress = Field(gt=0, description="strength coefficient [MPa]")
    e0: Number = Field(gt=0, description="strain before the test begins, e.g. 0.007")
    n: Number = Field(ge=0, le=1, description="hardening exponent, about 0.2 for steel")


class Ludwik(_Named):
    """Flow stress = yield_stress + K e^n."""

    law: Literal["ludwik"] = Field(default="ludwik", description="ludwik: Ludwik's power law")
    yield_stress: Stress = Field(gt=0, description="initial flow stress [MPa]")
    K: Stress = Field(ge=0, description="strength coefficient [MPa]")
    n: Number = Field(gt=0, le=1, description="hardening exponent, about 0.5")


class Voce(_Named):
    """Flow stress = saturation_stress - (saturation_stress - yield_stress) exp(-rate e)."""

    law: Literal["voce"] = Field(default="voce", description="voce: Voce's law, which saturates")
    yield_stress: Stress = Field(gt=0, description="initial flow stress [MPa]")
    saturation_stress: Stress = Field(gt=0, description="flow stress at large strain [MPa]")
    rate: Number = Field(gt=0, description="rate of saturation per unit of plastic strain")

    @model_validator(mode="after")
    def _check_saturation(self) -> Self:
        _check_saturation(self.yield_stress, self.saturation_stress)
        return self


class LinearVoce(_Named):
    """Flow stress = yield_stress + modulus e + (saturation_stress - yield_stress) (1 - exp(-rate e))."""

    law: Literal["linear_voce"] = Field(
        default="linear_voce", description="linear_voce: Voce's law and a straight line"
    )
    yield_stress: Stress = Field(gt=0, description="initial flow stress [MPa]")
    saturation_stress: Stress = Field(gt=0, description="flow stress at large strain less its linear part [MPa]")
    rate: Number = Field(gt=0, description="rate of saturation per unit of plastic strain")
    modulus: Stress = Field(ge=0, description="slope of the linear part, which is left at large strain [MPa]")

    @model_validator(mode="after")
    def _check_saturation(self) -> Self:
        _check_saturation(self.yield_stress, self.saturation_stress)
        return self


class HockettSherby(_Named):
    """Flow stress = saturation_stress - (saturation_stress - yield_stress) exp(-rate e^exponent)."""

    law: Literal["hockett_sherby"] = Field(
        default="hockett_sherby", description="hockett_sherby: Hockett and Sherby's law, which saturates"
    )
    yield_stress: Stress = Field(gt=0, description="initial flow stress [MPa]")
    saturation_stress: Stress = Field(gt=0, description="flow stress at large strain [MPa]")
    rate: Number = Field(gt=0, description="rate of saturation per unit of plastic strain to the power `exponent`")
    exponent: Number = Field(gt=0, description="exponent of the plastic strain")

    @model_validator(mode="after")
    def _check_saturation(self) -> Self:
        _check_saturation(self.yield_stress, self.saturation_stress)
        return self


class SwiftVoce(_Named):
    """Flow stress = (1 - voce_share) Swift + voce_share Voce."""

    law: Literal["swift_voce"] = Field(
        default="swift_voce", description="swift_voce: a mean of Swift's and Voce's laws"
    )
    voce_share: Number = Field(ge=0, le=1, description="share of Voce's law, 0 to 1; the rest is Swift's")
    K: Stress = Field(gt=0, description="strength coefficient [MPa]")
    e0: Number = Field(gt=0, description="strain before the test begins, e.g. 0.007")
    n: Number = Field(ge=0, le=1, description="hardening exponent, about 0.2 for steel")
    yield_stress: Stress = Field(gt=0, description="initial flow stress of Voce's law [MPa]")
    saturation_stress: Stress = Field(gt=0, description="flow stress of Voce's law at large strain [MPa]")
    rate: Number = Field(gt=0, description="rate of saturation per unit of plastic strain")

    @model_validator(mode="after")
    def _check_saturation(self) -> Self:
        _check_saturation(self.yield_stress, self.saturation_stress)
        return self


MOST_STRAIN = 5.0
"""Plastic strain beyond all tests: a larger one is in per cent."""


class _Points(Part):
    """Measured points, and what is wrong with them."""

    points: tuple[tuple[Number, Stress], ...] = Field(
        description="[plastic strain, stress in MPa] rows; strain starts at 0 and increases, stress does not decrease"
    )
    softening: bool = Field(default=False, description="whether the stress may decrease from row to row")

    @model_validator(mode="after")
    def _check_rows(self) -> Self:
        if not self.points:
            raise fault("expected at least one row", "give [[0, yield stress], ...]", key="points")
        if self.points[0][0] != 0.0:
            raise fault(
                f"the first plastic strain is {self.points[0][0]:g}, not 0",
                "start with [0, yield stress]; plastic strain is total strain less stress over Young's modulus",
                key="points",
            )
        if self.points[-1][0] > MOST_STRAIN:
            raise fault(
                f"the plastic strain reaches {self.points[-1][0]:g}, which reads as per cent",
                "divide the strains by 100: 0.2 is 20 %; rows beyond a strain of 5 can be left out",
                key="points",
            )
        if self.points[0][1] <= 0.0:
            raise fault(
                f"the first stress is {self.points[0][1]:g} MPa, not > 0", "give the yield stress", key="points"
            )
        for row, ((strain_n, stress_n), (strain, stress)) in enumerate(
            zip(self.points, self.points[1:], strict=False), 1
        ):
            if strain <= strain_n:
                raise fault(
                    f"strain does not increase in row {row} ({strain:g} after {strain_n:g})",
                    "sort the rows by strain and leave out doubles",
                    key="points",
                )
            if stress < stress_n and not self.softening:
                raise fault(
                    f"stress decreases in row {row} ({stress:g} after {stress_n:g} MPa)",
                    "leave out the rows beyond the highest stress, or ask for it: softening = true",
                    key="points",
                )
            if stress <= 0.0:
                raise fault(f"stress is {stress:g} MPa in row {row}, not > 0", "leave the row out", key="points")
        return self


class Table(_Points):
    """Flow stress linear between measured points; the last slope goes on beyond the last."""

    law: Literal["table"] = Field(default="table", description="table: straight lines through given points")

    def parameters(self) -> list[float]:
        """Return the parameters in the order of model.Hardening."""
        return [value for row in self.points for value in row]


class MonotoneTable(_Points):
    """Flow stress by cubics through measured points, without wiggles and with a continuous slope."""

    law: Literal["monotone_table"] = Field(
        default="monotone_table", description="monotone_table: a smooth curve through given points"
    )

    @model_validator(mode="after")
    def _check_number(self) -> Self:
        if len(self.points) < 2:
            raise fault("expected at least two rows", "give [[0, yield stress], [strain, stress], ...]", key="points")
        return self

    def parameters(self) -> list[float]:
        """Return the parameters in the order of model.Hardening, slopes after Fritsch and Butland (1984)."""
        from scipy.interpolate import PchipInterpolator  # slow to import

        table = np.array(self.points)
        slopes = PchipInterpolator(table[:, 0], table[:, 1]).derivative()(table[:, 0])
        return [float(value) for value in np.column_stack([table, slopes]).ravel()]


Hardening = Annotated[
    Linear
    | Swift
    | Ludwik
    | Voce
    | LinearVoce
    | HockettSherby
    | SwiftVoce
    | Table
    | MonotoneTable
    | HenselSpittel
    | NortonHoff
    | SinhArrhenius
    | JohnsonCookHardening
    | HotTable,
    Field(discriminator="law"),
]


def _check_saturation(yield_stress: float, saturation_stress: float) -> None:
    if saturation_stress < yield_stress:
        raise fault(
            f"the saturation stress lies below the yield stress of {yield_stress:g} MPa",
            f"give a value of at least {yield_stress:g} MPa",
            key="saturation_stress",
        )


def build_hardening(hardening: Hardening) -> model.Hardening:
    """Turn a case's hardening law into the Model's."""
    if isinstance(hardening, HotLaw):
        return hardening.to_model()
    return model.Hardening(law=hardening.law, parameters=np.array(hardening.parameters()))
