# SPDX-License-Identifier: Apache-2.0
"""Pressure of fluids on a face of the sheet of a stamping, and how it goes over a stage. Units as in schema.py."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork.case.part import Part
from presswork.case.stamping.plan_line import PlanLine
from presswork.case.units import Length, Rate, Stress, Time, Volume, fault
from presswork.model import Face

Line = Annotated[PlanLine, Field(discriminator="shape")]
COURSES = ("p", "p_over_stroke", "p_over_time", "rate", "inflow", "inflow_over_stroke", "inflow_over_time")
"""Keys of a stage's pressure, of which it takes one."""
HIGHEST = 1500.0
"""Pressure [MPa] above any that presses for fluids give: 400 are common, 1000 the most."""


class Fluid(Part):
    """A fluid in a closed space that the sheet bounds; its pressure is found: K ln(volume of the fluid over space)."""

    stiffness: Stress = Field(
        gt=0, description='K, its bulk modulus, with what the machine gives: water "2.2 GPa", oil "1.5 GPa" [MPa]'
    )
    room: Volume = Field(gt=0, description="volume of its space before the sheet has moved, of the whole part [mm^3]")


class SheetPressure(Part):
    """A pressure that pushes a face of the sheet along its normals as they are now, where its line bounds it."""

    face: Face = Field(
        description="face of the sheet that it pushes: top down, as punch and holder do, bottom up, as the die does; "
        "of a tube, or a vessel from a file, inside or outside; no tool may lie on that face there"
    )
    inside: Line | None = Field(
        default=None,
        description="line on the undeformed blank inside which it acts; the shells whose middle lies there keep it as "
        "they move. Without it and without outside: on the whole sheet",
    )
    outside: Line | None = Field(default=None, description="instead: line outside which it acts")
    fluid: Fluid | None = Field(
        default=None,
        description="fluid whose pressure follows from what flows in (inflow of the stages), so that a run goes past a "
        "maximum of the pressure; without it stages give the pressure",
    )

    seal: Literal["tools"] | None = Field(
        default=None,
        description="tools: it goes on beyond its line, as counter pressure does, up to the first closed ring of "
        "shells that tools press on this face with at least its own pressure; where none does, it leaks over the rim "
        "(implicit). Without it: it stays on its shells",
    )

    @model_validator(mode="after")
    def _check_seal(self) -> Self:
        if self.seal is None:
            return self
        if self.fluid is not None:
            raise fault("a fluid with a volume is taken to be tight", "leave seal or fluid out", key="seal")
        if self.inside is None and self.outside is None:
            remedy = "give inside, a line within the opening of the die"
            raise fault("missing key: a fluid that tools seal begins somewhere", remedy, key="inside")
        return self

    @model_validator(mode="after")
    def _check_one_line(self) -> Self:
        if self.inside is not None and self.outside is not None:
            raise fault("inside and outside are both given", "give one of them", key="outside")
        return self


class HeldRate(Part):
    """A strain rate of the sheet at which the pressure is held, as in superplastic forming."""

    target: Rate = Field(
        gt=0, description="equivalent strain rate of the middle surface, within the window of the law [1/s]"
    )
    of: Literal["greatest", "mean"] = Field(
        default="greatest",
        description="greatest: of the shell under the pressure that is strained fastest; mean: over the pressed area",
    )
    least: Stress = Field(
        gt=0, description="pressure that the stage begins with, and below which it does not fall [MPa]"
    )
    most: Stress = Field(
        gt=0, description="pressure that it does not exceed; it is reached once the sheet lies on its tools [MPa]"
    )

    @model_validator(mode="after")
    def _check_limits(self) -> Self:
        if not self.least < self.most:
            raise fault(f"not above least = {self.least:g} MPa", "give the smaller pressure as least", key="most")
        if self.most > HIGHEST:
            fault_of = f"no press gives so much: expected at most {HIGHEST:g} MPa"
            raise fault(fault_of, 'plain numbers are MPa; for instance 2, or "20 bar"', key="most")
        return self


class StagePressure(Part):
    """How a pressure on the sheet goes over a stage; where a stage does not name it, it stays as it is."""

    p: Stress | None = Field(
        default=None,
        ge=0,
        description="pressure at the end of the stage [MPa], to which it goes in proportion to its travel",
    )
    p_over_stroke: tuple[tuple[Length, Stress], ...] | None = Field(
        default=None,
        description="instead: rows [stroke of what moves farthest in this stage, pressure], linear between them [mm, "
        "MPa]",
    )
    p_over_time: tuple[tuple[Time, Stress], ...] | None = Field(
        default=None, description="instead: rows [time since the stage began, pressure], linear between them [s, MPa]"
    )
    rate: HeldRate | None = Field(
        default=None,
        description="instead: a strain rate at which the pressure is held; the run finds the pressure (implicit)",
    )
    inflow: Volume | None = Field(
        default=None,
        description="of a fluid: volume that flows in evenly over the stage, of the whole part; negative: out [mm^3]",
    )
    inflow_over_stroke: tuple[tuple[Length, Volume], ...] | None = Field(
        default=None,
        description="instead: rows [stroke of what moves farthest in this stage, volume since it began] [mm, mm^3]",
    )
    inflow_over_time: tuple[tuple[Time, Volume], ...] | None = Field(
        default=None, description="instead: rows [time since the stage began, volume since then] [s, mm^3]"
    )

    @model_validator(mode="after")
    def _check_one_course(self) -> Self:
        present = [key for key in COURSES if getattr(self, key) is not None]
        if not present:
            remedy = 'for instance p = "8 MPa", of a fluid inflow = "20 cm^3", or leave the table out'
            raise fault("neither pressure nor inflow is given", remedy, key="p")
        if len(present) > 1:
            raise fault(f"{present[0]} and {present[1]} are both given", f"leave {present[1]} out", key=present[1])
        if present[0] not in ("p", "rate", "inflow"):
            _check_rows(getattr(self, present[0]), present[0])
        rows = ((0.0, self.p),) if self.p is not None else self.p_over_stroke or self.p_over_time or ()
        if max((value for _, value in rows), default=0.0) > HIGHEST:
            fault_of = f"no press gives so much: expected at most {HIGHEST:g} MPa"
            raise fault(fault_of, 'plain numbers are MPa; for instance 6, or "60 bar"', key=present[0])
        return self

    @property
    def course(self) -> str:
        """The key that gives its course."""
        return next(key for key in COURSES if getattr(self, key) is not None)


def _check_rows(rows: Sequence[tuple[float, float]], key: str) -> None:
    """Raise where rows are no table of pressures."""
    what = "strokes" if key.endswith("stroke") else "times"
    if not rows:
        raise fault("the table is empty", "give two rows at least", key=key)
    if rows[0][0] < 0 or any(later[0] <= row[0] for row, later in itertools.pairwise(rows)):
        raise fault(f"the {what} of the table do not increase from 0 on", "sort its rows", key=key)
    if key.startswith("p") and min(value for _, value in rows) < 0:
        raise fault("expected pressures >= 0", "a fluid pushes; take the other face of the sheet", key=key)
