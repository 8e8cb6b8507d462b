# SPDX-License-Identifier: Apache-2.0
"""How the surface of a tool of solids wears."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.quantities import HardnessTable
from presswork.case.part import Part
from presswork.case.units import Length, Number, fault

LARGEST_ARCHARD = 0.1
"""Archard's coefficient of unlubricated soft metals on each other is 0.01; a die with a tenth would last a part."""
SOFTEST, HARDEST = 100.0, 40000.0
"""Hardness of no tool [MPa]: of lead's order, and of diamond's."""


class Wear(Part):
    """Wear: depth = coefficient times the integral of pressure^a / hardness^c over the path slid (Archard)."""

    coefficient: Number = Field(
        gt=0, description="Archard's coefficient, a pure number; other powers: in the powers of MPa that make it so"
    )
    hardness: HardnessTable = Field(
        description='hardness of the tool\'s surface [MPa], e.g. "560 HV", or rows [temperature, hardness], which need '
        "[heat]"
    )
    pressure_power: Number = Field(default=1.0, gt=0, le=4, description="power a of the contact pressure")
    hardness_power: Number = Field(default=1.0, ge=0, le=4, description="power c of the hardness; DEFORM has 2")
    parts: int = Field(default=1, ge=1, le=10**9, description="number of parts whose wear is reported")
    limit: Length | None = Field(
        default=None, gt=0, description="depth that the tool may lose [mm]; the number of parts until then is reported"
    )

    @model_validator(mode="after")
    def _check_slips(self) -> Self:
        is_archard = self.pressure_power == 1.0 and self.hardness_power == 1.0
        if is_archard and self.coefficient > LARGEST_ARCHARD:
            text = f"Archard's coefficient of {self.coefficient:g} wears a die out in a part"
            raise fault(text, "hot forging dies have 1e-5 to 1e-3, write for instance 1e-4", key="coefficient")
        for _, hardness in self.hardness:
            if not SOFTEST <= hardness <= HARDEST:
                remedy = 'plain numbers are MPa; write for instance "560 HV"; 52 HRC are about 540 HV'
                raise fault(f"{hardness:g} MPa is the hardness of no tool", remedy, key="hardness")
        return self

    def build(self) -> model.ToolWear:
        """Return the Model's."""
        return model.ToolWear(**self.model_dump())


class _Worn(Protocol):
    @property
    def wear(self) -> Wear | None: ...

    @property
    def heat(self) -> object: ...


class _Motion(Protocol):
    @property
    def turn(self) -> float: ...


class _Stage(Protocol):
    @property
    def tools(self) -> Mapping[str, _Motion]: ...


def list_wear_problems(tools: Mapping[str, _Worn], stages: Sequence[_Stage], *, heated: bool) -> Iterator[Problem]:
    """Yield the problems of tools that wear: no temperature for their hardness, or a motion that is not followed."""
    for name, tool in tools.items():
        if tool.wear is None:
            continue
        if len(tool.wear.hardness) > 1 and not (heated and tool.heat is not None):
            remedy = f"give [heat] and [tools.{name}.heat], or one hardness"
            yield Problem(f"tools.{name}.wear.hardness", "hardness by temperature, and no temperature is known", remedy)
        if any(name in stage.tools and stage.tools[name].turn for stage in stages):
            text = "the wear of tools that turn is not followed"
            yield Problem(f"tools.{name}.wear", text, "remove it; a tool that does not turn may have it")
