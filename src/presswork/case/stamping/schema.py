# SPDX-License-Identifier: Apache-2.0
"""The case of a stamping: a blank, tools in space, and what the tools do. Units as in schema.py."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic.config import JsonDict

from presswork.case.case_file import CaseFile
from presswork.case.gradients import Gradients
from presswork.case.gravity import DESCRIPTION as GRAVITY
from presswork.case.gravity import Gravity3
from presswork.case.heat.thermal import Thermal
from presswork.case.limits import Limits
from presswork.case.marked_points import DESCRIPTION as POINTS
from presswork.case.material.library import add_library_materials
from presswork.case.material.transformation import Transformation
from presswork.case.material.umat import UmatMaterial, kind_of_material
from presswork.case.names import Name, Title
from presswork.case.part import Part
from presswork.case.press.schema import Press
from presswork.case.settings import IncrementTolerance
from presswork.case.shell.material import HeavyShellMaterial
from presswork.case.shell.schema import ShellBoundary
from presswork.case.stamping.blank import Blank
from presswork.case.stamping.heat import StampingHeat
from presswork.case.stamping.operation import Operation
from presswork.case.stamping.plan_line import Trim
from presswork.case.stamping.pressure import SheetPressure
from presswork.case.stamping.springback import Springback
from presswork.case.stamping.stage import Hem, StampingBead, StampingStage, Whole
from presswork.case.stamping.tools import Tool
from presswork.case.units import Angle, Number, Point3, Rate, Time, fault
from presswork.model import ExplicitElement, ExplicitSheet, SolverSettings

_EXPLICIT = ExplicitSheet()
_SOLVER = SolverSettings()


OWN = ("tools", "beads", "boundary", "stages", "trim", "springback", "hem")
"""Keys that every operation of a line has of its own."""
OWN_TEXT = "operations.N." + ", operations.N.".join(OWN)


class StampingMaterial(HeavyShellMaterial):
    """A sheet material that has a density in every case."""

    thermal: Thermal | None = Field(default=None, description="thermal properties, needed with [heat]")
    transformation: Transformation | None = Field(
        default=None, description="what its austenite becomes on cooling, with [heat]"
    )

    @model_validator(mode="after")
    def _check_young(self) -> Self:
        if self.density is None and not self.is_metal():
            text = f"missing key: no metal's density goes with a Young's modulus of {self.young:g} MPa"
            raise fault(text, 'add it, for instance "7850 kg/m^3"', key="density")
        return self


_TABLES: JsonDict = {"laws": "#/$defs/StampingMaterial", "umat": "#/$defs/UmatMaterial"}
StampingTable = Annotated[
    Annotated[StampingMaterial, Tag("laws")] | Annotated[UmatMaterial, Tag("umat")],
    Discriminator(kind_of_material),
    Field(json_schema_extra={"discriminator": {"mapping": _TABLES}}),
]


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
        "added. Kinetic energy, in the history, shows how much mass is safe",
    )
    safety: Number = Field(
        default=_EXPLICIT.safety,
        gt=0,
        le=1,
        description="time step over its stable bound; lower it where the energy balance is off",
    )
    step_bound: Literal["shells", "mesh"] = Field(
        default=_EXPLICIT.step_bound,
        description="bound of the step: that of the worst shell alone, or that of the mesh, which allows longer steps",
    )
    damping: Rate = Field(
        default=_EXPLICIT.damping, ge=0, description="damping in proportion to the mass [1/s]; 0: none"
    )
    precision: Literal["double", "single"] | None = Field(
        default=_EXPLICIT.precision,
        description="precision of shells and velocities; positions, contact and sums are always double. Without it: "
        "single where it is faster, for von Mises with isotropic hardening alone, else double",
    )
    device: Literal["cpu", "host", "cuda"] = Field(
        default=_EXPLICIT.device,
        description="what computes the cycles: the CPU, an NVIDIA card, or the card's code on the CPU (host, slow, to "
        "check it); `presswork devices` lists what is there",
    )
    contact_points: Literal["nodes", "edges"] = Field(
        default=_EXPLICIT.contact_points,
        description="what of the blank touches tools: nodes alone, or edges between them, too, where a tool's "
        "radius is less than their mean length",
    )
    ironing: bool = Field(
        default=_EXPLICIT.ironing,
        description="whether two tools that leave the sheet less room than it is thick squeeze it thinner (the "
        "pressure is stress through the thickness); without it they sink into the sheet",
    )


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
    increment_tolerance: IncrementTolerance = _SOLVER.increment_tolerance
    contact_stiffness: Number = Field(
        default=_SOLVER.contact_stiffness,
        gt=0,
        le=1,
        description="stiffness of contact with the tools over that of the sheet across its thickness; the sheet sinks "
        "in by pressure thickness/(contact_stiffness E)",
    )

    inertia: Number = Field(
        default=_SOLVER.inertia,
        ge=0,
        description="mass over the sheet's, in the time of the stages: steadies what nothing holds and what snaps",
    )
    damping: Rate = Field(default=_SOLVER.damping, ge=0, description="damping in proportion to this mass [1/s]")

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


class SelfContact(Part):
    """Contact of the sheet with itself, where a flange is hemmed or a wall folds: both faces, with their thickness."""

    mu: Number = Field(default=0.1, ge=0, lt=1, description="coefficient of friction of the sheet on itself")


class StampingOutput(Part):
    """What is saved, and when."""

    steps: Whole = Field(default=10, description="saved steps of each stage")
    rows: Whole = Field(
        default=200, description="explicit: rows of history.csv for each stage; implicit: one an increment"
    )
    checkpoint_every: Whole = Field(default=50, description="rows between checkpoints")
    dynain: bool = Field(
        default=False,
        description="whether the part is written as part.dynain at the end of each operation, with its stresses and "
        "strains, as other programs and blank.path take it",
    )

    @model_validator(mode="after")
    def _check_steps(self) -> Self:
        if self.steps > self.rows:
            raise fault(f"expected no more than rows = {self.rows}", "a step is saved where a row is", key="steps")
        return self


class StampingCase(CaseFile):
    """A complete case of a stamping. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line; it is the title of pictures")
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
    pressure: dict[Name, SheetPressure] = Field(
        default={}, description="pressures of fluids on the sheet, by name; stages set their values"
    )
    boundary: dict[Name, ShellBoundary] = Field(
        default={}, description="what holds the blank beside the tools, by name"
    )
    gravity: Gravity3 | None = Field(default=None, description=GRAVITY)
    stages: tuple[StampingStage, ...] = Field(default=(), description="the process, stage by stage")
    explicit: Explicit = Field(default=Explicit(), description="how the explicit procedure steps through time")
    trim: dict[Name, Trim] = Field(
        default={}, description="lines that the part is cut along after the last stage, by name, one after the other"
    )
    springback: Springback | None = Field(
        default=None,
        description="an empty table releases the part after the last stage and the trimming, by the implicit procedure",
    )
    hem: Hem | None = Field(default=None, description="the hem that the summary measures at the end")
    operations: tuple[Operation, ...] = Field(
        default=(),
        description="instead of tools, beads, boundary, stages, trim and springback: operations with their own, one "
        "after another",
    )
    self_contact: SelfContact | None = Field(
        default=None,
        description="contact of the sheet with itself, as a hem needs it; an empty table "
        "takes the defaults; without it: the sheet passes through itself",
    )
    implicit: Implicit = Field(default=Implicit(), description="how the implicit procedure goes and iterates")
    output: StampingOutput = Field(default=StampingOutput(), description="what is saved, and when")
    heat: StampingHeat | None = Field(
        default=None, description="heat of the blank, its tools and surroundings; without it: no heat is conducted"
    )
    gradients: Gradients | None = Field(
        default=None,
        description="derivatives of the history by numbers of the case, found in the run itself (implicit)",
    )
    points: dict[Name, Point3] = Field(default={}, description=POINTS)
    draw_in: dict[Name, Angle] = Field(
        default={},
        description="directions by name, as angles from x [degree]: the history has how far the edge has come in there",
    )
    one_step_thinning: Number | None = Field(
        default=None,
        ge=0,
        lt=100,
        description="largest thinning that one step has estimated of the part, which `onestep --write-case` writes; "
        "summary and page show it beside the stamping's [%]",
    )
    limits: Limits = Field(
        default=Limits(), description="limits beyond which a run stops, since its result would no longer be physics"
    )

    @model_validator(mode="before")
    @classmethod
    def _prepare(cls, data: Any) -> Any:
        return add_library_materials(data, "blank") if isinstance(data, dict) else data

    def check_together(self) -> None:
        """Raise where the process is given twice, or not at all."""
        if not self.operations:
            if not self.stages:
                raise fault("expected at least one stage", "add [[stages]], or [[operations]] of a line", key="stages")
            return
        if self.pressure:
            fault_text = "pressure is not carried from one operation to the next"
            raise fault(fault_text, "compute the operation under pressure as a case of its own", key="pressure")
        twice = [key for key in OWN if key in self.model_fields_set]
        if twice:
            raise fault("every operation has its own", f"move it into one of [[operations]]: {OWN_TEXT}", key=twice[0])

    @property
    def irons(self) -> bool:
        """Whether tools squeeze the sheet thinner where they leave it less room than it is thick."""
        return self.procedure == "explicit" and self.explicit.ironing
