# SPDX-License-Identifier: Apache-2.0
"""The case: a forming problem as the user describes it, in a TOML file or in Python with the same names.

Lengths are mm, stresses MPa, forces N and times s where a plain number stands; a string with a unit is converted.
A tool is in tool.py; solver and output settings are in settings.py, hardening laws in hardening.py.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import (
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    Tag,
    ValidationInfo,
    model_validator,
)
from pydantic.config import JsonDict
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from presswork import model
from presswork.case.case_file import CaseFile
from presswork.case.gradients import Gradients
from presswork.case.gravity import DESCRIPTION as GRAVITY
from presswork.case.gravity import Gravity
from presswork.case.heat.films import FormingConvection
from presswork.case.heat.forming import FormingHeat
from presswork.case.heat.series import Series
from presswork.case.heat.thermal import Thermal
from presswork.case.held_stages import StagedBoundary
from presswork.case.limits import Limits
from presswork.case.marked_points import DESCRIPTION as POINTS
from presswork.case.material.grain import Grain
from presswork.case.material.gtn import Gtn
from presswork.case.material.heating import require_density
from presswork.case.material.library import add_library_materials, take_named
from presswork.case.material.phases import check_phases
from presswork.case.material.plastic import PlasticLaws
from presswork.case.material.transformation import Transformation
from presswork.case.material.umat import UmatMaterial, kind_of_material
from presswork.case.names import FileName, Name, Title
from presswork.case.part import Part
from presswork.case.plane.contact import Contact
from presswork.case.plane.explicit import ExplicitSolver
from presswork.case.plane.remesh import Remesh
from presswork.case.plane.separation import Separation
from presswork.case.plane.tool import Axis, Tool, check_motion, require_direction, unit_vector
from presswork.case.plane.workpiece import Workpiece, take_explicit_element
from presswork.case.press.builder import Timing
from presswork.case.press.schema import Press, Speeds, StagePress, check_speeds
from presswork.case.settings import Output, Solver
from presswork.case.units import (
    Angle,
    Density,
    Direction,
    Force,
    ForceVector,
    Length,
    Number,
    Place,
    Point,
    Stress,
    StressVector,
    Time,
    fault,
)


class Material(PlasticLaws):
    """An elastic-plastic solid; x of its yield function turns with the material."""

    DEFAULT_LAW: ClassVar[str] = "hill1948"

    library: FileName | None = Field(
        default=None,
        description='name of a material of the library, or "my_steel.toml", a material file beside the case; keys '
        "given beside it replace its own",
    )
    density: Density | None = Field(default=None, description='density [t/mm^3], e.g. "7850 kg/m^3"')
    thermal: Thermal | None = Field(default=None, description="thermal properties, needed with [heat]")
    gtn: Gtn | None = Field(default=None, description="pores that soften the metal, with an internal length")
    grain: Grain | None = Field(default=None, description="grain size in hot forming")
    transformation: Transformation | None = Field(
        default=None, description="what its austenite becomes on cooling, with [heat]"
    )
    rolling_direction: Angle | tuple[Number, Number, Number] = Field(
        default=0.0,
        description="x of the yield function at the start: its angle from x in the plane of x and y [degrees], "
        "or, of a solid in space, a direction [x, y, z]; y of the yield function is then across it in the plane of x "
        "and y, or x if the direction is z",
    )

    @model_validator(mode="before")
    @classmethod
    def _take_from_library(cls, data: Any, info: ValidationInfo) -> Any:
        named = take_named(data, info)
        return {**named.material.list_laws("density", "thermal"), **data} if named else data

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Require the laws only where no library gives them."""
        schema = handler.resolve_ref_schema(handler(core_schema))
        required = schema.pop("required", [])
        schema["if"], schema["else"] = {"required": ["library"]}, {"required": required}
        return schema

    def find_rolling_direction(self) -> tuple[float, float, float]:
        """Return it at length 1."""
        direction = self.rolling_direction
        if not isinstance(direction, tuple):
            return (math.cos(math.radians(direction)), math.sin(math.radians(direction)), 0.0)
        length = math.hypot(*direction)
        return (direction[0] / length, direction[1] / length, direction[2] / length)

    @model_validator(mode="after")
    def _check_density(self) -> Self:
        if isinstance(self.rolling_direction, tuple) and math.hypot(*self.rolling_direction) == 0.0:
            raise fault("expected a direction that is not zero", "for instance [1, 1, 0]", key="rolling_direction")
        require_density(self.density)
        if self.heating is not None and self.heating.heat_capacity is not None and self.density is None:
            raise fault("missing key", 'add it: plastic work heats by it; steel has "7850 kg/m^3"', key="density")
        check_phases(self.transformation.phases if self.transformation else None, self)
        return self


