# SPDX-License-Identifier: Apache-2.0
"""The keys of a solid's case for the explicit procedure alone: its steps through time."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from presswork import model
from presswork.case.part import Part
from presswork.case.units import Number, Rate, Time

_EXPLICIT = model.ExplicitSolid()


class ExplicitSolver(Part):
    """How the explicit procedure computes solids and steps through time."""

    target_step: Time | None = Field(
        default=None,
        gt=0,
        description="time step to reach by adding mass to cells that need a shorter one [s]; without it: no mass is "
        "added. It is for slow forming: in an impact inertia is what forms the part",
    )
    safety: Number = Field(
        default=_EXPLICIT.safety,
        gt=0,
        le=0.9,
        description="time step over its stable bound; lower it where the energy balance is off",
    )
    damping: Rate = Field(
        default=_EXPLICIT.damping, ge=0, description="damping in proportion to the mass [1/s]; 0: none"
    )
    hourglass_stiffness: Number = Field(
        default=_EXPLICIT.hourglass_stiffness,
        ge=0,
        le=1,
        description="quad4_1pt and hex8_1pt: fraction of the shear modulus",
    )
    device: Literal["cpu", "host", "cuda"] = Field(
        default=_EXPLICIT.device,
        description="solids in space: what computes the cycles, the CPU, an NVIDIA card, or the card's code on the CPU "
        "(host, slow, to check it); `presswork devices` lists what is there",
    )
