# SPDX-License-Identifier: Apache-2.0
"""The case of a stamping: a blank, tools in space, and what the tools do. Units as in schema.py."""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic.config import JsonDict

from presswork import model
from presswork.case.case_file import CaseFile
from presswork.case.heat.thermal import Thermal
from presswork.case.limits import Limits
from presswork.case.marked_points import DESCRIPTION as POINTS
from presswork.case.material.library import add_library_materials
from presswork.case.material.transformation import Transformation
from presswork.case.material.umat import UmatMaterial, kind_of_material
from presswork.case.names import Name, Title
from presswork.case.part import Part
from presswork.case.press.builder import Timing
from presswork.case.press.schema import Press, StagePress
from presswork.case.shell.material import HeavyShellMaterial
from presswork.case.shell.schema import ShellBoundary, ShellDisplacement
from presswork.case.stamping.bead import Bead
from presswork.case.stamping.blank import Blank
from presswork.case.stamping.heat import Dwell, StampingHeat
from presswork.case.stamping.plan_line import CircularLine, LineFile, PolygonLine, RectangularLine
from presswork.case.stamping.tools import Tool
from presswork.case.units import Force, Length, LineForce, Number, Point3, Rate, Time, Velocity, fault
from presswork.model import ExplicitElement, ExplicitSheet, SolverSettings

VELOCITY = 2000.0
"""Of what moves farthest where a stage says nothing [mm/s]."""

_EXPLICIT = ExplicitSheet()
_SPRINGBACK = model.Springback()
_SOLVER = SolverSettings()
Whole = Annotated[int, Field(strict=True, ge=1)]


class StampingMaterial(HeavyShellMaterial):
    """A sheet material that has a density in every case."""

    thermal: Thermal | None = Field(default=None, description="what it conducts and stores, with [heat]")
    transformation: Transformation | None = Field(
        default=None, description="what its austenite becomes on cooling, with [heat]"
    )

    @model_validator(mode="after")
    def _check_young(self) -> Self:
        if not self.is_metal():
            raise fault("Young's modulus of no metal", 'plain numbers are MPa: "210 GPa" is 210e3', key="young")
        return self


_TABLES: JsonDict = {"laws": "#/$defs/StampingMaterial", "umat": "#/$defs/UmatMaterial"}
StampingTable = Annotated[
    Annotated[StampingMaterial, Tag("laws")] | Annotated[UmatMaterial, Tag("umat")],
    Discriminator(kind_of_material),
    Field(json_schema_extra={"discriminator": {"mapping": _TABLES}}),
]
ForceRow = tuple[Length, Force]


class ToolAction(Part):
    """What a tool does in a stage."""

    stroke: Length | None = Field(
        default=None, description="moves so far: punch and holder down, die up; negative: back [mm]"
    )
    force: Force | tuple[ForceRow, ...] | None = Field(
        default=None,
        description="instead: pushes with this force on the whole part [N], or a table of rows [stroke of the punch in "
        "this stage, force]",
    )

    @model_validator(mode="after")
    def _check_one_action(self) -> Self:
        if (self.stroke is None) == (self.force is None):
            raise fault("give either stroke or force", "for instance stroke = 25", key="stroke")
        rows = self.force if isinstance(self.force, tuple) else ((0.0, self.force or 0.0),)
        if not rows or min(force for _, force in rows) < 0:
            raise fault("expected forces >= 0", "a tool pushes, it does not pull", key="force")
        if any(later[0] <= row[0] for row, later in itertools.pairwise(rows)):
            raise fault("the strokes of the table do not increase", "sort its rows", key="force")
        return self


