# SPDX-License-Identifier: Apache-2.0
"""The case of a solid in x, y, z with supports, loads and rigid tools. Units as in case/units.py."""

from __future__ import annotations

import math
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.case_file import CaseFile
from presswork.case.gradients import Gradients
from presswork.case.gravity import DESCRIPTION as GRAVITY
from presswork.case.gravity import Gravity3
from presswork.case.heat.films import FormingConvection
from presswork.case.heat.forming import FormingHeat
from presswork.case.heat.quantities import Temperature
from presswork.case.held_stages import StagedBoundary
from presswork.case.limits import Limits
from presswork.case.marked_points import DESCRIPTION as POINTS
from presswork.case.material.library import add_library_materials
from presswork.case.names import FileName, Name, Title
from presswork.case.part import Part
from presswork.case.plane.contact import Contact
from presswork.case.plane.explicit import ExplicitSolver
from presswork.case.plane.schema import MaterialTable
from presswork.case.press.builder import Timing
from presswork.case.press.schema import Press, Speeds, StagePress, check_speeds
from presswork.case.settings import Output, Solver
from presswork.case.space.mesh import SpaceMesh
from presswork.case.space.remesh import SpaceRemesh
from presswork.case.space.tools import SpaceTool, SpaceToolMotion
from presswork.case.units import Force3, Length, Point3, Stress, StressVector3, Time, VelocityVector3, fault

Axis = Literal["x", "y", "z"]
AXES: tuple[Axis, ...] = ("x", "y", "z")


class SpaceWorkpiece(Part):
    """The body that is formed."""

    material: FileName = Field(
        description='name of one of the [materials], or of the library, or "my_steel.toml", a material file of your own'
    )
    element: model.SpaceElement = Field(
        default="hex8_fbar",
        description="element formulation; without it hex8_fbar, which does not lock in volume, and hex8_1pt where the "
        "procedure is explicit",
    )
    velocity: VelocityVector3 | None = Field(
        default=None, description="explicit: velocity [x, y, z] of the whole workpiece at the start [mm/s]"
    )
    initial_temperature: Temperature | None = Field(
        default=None, description="temperature at the start [degrees C]; without it that of [heat]"
    )
    mesh: SpaceMesh = Field(description="the mesh of the workpiece")


class SpaceBoundary(StagedBoundary):
    """Displacement components held at zero, or a face of a sector tied to the other."""

    set: str = Field(description="name of a node set")
    fix: tuple[Axis | Literal["normal"], ...] = Field(
        default=(),
        description="components held at zero, out of x, y and z; or normal alone: the direction normal to the plane "
        "that the set lies in, as the last_plane of a sector",
    )
    cyclic: str | None = Field(
        default=None,
        description="instead of fix: the set of nodes, as first_plane, that becomes this one when it is turned about z "
        "by an n-th of a whole turn; both move alike, as they do in a body whose n sectors are the same",
    )
    symmetry: bool | None = Field(
        default=None,
        description="whether this is a symmetry plane; without it: when it fixes one component only, on a flat side of "
        "the workpiece normal to that component",
    )

    @model_validator(mode="after")
    def _check_fix(self) -> Self:
        if bool(self.fix) == (self.cyclic is not None):
            remedy = 'for instance fix = ["z"], or cyclic = "first_plane"'
            raise fault("give either fix or cyclic", remedy, key="fix")
        if self.cyclic is not None and self.stages is not None:
            raise fault("the faces of a sector are tied in every stage", "leave it out", key="stages")
        if "normal" in self.fix and len(set(self.fix)) > 1:
            raise fault("normal is given with other components", 'give ["normal"] alone', key="fix")
        return self


class SpaceDisplacement(Part):
    """A displacement component that grows linearly over the stage."""

    set: str = Field(description="name of a node set")
    component: Axis = Field(description="x, y or z")
    value: Length = Field(description="displacement over the stage [mm]")


class SpaceForce(Part):
    """A total force, shared equally by the nodes of a set, reached linearly at the end of the stage.

    Equal shares are even stress on few meshes only: face_force is spread by area.
    """

    set: str = Field(description="name of a node set")
    value: Force3 = Field(description="force [x, y, z] [N]")


class FaceForce(Part):
    """A force of fixed direction on a face set, spread by undeformed area, reached linearly at the stage's end."""

    set: str = Field(description="name of a face set")
    value: StressVector3 | None = Field(default=None, description="force per undeformed area [x, y, z] [MPa]")
    total: Force3 | None = Field(default=None, description="instead of value: the whole force [x, y, z] [N]")

    @model_validator(mode="after")
    def _check_one_value(self) -> Self:
        if (self.value is None) == (self.total is None):
            remedy = "for instance value = [0, 0, 100] (MPa), or total = [0, 0, 5000] (N)"
            raise fault("give either value or total", remedy, key="value")
        return self


