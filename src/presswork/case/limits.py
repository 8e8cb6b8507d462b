# SPDX-License-Identifier: Apache-2.0
"""Limits of a case, beyond which a run stops; names and defaults are those of model.Limits."""

from __future__ import annotations

from pydantic import Field

from presswork import model
from presswork.case.part import Part
from presswork.case.units import Force, Number, Stress

_LIMITS = model.Limits()


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

    def build(self) -> model.Limits:
        """Return the Model's limits."""
        return model.Limits(**self.model_dump())