class StampingStage(Part):
    """A part of the process; all that moves starts and stops smoothly with it."""

    name: Name = Field(description="name of the stage")
    tools: dict[str, ToolAction] = Field(default={}, description="what each tool does; one not named stands still")
    displacement: tuple[ShellDisplacement, ...] = Field(default=(), description="prescribed displacements of the blank")
    velocity: Velocity | None = Field(
        default=None,
        gt=0,
        description="largest velocity of what moves farthest [mm/s]; without it and without duration: 2 m/s, a hundred "
        "times a press's, at which inertia is still small (see the energies)",
    )
    duration: Time | None = Field(default=None, gt=0, description="instead of velocity: how long the stage takes [s]")
    press: StagePress | None = Field(
        default=None, description="instead of velocity: the press that moves the tools, one of [presses]"
    )
    ramp: Time | None = Field(
        default=None, gt=0, description="time of the smooth start and of the smooth end [s]; without it: a tenth"
    )
    process_time: Time | None = Field(
        default=None,
        gt=0,
        description="how long the stage takes in the press [s], by which heat flows and strain rates are taken, "
        "while explicit dynamics drives the tools faster; without it: as long as it is computed",
    )
    dwell: Dwell | None = Field(default=None, description="nothing moves, and heat alone flows")

    @model_validator(mode="after")
    def _check_one_way_of_timing(self) -> Self:
        if self.velocity is not None and self.duration is not None:
            raise fault("velocity and duration both time the stage", "give one of them", key="duration")
        if self.press is not None and self.ramp is not None:
            raise fault("a press neither starts nor stops smoothly", "leave it out", key="ramp")
        if self.press is not None and self.process_time is not None:
            raise fault("the press gives the time", "leave it out", key="process_time")
        return self

    def find_timing(self, number: int) -> Timing:
        """Return what this stage, with its number from 0, says of its press."""
        has_time = self.duration is not None or self.velocity is not None
        way = max((abs(action.stroke) for action in self.tools.values() if action.stroke), default=0.0)
        return Timing(f"stages.{number}", None, self.press, has_time, way)


class StampingBead(Bead):
    """A drawbead between die and holder."""

    closing_force: LineForce = Field(
        default=0.0,
        ge=0,
        description="what closing it takes per length [N/mm]: so much of the holder's force does not press the sheet",
    )
    stages: tuple[str, ...] | None = Field(
        default=None,
        min_length=1,
        description="names of the stages in which die and holder are closed on it; without it: those in which no "
        "stroke moves the holder to or from the die",
    )


class Explicit(Part):
    """How the explicit procedure computes shells and steps through time."""

    element: ExplicitElement = Field(
        default=_EXPLICIT.element,
        description="shells of the blank: one point in their plane, or fully integrated at about three times the cost",
    )
    target_step: Time | None = Field(
        default=None,
        gt=0,
        description="time step to reach by adding mass to elements that need a shorter one [s]; without it: no mass is "
        "added. Kinetic energy, in the history, says how far one may go",
    )
    safety: Number = Field(default=_EXPLICIT.safety, gt=0, le=1, description="time step over its stable bound")
    damping: Rate = Field(default=_EXPLICIT.damping, ge=0, description="mass damping [1/s]")
    precision: Literal["double", "single"] = Field(
        default=_EXPLICIT.precision, description="single: about half the time and memory, seven digits"
    )
    contact_points: Literal["nodes", "edges"] = Field(
        default=_EXPLICIT.contact_points,
        description="what of the blank touches tools: nodes alone, or edges between them, too, where a tool's "
        "radius is less than the longest edge",
    )
    ironing: bool = Field(
        default=_EXPLICIT.ironing,
        description="whether two tools that leave the sheet less room than it is thick squeeze it thinner (the "
        "pressure is stress through the thickness); without it they sink into the sheet",
    )


class Springback(Part):
    """The formed part is released after the last stage: tools and boundaries away, symmetry planes kept."""

    increments: Whole = Field(default=_SPRINGBACK.increments, description="in which the tools' forces are taken away")


class _Trim(Part):
    """A line that the formed part is cut along after the last stage, seen along z."""

    keep: Literal["inside", "outside"] = Field(
        default="inside", description="which side of the line stays: inside; or outside, which cuts a hole"
    )


class RectangularTrim(_Trim, RectangularLine):
    """A rectangle with sides along x and y."""


class CircularTrim(_Trim, CircularLine):
    """A circle."""


class PolygonTrim(_Trim, PolygonLine):
    """A polygon, whose corners may be rounded."""


class TrimFile(_Trim, LineFile):
    """A line from a file."""


Trim = Annotated[RectangularTrim | CircularTrim | PolygonTrim | TrimFile, Field(discriminator="shape")]


