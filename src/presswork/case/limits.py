# SPDX-License-Identifier: Apache-2.0
"""Limits of a case, beyond which a run stops; names and defaults are those of model.Limits."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.part import Part
from presswork.case.units import Force, Number, Stress, fault

_LIMITS = model.Limits()


class Goal(Part):
    """A value of a column of history.csv at which the run is complete, before its stages are."""

    column: str = Field(description="name of the column, as die.fill, punch.force, die.flash_thickness, punch.stroke")
    above: Number | None = Field(default=None, description="the run ends where the column is at least this")
    below: Number | None = Field(default=None, description="the run ends where the column is at most this")

    @model_validator(mode="after")
    def _check_one(self) -> Self:
        if (self.above is None) == (self.below is None):
            raise fault("give either above or below", "for instance above = 0.98", key="above")
        return self


class Limits(Part):
    """Limits beyond which a state is no longer physics; a run stops there, with all that it has computed."""

    stop: bool = Field(
        default=_LIMITS.stop, description="false: the run goes on beyond its limits but mean_pressure, and warns"
    )
    penetration: Number = Field(
        default=_LIMITS.penetration,
        gt=0,
        description="depth of a tool or another body in an edge of a solid, over the edge's first length; in the "
        "surface of a sheet, over its thickness",
    )
    thinning: Number = Field(
        default=_LIMITS.thinning,
        gt=0,
        lt=1,
        description="largest loss of thickness of a sheet, over its first thickness",
    )
    hydrostatic_stress: Number = Field(
        default=_LIMITS.hydrostatic_stress,
        gt=0,
        description="largest hydrostatic stress of solids, positive or negative, over the flow stress there",
    )
    mean_pressure: Number = Field(
        default=_LIMITS.mean_pressure,
        gt=0,
        description="mean pressure in a solid between tools, over its mean flow stress: beyond it the metal has no way "
        "out. It stops a run even where stop = false",
    )
    force: Force | None = Field(
        default=_LIMITS.force,
        gt=0,
        description="largest force that the press gives to a tool [N]; the run goes on beyond it, and its result fails",
    )
    contact_pressure: Stress | None = Field(
        default=_LIMITS.contact_pressure,
        gt=0,
        description="largest contact pressure that the tools bear, about the yield stress of their steel [MPa]; the "
        "run goes on beyond it, and its result fails",
    )

    end: tuple[Goal, ...] = Field(
        default=(), description="values of columns of history.csv at which the run is complete: die full, force, gap"
    )

    def build(self) -> model.Limits:
        """Return the Model's limits."""
        return model.Limits(**self.model_dump() | {"end": tuple(model.Goal(**goal.model_dump()) for goal in self.end)})
