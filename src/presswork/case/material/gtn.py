# SPDX-License-Identifier: Apache-2.0
"""A metal with pores in a case: Gurson, Tvergaard and Needleman's law with an internal length."""

from __future__ import annotations

from dataclasses import replace
from typing import Self

from pydantic import Field, model_validator

from presswork import _core, model
from presswork.case.part import Part
from presswork.case.units import Length, Number, fault

PARAMETERS = 6
"""Number of parameters of a hardening law that the compiled law has room for (cpp/material/gtn.hpp)."""


class Gtn(Part):
    """Pores that grow, nucleate and coalesce, and soften the metal."""

    porosity: Number = Field(ge=0, lt=0.5, description="volume share of pores at the start, e.g. 0.002")
    length: Length = Field(
        gt=0, description="radius over which the growth of pores is averaged [mm], at least two cells"
    )
    q1: Number = Field(default=1.5, gt=0, description="Tvergaard's q1")
    q2: Number = Field(default=1.0, gt=0, description="Tvergaard's q2")
    q3: Number | None = Field(default=None, gt=0, description="Tvergaard's q3; without it q1 squared")
    coalescence: Number | None = Field(
        default=None, gt=0, lt=1, description="porosity at which pores coalesce, e.g. 0.15"
    )
    failure: Number | None = Field(
        default=None, gt=0, lt=1, description="porosity at which the metal bears nothing, e.g. 0.25"
    )
    nucleation_strain: Number | None = Field(
        default=None, gt=0, description="mean strain at which pores nucleate, e.g. 0.3"
    )
    nucleation_deviation: Number | None = Field(
        default=None, gt=0, description="standard deviation of the strain of nucleation, e.g. 0.1"
    )
    nucleated: Number | None = Field(
        default=None, gt=0, lt=0.5, description="volume share of all pores that may nucleate, e.g. 0.04"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        for group in (("coalescence", "failure"), ("nucleation_strain", "nucleation_deviation", "nucleated")):
            present = [name for name in group if getattr(self, name) is not None]
            missing = [name for name in group if name not in present]
            if present and missing:
                raise fault("missing key", f"give {', '.join(group)} together, or none", key=missing[0])
        if self.coalescence is not None and self.failure is not None:
            if not self.coalescence < min(self.failure, 1.0 / self.q1):
                raise fault("expected a porosity below failure and 1/q1", "e.g. 0.15 and 0.25", key="coalescence")
            if self.porosity >= self.coalescence:
                raise fault("not below coalescence", "pores would coalesce from the start", key="porosity")
        return self

    def apply(self, material: model.Material) -> model.Material:
        """Return a material whose metal between the pores is the given one."""
        assert material.hardening is not None
        q3 = self.q1**2 if self.q3 is None else self.q3
        ends = (1.0, 2.0) if self.coalescence is None or self.failure is None else (self.coalescence, self.failure)
        nucleation = (self.nucleation_strain or 0.0, self.nucleation_deviation or 0.0, self.nucleated or 0.0)
        law = list(_core.HardeningLaw.__members__).index(material.hardening.law)
        matrix = [float(value) for value in material.hardening.parameters]
        props = [material.young, material.poisson, self.q1, self.q2, q3, *ends, *nucleation, float(law), *matrix]
        props += [0.0] * (PARAMETERS - len(matrix))
        h = material.heating
        props += [0.0, 0.0, 0.0] if h is None or h.melting is None else [h.reference, h.melting, h.exponent]
        gtn = model.Gtn(
            initial=self.porosity,
            length=self.length,
            q1=self.q1,
            q2=self.q2,
            q3=q3,
            coalescence=ends[0],
            failure=ends[1],
            nucleation_strain=nucleation[0],
            nucleation_deviation=nucleation[1],
            nucleated=nucleation[2],
        )
        umat = model.Umat(model.GTN, tuple(props), 3, thread_safe=True, plastic_strain=1)
        return replace(material, hardening=None, umat=umat, gtn=gtn)