class Implicit(Part):
    """How the implicit procedure goes through a stage and iterates; increments are fractions of the stage."""

    initial_increment: Number = Field(default=0.001, gt=0, le=1, description="first increment")
    min_increment: Number = Field(default=1e-6, gt=0, le=1, description="smallest increment, below which it gives up")
    max_increment: Number = Field(default=0.02, gt=0, le=1, description="largest increment")
    max_iterations: Whole = Field(default=25, description="iterations before an increment is cut back")
    force_tolerance: Number = Field(
        default=_SOLVER.force_tolerance, gt=0, lt=1, description="largest out-of-balance over largest nodal force"
    )
    displacement_tolerance: Number = Field(
        default=_SOLVER.displacement_tolerance, gt=0, lt=1, description="largest correction over largest displacement"
    )
    contact_stiffness: Number = Field(
        default=_SOLVER.contact_stiffness,
        gt=0,
        le=1,
        description="of contact with the tools over that of the sheet across its thickness; the sheet sinks in by "
        "pressure thickness/(contact_stiffness E)",
    )

    inertia: Number = Field(
        default=_SOLVER.inertia,
        ge=0,
        description="mass over the sheet's, in the time of the stages: steadies what nothing holds and what snaps",
    )
    damping: Rate = Field(default=_SOLVER.damping, ge=0, description="of this mass [1/s]")

    @model_validator(mode="after")
    def _check_increments(self) -> Self:
        if not self.min_increment <= self.initial_increment <= self.max_increment:
            bounds = f"min_increment ({self.min_increment:g}) and max_increment ({self.max_increment:g})"
            raise fault(f"not between {bounds}", "choose it between them", key="initial_increment")
        return self

    @model_validator(mode="after")
    def _check_damping(self) -> Self:
        if self.damping and not self.inertia:
            raise fault("damps a mass, but inertia is 0", "add inertia = 1, the sheet's own mass", key="damping")
        return self

    def build(self) -> SolverSettings:
        """Return the Model's settings; contact's tangent is not symmetric, and shells do without a line search."""
        return SolverSettings(**self.model_dump(), symmetric=False, line_search=False)


class StampingOutput(Part):
    """What is saved, and when."""

    steps: Whole = Field(default=10, description="saved steps of each stage")
    rows: Whole = Field(
        default=200, description="explicit: rows of history.csv for each stage; implicit: one an increment"
    )
    checkpoint_every: Whole = Field(default=50, description="rows between checkpoints")

    @model_validator(mode="after")
    def _check_steps(self) -> Self:
        if self.steps > self.rows:
            raise fault(f"expected no more than rows = {self.rows}", "a step is saved where a row is", key="steps")
        return self


class StampingCase(CaseFile):
    """A complete case of a stamping. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line")
    analysis: Literal["stamping"] = Field(description="stamping")
    procedure: Literal["explicit", "implicit"] = Field(
        default="explicit",
        description="explicit: dynamics in small steps of time; implicit: equilibrium after every increment",
    )
    blank: Blank = Field(description="the sheet that is formed")
    materials: dict[Name, StampingTable] = Field(default={}, description="materials by name")
    tools: dict[Name, Tool] = Field(default={}, description="rigid tools by name")
    presses: dict[Name, Press] = Field(default={}, description="presses that stages refer to, by name")
    beads: tuple[StampingBead, ...] = Field(default=(), description="drawbeads")
    boundary: dict[Name, ShellBoundary] = Field(
        default={}, description="what holds the blank beside the tools, by name"
    )
    stages: tuple[StampingStage, ...] = Field(min_length=1, description="the process, stage by stage")
    explicit: Explicit = Field(default=Explicit(), description="how the explicit procedure steps through time")
    trim: dict[Name, Trim] = Field(
        default={}, description="lines that the part is cut along after the last stage, by name, one after the other"
    )
    springback: Springback | None = Field(
        default=None,
        description="an empty table lets the part go after the last stage and the trimming, by the implicit procedure",
    )
    implicit: Implicit = Field(default=Implicit(), description="how the implicit procedure goes and iterates")
    output: StampingOutput = Field(default=StampingOutput(), description="what is saved, and when")
    heat: StampingHeat | None = Field(
        default=None, description="heat of the blank, its tools and surroundings; without it: no heat is conducted"
    )
    points: dict[Name, Point3] = Field(default={}, description=POINTS)
    limits: Limits = Field(default=Limits(), description="beyond which a run stops")

    @model_validator(mode="before")
    @classmethod
    def _prepare(cls, data: Any) -> Any:
        return add_library_materials(data, "blank") if isinstance(data, dict) else data

    @property
    def irons(self) -> bool:
        """Whether tools squeeze the sheet thinner where they leave it less room than it is thick."""
        return self.procedure == "explicit" and self.explicit.ironing
