# SPDX-License-Identifier: Apache-2.0
"""The case of a shell: a sheet in x, y, z with supports and loads. Units as in schema.py."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    model_validator,
)

from presswork import model
from presswork.case.case_file import CaseFile
from presswork.case.gradients import Gradients
from presswork.case.gravity import DESCRIPTION as GRAVITY
from presswork.case.gravity import Gravity3
from presswork.case.held_stages import StagedBoundary
from presswork.case.limits import Limits
from presswork.case.marked_points import DESCRIPTION as POINTS
from presswork.case.material.library import add_library_materials
from presswork.case.names import FileName, Name, Title
from presswork.case.part import Part
from presswork.case.plane.workpiece import MeshFile, Rectangle, assume_rectangle
from presswork.case.settings import Output, Solver
from presswork.case.shell.material import SheetTable
from presswork.case.units import (
    Angle,
    BodyForceVector,
    EdgeForceVector,
    Force3,
    Length,
    Moment3,
    Point3,
    Stress,
    Time,
    fault,
)
from presswork.case.zones.schema import BlankZone
from presswork.model import FloatArray

Freedom = Literal["x", "y", "z", "rx", "ry", "rz"]
FREEDOMS: tuple[Freedom, ...] = ("x", "y", "z", "rx", "ry", "rz")
HOLDS: dict[str, tuple[Freedom, ...]] = {
    "clamped": FREEDOMS,
    "hinged": ("x", "y", "z"),
    "symmetry_x": ("x", "ry", "rz"),
    "symmetry_y": ("y", "rx", "rz"),
    "symmetry_z": ("z", "rx", "ry"),
}


class Section(Part):
    """A sheet through its thickness."""

    thickness: Length = Field(gt=0, description="thickness [mm]")
    points: int = Field(
        default=model.Section(1.0).points, strict=True, ge=2, le=51, description="points through the thickness, 2 to 51"
    )
    rule: model.ThicknessRule = Field(
        default=model.Section(1.0).rule, description="gauss; lobatto and simpson have points on both faces"
    )

    @model_validator(mode="after")
    def _check_simpson(self) -> Self:
        if self.rule == "simpson" and self.points % 2 == 0:
            raise fault("Simpson's rule has an odd number of points", f"take {self.points + 1}", key="points")
        return self


class ShellRectangle(Rectangle):
    """A rectangle in x, y, flat or rolled; its sets are left, right, bottom, top, all, boundary and the corners."""

    roll_radius: Length | None = Field(
        default=None,
        gt=0,
        description="rolls the rectangle into a cylinder about an axis along x: y becomes arc length; y = 0 stays at "
        "z = 0, with the axis below it [mm]",
    )


class ShellWorkpiece(Part):
    """The sheet that is formed."""

    material: FileName = Field(
        description='name of one of the [materials], or of the library, or "my_steel.toml", a material file of your own'
    )
    element: model.ShellElement = Field(description="element formulation")
    section: Section = Field(description="thickness and the points through it")
    mesh: Annotated[ShellRectangle | MeshFile, Field(discriminator="kind"), BeforeValidator(assume_rectangle)] = Field(
        description="the mesh of the mid-surface"
    )
    zones: tuple[BlankZone, ...] = Field(
        default=(), description="zones of a welded sheet, which do not overlap; each cell is where its middle lies"
    )

    @property
    def mean_thickness(self) -> float:
        """Thickness beside the zones [mm]."""
        return self.section.thickness

    def find_thickness(self, places: FloatArray) -> None:
        """Return nothing: it is one for all places."""


class ShellBoundary(StagedBoundary):
    """What is held, in one word or freedom by freedom."""

    set: str = Field(description="name of a node set")
    hold: Literal["clamped", "hinged", "symmetry_x", "symmetry_y", "symmetry_z"] | None = Field(
        default=None,
        description="clamped: nothing moves or turns; hinged: nothing moves; symmetry_x: a symmetry plane normal to x",
    )
    fix: tuple[Freedom, ...] = Field(
        default=(), description="instead: out of x, y, z and the rotations about them rx, ry, rz"
    )

    @model_validator(mode="after")
    def _check_single_hold(self) -> Self:
        if (self.hold is None) == (not self.fix):
            raise fault("give either hold or fix", 'for instance hold = "clamped", or fix = ["z"]', key="hold")
        return self

    def build(self, name: str) -> model.Support:
        """Return the Model's support; name: of the entry."""
        held = self.fix if self.hold is None else HOLDS[self.hold]
        return model.Support(self.set, tuple(freedom in held for freedom in FREEDOMS), name)