_MATERIALS: JsonDict = {"laws": "#/$defs/Material", "umat": "#/$defs/UmatMaterial"}
MaterialTable = Annotated[
    Annotated[Material, Tag("laws")] | Annotated[UmatMaterial, Tag("umat")],
    Discriminator(kind_of_material),
    Field(json_schema_extra={"discriminator": {"mapping": _MATERIALS}}),
]


class Boundary(StagedBoundary):
    """Displacement components held at zero."""

    set: str = Field(description="name of a node set")
    fix: tuple[Axis, ...] = Field(min_length=1, description="components held at zero, out of x and y")
    symmetry: bool | None = Field(
        default=None,
        description="whether this is a symmetry plane; without it: when it fixes one component only, on a straight "
        "side of the workpiece normal to that component",
    )


class ToolMotion(Part):
    """What a tool does over a stage: `move`, or `stroke` or `force` with `direction`; and `turn`."""

    stroke: Length | None = Field(default=None, ge=0, description="distance travelled over the stage [mm]")
    force: Force | None = Field(
        default=None,
        gt=0,
        description="instead of a stroke: what the whole tool pushes with at the stage's end [N], reached linearly",
    )
    direction: Direction | None = Field(
        default=None, description="direction [x, y] of the stroke or force, of any length"
    )
    move: Point | None = Field(default=None, description="displacement [x, y] over the stage [mm]")
    turn: Angle = Field(
        default=0.0, description="angle turned over the stage about the tool's centre, counter-clockwise [degree]"
    )
    position: Place | None = Field(
        default=None,
        description="where the origin of the profile, as drawn, stands when the stage begins [x, y] [mm], its angle as "
        "before; touch: where the tool touches the workpiece on its path; without it: where the stage before has left "
        "the tool",
    )

    @model_validator(mode="after")
    def _check_single_motion(self) -> Self:
        check_motion(self)
        if self.direction is not None:
            require_direction(self.direction)
        return self

    def build(self) -> model.ToolMotion:
        """Return the Model's motion."""
        turn = math.radians(self.turn)
        if self.force is not None:
            assert self.direction is not None
            push = model.Push(unit_vector(self.direction), np.array([[1.0, self.force]]))
            return model.ToolMotion(turn=turn, push=push, start=self.position)
        if self.stroke is not None:
            assert self.direction is not None
            x, y = unit_vector(self.direction)
            return model.ToolMotion(
                move=(self.stroke * x + 0.0, self.stroke * y + 0.0, 0.0), turn=turn, start=self.position
            )
        return model.ToolMotion(move=(*(self.move or (0.0, 0.0)), 0.0), turn=turn, start=self.position)


class Displacement(Part):
    """A displacement component that grows linearly over the stage."""

    set: str = Field(description="name of a node set")
    component: Axis = Field(description="x or y")
    value: Length = Field(description="displacement over the stage [mm]")


class NodeForce(Part):
    """A total force, shared equally by the nodes of a set, reached linearly at the end of the stage.

    Equal shares are even stress on few meshes only: edge_force is spread by area.
    """

    set: str = Field(description="name of a node set")
    value: ForceVector = Field(description="force [x, y] [N], e.g. [0, -5000]; on the whole ring in axisymmetry")


