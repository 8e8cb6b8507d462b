# SPDX-License-Identifier: Apache-2.0
"""Operations of a press line in a case: tools of their own, and how the part is laid in. Units as in schema.py."""

from __future__ import annotations

from math import radians
from typing import Literal

from pydantic import Field

from presswork import model
from presswork.case.names import Name
from presswork.case.part import Part
from presswork.case.shell.schema import ShellBoundary
from presswork.case.stamping.plan_line import Trim
from presswork.case.stamping.springback import Springback
from presswork.case.stamping.stage import Hem, StampingBead, StampingStage
from presswork.case.stamping.tools import Tool
from presswork.case.units import Angle, Point3


class Place(Part):
    """How the part is laid into an operation, from where the one before has left it: over, then turn, then move."""

    over: Literal["x", "y"] | None = Field(
        default=None, description="axis through the origin about which the part is turned over; without it: it is not"
    )
    turn: Angle = Field(default=0.0, description="angle about z, counter-clockwise seen from above [degree]")
    move: Point3 = Field(default=(0.0, 0.0, 0.0), description="vector by which the part is moved [mm], e.g. [0, 0, 20]")

    tip: bool = Field(
        default=False,
        description="whether it then sinks and tips, as a rigid body, until its weight rests on the dies; without it: "
        "the dies come up to it",
    )

    def build(self) -> model.PartPlace:
        """Return the Model's."""
        return model.PartPlace(self.over, radians(self.turn), self.move, self.tip)


class Operation(Part):
    """An operation of a press line: what stands at the top of a case of one operation, and how the part is laid in."""

    name: Name = Field(
        description="name of the operation, with which names of its tools and stages begin in the results"
    )
    place: Place | None = Field(
        default=None, description="how the part is laid in; without it: it stays where the operation before has left it"
    )
    tools: dict[Name, Tool] = Field(
        default={},
        description="rigid tools by name; after the first operation a tool without position moves on until "
        "it touches the part",
    )
    beads: tuple[StampingBead, ...] = Field(default=(), description="drawbeads")
    boundary: dict[Name, ShellBoundary] = Field(default={}, description="what holds the part beside the tools, by name")
    stages: tuple[StampingStage, ...] = Field(min_length=1, description="the operation, stage by stage")
    trim: dict[Name, Trim] = Field(default={}, description="lines that the part is cut along after the last stage")
    springback: Springback | None = Field(
        default=None, description="an empty table releases the part after the last stage and the trimming"
    )
    hem: Hem | None = Field(default=None, description="the hem that the summary measures at the end")
