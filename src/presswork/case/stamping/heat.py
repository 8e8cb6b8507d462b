# SPDX-License-Identifier: Apache-2.0
"""Heat of a stamping: the sheet, its tools and surroundings, stages of heat alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.heat.forming import FormingHeat
from presswork.case.part import Part
from presswork.case.units import Number, Stress, Time, fault

if TYPE_CHECKING:
    pass


class StampingHeat(FormingHeat):
    """Heat of the blank: in its plane, through its thickness, and exchanged with tools and surroundings."""

    levels: Annotated[int, Field(strict=True, ge=2, le=41)] = Field(
        default=5, description="number of temperatures through the thickness at every node"
    )
    tolerance: Number = Field(
        default=1.0, gt=0, description="error that a time step of heat may add at any point, as estimated [K]"
    )


class Dwell(Part):
    """A stage in which nothing moves and heat alone flows."""

    duration: Time = Field(gt=0, description="duration of the dwell [s]")
    place: Literal["air", "tools"] = Field(
        default="air",
        description="air: no tool is near, as between furnace and press; tools: between the closed tools, as the "
        "stage before has left them",
    )
    pressure: Stress | None = Field(
        default=None,
        ge=0,
        description="in tools: their pressure where they touch [MPa]; without it: that at the end of the stage before",
    )

    @model_validator(mode="after")
    def _check_pressure(self) -> Self:
        if self.pressure is not None and self.place == "air":
            raise fault("nothing presses in air", 'leave it out, or take place = "tools"', key="pressure")
        return self

    def to_model(self) -> model.Dwell:
        """Return the Model's."""
        return model.Dwell(self.place == "tools", self.pressure)
