# SPDX-License-Identifier: Apache-2.0
"""The section of a drawbead, from which its forces are found. Units as in schema.py."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from presswork.case.part import Part
from presswork.case.units import Length, Number, fault


class BeadGeometry(Part):
    """A round bead and its groove."""

    bead_radius: Length = Field(gt=0, description="radius of the bead, which is half as wide as it is [mm]")
    groove_radius: Length = Field(gt=0, description="radius of the groove's two shoulders [mm]")
    depth: Length = Field(gt=0, description="how far the bead has pressed the sheet into the groove [mm]")
    groove_width: Length | None = Field(
        default=None,
        gt=0,
        description="width of the groove [mm]; without it the bead's and 2.6 thicknesses",
    )
    gap: Length | None = Field(
        default=None, gt=0, description="gap between die and holder beside the bead [mm]; without it 1.15 thicknesses"
    )
    mu: Number = Field(default=0.1, ge=0, le=1, description="Coulomb coefficient of friction in the bead")

    @model_validator(mode="after")
    def _check_width(self) -> Self:
        if self.groove_width is not None and self.groove_width <= 2.0 * self.bead_radius:
            raise fault(
                "the bead does not go into its groove", f"more than {2.0 * self.bead_radius:g} mm", key="groove_width"
            )
        return self

    def find_groove_width(self, thickness: float) -> float:
        """Return the groove's width with a sheet of a thickness in it [mm]."""
        return self.groove_width or 2.0 * self.bead_radius + 2.6 * thickness