class EdgeForce(Part):
    """A force of fixed direction on an edge set, spread by undeformed area, reached linearly at the stage's end."""

    set: str = Field(description="name of an edge set")
    value: StressVector | None = Field(default=None, description="force per undeformed area [x, y] [MPa]")
    total: ForceVector | None = Field(
        default=None,
        description="instead of value: force on the whole set [x, y] [N], on the whole ring in axisymmetry",
    )

    @model_validator(mode="after")
    def _check_one_value(self) -> Self:
        if (self.value is None) == (self.total is None):
            remedy = "for instance value = [0, 100] (MPa), or total = [0, 5000] (N)"
            raise fault("give either value or total", remedy, key="value")
        return self


class Pressure(Part):
    """A pressure that follows the surface, reached linearly at the end of the stage."""

    set: str = Field(description="name of an edge set")
    value: Stress = Field(description="pressure [MPa], positive into the body")


class Stage(Part):
    """A part of the process in which every motion and load is linear in time; explicit: motions start smoothly."""

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
    tools: dict[str, ToolMotion] = Field(default={}, description="motion of each moving tool; the others stand still")
    displacement: tuple[Displacement, ...] = Field(default=(), description="prescribed displacements")
    force: tuple[NodeForce, ...] = Field(default=(), description="forces")
    edge_force: tuple[EdgeForce, ...] = Field(default=(), description="forces along edges, spread by area")
    pressure: tuple[Pressure, ...] = Field(default=(), description="pressures")
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
        moves = [motion.build().move for motion in self.tools.values()]
        travel = max((math.hypot(*move) for move in moves), default=0.0)
        return Timing(f"stages.{number}", self.velocity, self.press, self.holds, travel)


class Case(CaseFile):
    """A complete forming case. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line; it is the title of pictures")
    analysis: Literal["axisymmetric", "plane_strain"] = Field(
        description="axisymmetric (x is the radius, y the axis) or plane_strain"
    )
    procedure: Literal["implicit", "explicit"] = Field(
        default="implicit",
        description="implicit: equilibrium after every increment; explicit: dynamics in small steps, for impacts",
    )
    depth: Length = Field(default=1.0, gt=0, description="plane strain: extent normal to the plane [mm]")
    workpiece: Workpiece = Field(description="the body that is formed")
    materials: dict[Name, MaterialTable] = Field(
        default={}, description="materials by name; the workpiece may also name one of the library"
    )
    tools: dict[Name, Tool] = Field(default={}, description="rigid tools by name")
    bodies: dict[Name, Workpiece] = Field(default={}, description="further deformable bodies by name")
    contacts: dict[Name, Contact] = Field(default={}, description="contacts between bodies by name")
    presses: dict[Name, Press] = Field(default={}, description="presses that stages refer to, by name")
    boundary: dict[Name, Boundary] = Field(default={}, description="supports, the axis and symmetry planes by name")
    heat: FormingHeat | None = Field(default=None, description="heat of the workpiece as it is formed")
    gravity: Gravity | None = Field(default=None, description=GRAVITY)
    stages: tuple[Stage, ...] = Field(min_length=1, description="the process, stage by stage")
    solver: Solver = Field(default=Solver(), description="how the implicit procedure integrates and iterates")
    explicit: ExplicitSolver = Field(
        default=ExplicitSolver(), description="how the explicit procedure steps through time"
    )
    series: Series | None = Field(
        default=None, description="parts formed one after another between tools that conduct heat"
    )
    remesh: Remesh | None = Field(
        default=None,
        description="mesh the workpiece anew where its mesh would fail, and how; left out: where an increment fails on "
        "the first mesh, or a tool cuts deep into it",
    )
    separation: Separation | None = Field(
        default=None,
        description="explicit: cut cracks into the mesh where the mean damage is critical; left out: they are reported",
    )
    points: dict[Name, Point] = Field(default={}, description=POINTS)
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
        return take_explicit_element(add_library_materials(data)) if isinstance(data, dict) else data