class FacePressure(Part):
    """A pressure that follows the surface, reached linearly at the end of the stage."""

    set: str = Field(description="name of a face set")
    value: Stress = Field(description="pressure [MPa], positive into the body")


class SpaceStage(Part):
    """A part of the process in which every motion and load is linear in time."""

    name: Name = Field(description="name of the stage")
    duration: Time = Field(default=model.Stage("").duration, gt=0, description="duration [s]")
    velocity: Speeds | None = Field(
        default=None,
        description="instead of duration: speed of the tool that moves farthest [mm/s], or rows [travel, speed]",
    )
    press: StagePress | None = Field(
        default=None, description="instead of duration: the press that moves the tools, one of [presses]"
    )
    ramp: Time | None = Field(
        default=None,
        ge=0,
        description="explicit: time of the smooth start and of the smooth end of all that moves [s]; without it: a "
        "tenth of the duration; 0: full velocity from the first cycle on, a blow",
    )
    tools: dict[str, SpaceToolMotion] = Field(
        default={}, description="motion of each moving tool; the others stand still"
    )
    displacement: tuple[SpaceDisplacement, ...] = Field(default=(), description="prescribed displacements")
    force: tuple[SpaceForce, ...] = Field(default=(), description="forces")
    face_force: tuple[FaceForce, ...] = Field(default=(), description="forces on faces, spread by area")
    pressure: tuple[FacePressure, ...] = Field(default=(), description="pressures")
    convection: tuple[FormingConvection, ...] = Field(
        default=(), description="implicit: media that cool zones of the surface, with [heat]; of two the later one"
    )

    @model_validator(mode="after")
    def _check_velocity(self) -> Self:
        check_speeds(self.velocity, "velocity")
        return self

    @property
    def holds(self) -> bool:
        """Whether the stage has a duration, so that time passes even where nothing moves."""
        return "duration" in self.model_fields_set

    def find_timing(self, number: int) -> Timing:
        """Return the timing of this stage, with its number from 0."""
        travel = max((math.hypot(*motion.build().move) for motion in self.tools.values()), default=0.0)
        return Timing(f"stages.{number}", self.velocity, self.press, self.holds, travel)


class SpaceSolver(Solver):
    """How the implicit procedure integrates and iterates."""

    linear_solver: model.LinearSolverChoice = Field(
        default=model.SolverSettings().linear_solver,
        description=f"direct: by factors; multigrid: iterating; auto: multigrid from {model.LARGE:,} freedoms on",
    )


class SpaceCase(CaseFile):
    """A complete case of a solid in space. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line; it is the title of pictures")
    analysis: Literal["solid"] = Field(description="solid")
    procedure: Literal["implicit", "explicit"] = Field(
        default="implicit",
        description="implicit: equilibrium after every increment; explicit: dynamics in small steps, for impacts, and "
        "with explicit.target_step for forming",
    )
    workpiece: SpaceWorkpiece = Field(description="the body that is formed")
    materials: dict[Name, MaterialTable] = Field(
        default={}, description="materials by name; the workpiece may also name one of the library"
    )
    tools: dict[Name, SpaceTool] = Field(default={}, description="rigid tools by name")
    bodies: dict[Name, SpaceWorkpiece] = Field(default={}, description="further deformable bodies by name")
    contacts: dict[Name, Contact] = Field(default={}, description="contacts between bodies by name")
    presses: dict[Name, Press] = Field(default={}, description="presses that stages refer to, by name")
    boundary: dict[Name, SpaceBoundary] = Field(default={}, description="supports and symmetry planes by name")
    heat: FormingHeat | None = Field(default=None, description="heat of the bodies as they are formed")
    remesh: SpaceRemesh | None = Field(
        default=None,
        description="when and how finely tetrahedra are meshed anew; without it: where their first mesh fails",
    )
    gravity: Gravity3 | None = Field(default=None, description=GRAVITY)
    stages: tuple[SpaceStage, ...] = Field(min_length=1, description="the process, stage by stage")
    solver: SpaceSolver = Field(default=SpaceSolver(), description="how the implicit procedure integrates and iterates")
    explicit: ExplicitSolver = Field(
        default=ExplicitSolver(), description="how the explicit procedure steps through time"
    )
    points: dict[Name, Point3] = Field(default={}, description=POINTS)
    output: Output = Field(default=Output(), description="what is saved, and when")
    gradients: Gradients | None = Field(
        default=None, description="derivatives of the history by numbers of the case, found in the run itself"
    )
    limits: Limits = Field(
        default=Limits(), description="limits beyond which a run stops, since its result would no longer be physics"
    )

    @model_validator(mode="before")
    @classmethod
    def _add_library_materials(cls, data: Any) -> Any:
        return add_library_materials(data) if isinstance(data, dict) else data
