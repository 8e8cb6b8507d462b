# SPDX-License-Identifier: Apache-2.0
"""Parts formed one after another between the same tools, which stay as warm as the part before has left them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from presswork import model
from presswork.case.part import Part
from presswork.case.settings import Whole
from presswork.case.units import Time

if TYPE_CHECKING:
    pass


class Series(Part):
    """How many parts are formed one after another, each by all stages from a fresh workpiece."""

    parts: Whole = Field(ge=2, le=1000, description="number of parts")
    pause: Time = Field(
        default=0.0, ge=0, description="time between parts in which the tools lie open without a workpiece [s]"
    )

    def to_model(self) -> model.Series:
        """Return the Model's."""
        return model.Series(self.parts, self.pause)