class ShellDisplacement(Part):
    """A displacement component that grows linearly over the stage."""

    set: str = Field(description="name of a node set")
    component: Literal["x", "y", "z"] = Field(description="x, y or z")
    value: Length = Field(description="displacement over the stage [mm]")


class ShellRotation(Part):
    """A rotation that grows linearly over the stage."""

    set: str = Field(description="name of a node set")
    axis: Literal["x", "y", "z"] = Field(description="axis turned about: x, y or z")
    angle: Angle = Field(description="angle over the stage [degree]")


class ShellForce(Part):
    """A total force and moment of fixed direction, shared equally by the nodes of a set."""

    set: str = Field(description="name of a node set")
    value: Force3 = Field(default=(0.0, 0.0, 0.0), description="force [x, y, z] [N]")
    moment: Moment3 = Field(default=(0.0, 0.0, 0.0), description="moment about x, y, z [N mm]")


class EdgeForce(Part):
    """A force per undeformed length along an edge set, of fixed direction."""

    set: str = Field(description="name of an edge set")
    value: EdgeForceVector = Field(description="force per length [x, y, z] [N/mm]")


class ShellPressure(Part):
    """A pressure that follows the sheet."""

    set: str = Field(description="name of a node set: the pressure acts on the cells whose nodes are all in it")
    value: Stress = Field(description="pressure [MPa], positive along the normal of the cells")


class BodyForce(Part):
    """A force per undeformed volume on the whole sheet, such as its weight."""

    value: BodyForceVector = Field(description="force per volume [x, y, z] [N/mm^3]")


class ShellStage(Part):
    """A part of the process in which every load is linear in time."""

    name: Name = Field(description="name of the stage")
    duration: Time = Field(default=model.Stage("").duration, gt=0, description="duration [s]")
    displacement: tuple[ShellDisplacement, ...] = Field(default=(), description="prescribed displacements")
    rotation: tuple[ShellRotation, ...] = Field(default=(), description="prescribed rotations")
    force: tuple[ShellForce, ...] = Field(default=(), description="forces and moments")
    edge_force: tuple[EdgeForce, ...] = Field(default=(), description="forces along edges")
    pressure: tuple[ShellPressure, ...] = Field(default=(), description="pressures")
    body_force: tuple[BodyForce, ...] = Field(default=(), description="forces per volume")


class ShellCase(CaseFile):
    """A complete case of a shell. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line; it is the title of pictures")
    analysis: Literal["shell"] = Field(description="shell")
    workpiece: ShellWorkpiece = Field(description="the sheet that is formed")
    materials: dict[Name, SheetTable] = Field(default={}, description="materials by name")
    boundary: dict[Name, ShellBoundary] = Field(default={}, description="supports and symmetry planes by name")
    gravity: Gravity3 | None = Field(default=None, description=GRAVITY)
    stages: tuple[ShellStage, ...] = Field(min_length=1, description="the process, stage by stage")
    solver: Solver = Field(default=Solver(), description="how the implicit procedure integrates and iterates")
    output: Output = Field(default=Output(), description="what is saved, and when")
    gradients: Gradients | None = Field(
        default=None, description="derivatives of the history by numbers of the case, found in the run itself"
    )
    points: dict[Name, Point3] = Field(default={}, description=POINTS)
    limits: Limits = Field(
        default=Limits(), description="limits beyond which a run stops, since its result would no longer be physics"
    )

    @model_validator(mode="before")
    @classmethod
    def _prepare(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        if "tools" in data:
            raise fault("tools cannot touch a shell yet", "move its edges, or load it", key="tools")
        return add_library_materials(data)
