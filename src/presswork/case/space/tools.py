# SPDX-License-Identifier: Apache-2.0
"""Rigid tools that touch a solid in space, and how they move. Units as in case/units.py."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork import model
from presswork.case.heat.forming import ToolHeat
from presswork.case.names import FileName
from presswork.case.part import Part
from presswork.case.plane.contact import require_friction
from presswork.case.plane.tool import ProfilePoint, check_motion
from presswork.case.tools.friction import FrictionFactors
from presswork.case.tools.wear import Wear
from presswork.case.units import Angle, Direction3, Force, Length, Number, Place3, Point3, Stiffness, fault
from presswork.mesh.files.cad import is_cad


def unit_vector3(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a direction at length 1."""
    x, y, z = (part / math.hypot(*direction) + 0.0 for part in direction)
    return x, y, z


def require_direction3(direction: tuple[float, float, float], key: str) -> None:
    """Refuse a direction of no length."""
    if not any(direction):
        raise fault("expected a direction that is not zero", "for instance [0, 0, -1] for downwards", key=key)


class Rotation(Part):
    """Rotation of a tool at the start, about the origin of its own frame."""

    axis: Direction3 = Field(description="direction [x, y, z] about which it is turned, of any length")
    angle: Angle = Field(description="angle, counter-clockwise as seen from the tip of the axis [degrees]")

    @model_validator(mode="after")
    def _check_axis(self) -> Self:
        require_direction3(self.axis, "axis")
        return self

    def build(self) -> tuple[float, float, float]:
        """Return it as a vector along the axis, its length the angle [rad]."""
        x, y, z = (math.radians(self.angle) * part for part in unit_vector3(self.axis))
        return x, y, z


class SpaceSpring(Part):
    """A spring behind a tool, which stands at its stop until it is pushed with more than the preload."""

    stiffness: Stiffness = Field(gt=0, description="stiffness of the spring of the whole tool [N/mm]")
    preload: Force = Field(default=0.0, ge=0, description="preload: the tool moves back where it is pushed by more [N]")
    direction: Direction3 = Field(description="direction [x, y, z] in which the tool is pushed back, of any length")

    @model_validator(mode="after")
    def _check_direction(self) -> Self:
        require_direction3(self.direction, "direction")
        return self


class _SpaceTool(Part):
    """What tools of any shape have."""

    contact: model.ToolContactLaw = Field(
        description="frictionless, sticking, or friction: shear (tau = m k), coulomb (tau = mu p), coulomb_capped, "
        "wanheim_bay (mu p, which turns smoothly to m k), levanov (m k (1 - exp(-1.25 p / flow stress)))"
    )
    m: Number = Field(default=0.0, ge=0.0, le=1.0, description="friction factor of the other laws, 0 to 1")
    mu: Number = Field(default=0.0, ge=0.0, description="coefficient of friction of coulomb and coulomb_capped")
    position: Place3 = Field(
        default=(0.0, 0.0, 0.0),
        description="where the origin of the tool, as drawn, starts [x, y, z] [mm]; touch: the tool comes "
        "from afar, past [0, 0, 0] along its first motion, until it touches the workpiece; one that stands comes "
        "against the first motion of the others",
    )
    rotation: Rotation | None = Field(default=None, description="turns the tool, as drawn, about its origin")
    axis: Direction3 | None = Field(
        default=None,
        description="direction [x, y, z], as drawn, about which the tool turns in stages; without it: z of a round "
        "tool or a cylinder, y of a straight one",
    )
    centre: Point3 | None = Field(
        default=None,
        description="a point [x, y, z] of that axis, as drawn [mm], about which its torque is taken; without it: the "
        "origin, of a straight tool the centre that all its arcs share",
    )
    heat: ToolHeat | None = Field(default=None, description="temperature of the tool; without it: no heat passes")
    spring: SpaceSpring | None = Field(default=None, description="a spring on which the tool rests, as a cushion does")
    wear: Wear | None = Field(default=None, description="how the tool's surface wears")
    friction: FrictionFactors | None = Field(
        default=None, description="how m and mu depend on pressure, speed, temperature and the path slid"
    )

    @model_validator(mode="after")
    def _check_friction(self) -> Self:
        require_friction(self, self.contact)
        if self.axis is not None:
            require_direction3(self.axis, "axis")
        return self

    @property
    def turning_axis(self) -> tuple[float, float, float] | None:
        """The direction about which the tool turns, of length 1; None: its shape has no axis."""
        return None if self.axis is None else unit_vector3(self.axis)


class PlaneTool(_SpaceTool):
    """A flat tool without end, through its position."""

    shape: Literal["plane"] = Field(description="a flat tool without end, through its position")
    normal: Direction3 = Field(
        description="normal [x, y, z] of the plane, out of the tool to the workpiece, of any length"
    )

    @model_validator(mode="after")
    def _check_normal(self) -> Self:
        require_direction3(self.normal, "normal")
        return self


class ProfileTool(_SpaceTool):
    """A profile turned about the z axis, or drawn straight along y."""

    shape: Literal["round", "straight"] = Field(
        description="a profile turned about z, or one that goes straight on along y"
    )
    profile: tuple[ProfilePoint, ...] = Field(
        min_length=2,
        description="points [r, z] of a round tool, [x, z] of a straight one, joined by lines; {to = [r, z], radius = "
        '2} rounds a corner, {to = [r, z], centre = [r, z], turn = "left"} ends an arc',
    )
    free_side: Literal["auto", "left", "right"] = Field(
        default="auto",
        description="the side of the profile, as drawn, on which the tool's metal is not; auto: where the workpiece is",
    )

    @model_validator(mode="after")
    def _check_profile(self) -> Self:
        if self.shape == "round" and min(point.to[0] for point in self.profile) < 0.0:
            raise fault("a radius is negative", "draw the profile at r >= 0, from the axis outwards", key="profile")
        return self

    @property
    def turning_axis(self) -> tuple[float, float, float] | None:
        """The direction about which it turns, of length 1."""
        natural = (0.0, 0.0, 1.0) if self.shape == "round" else (0.0, 1.0, 0.0)
        return natural if self.axis is None else unit_vector3(self.axis)


class CylinderTool(_SpaceTool):
    """A cylinder about z, its middle at the tool's origin."""

    shape: Literal["cylinder"] = Field(description="a cylinder about z, its middle at the origin")
    radius: Length = Field(gt=0, description="radius of the cylinder [mm]")
    length: Length = Field(gt=0, description="length of the cylinder along z [mm]")
    edge_radius: Length = Field(default=0.0, ge=0, description="radius that rounds its two edges [mm]")

    @model_validator(mode="after")
    def _check_edge(self) -> Self:
        check_edge(self.edge_radius, min(self.radius, 0.5 * self.length))
        return self

    @property
    def turning_axis(self) -> tuple[float, float, float]:
        """The direction about which it turns, of length 1."""
        return (0.0, 0.0, 1.0) if self.axis is None else unit_vector3(self.axis)


class SphereTool(_SpaceTool):
    """A sphere about the tool's origin."""

    shape: Literal["sphere"] = Field(description="a sphere about the origin")
    radius: Length = Field(gt=0, description="radius of the sphere [mm]")


class BoxTool(_SpaceTool):
    """A box with rounded edges, its middle at the tool's origin."""

    shape: Literal["box"] = Field(description="a box, its middle at the origin")
    size: Point3 = Field(description="extent of the box along x, y and z, as drawn [mm]")
    edge_radius: Length = Field(default=0.0, ge=0, description="radius that rounds all its edges [mm]")

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if min(self.size) <= 0.0:
            raise fault("expected three values > 0", "give [x, y, z], all positive", key="size")
        check_edge(self.edge_radius, 0.5 * min(self.size))
        return self


def check_edge(radius: float, room: float) -> None:
    """Refuse a fillet that does not fit."""
    if radius > room:
        raise fault(f"the edges leave no room for it: {room:g} mm", "give at most that", key="edge_radius")


class ToolFile(_SpaceTool):
    """A tool's surface from a file, its normals out of the metal."""

    shape: Literal["file"] = Field(description="a surface from an STL file, or the faces of a model in STEP")
    path: FileName = Field(description="the file, relative to the case file: .stl, .step, .stp, .iges, .igs")
    unit: str = Field(default="mm", description="length unit of an STL file's coordinates, e.g. mm, m, inch")
    tolerance: Length | None = Field(
        default=None,
        gt=0,
        description="STEP, IGES: how far facets may lie off the faces [mm]; default: 1e-4 of the model's diagonal",
    )

    @model_validator(mode="after")
    def _check_step(self) -> Self:
        if is_cad(self.path) and "unit" in self.model_fields_set:
            raise fault("has no meaning with a CAD file", "remove it", key="unit")
        if self.tolerance is not None and not is_cad(self.path):
            raise fault("has a meaning with a CAD file only", "remove it", key="tolerance")
        return self


SpaceTool = Annotated[
    PlaneTool | ProfileTool | CylinderTool | SphereTool | BoxTool | ToolFile, Field(discriminator="shape")
]


class SpaceToolMotion(Part):
    """What a tool does over a stage: `move`, or `stroke` or `force` with `direction`; and `turn`."""

    stroke: Length | None = Field(default=None, ge=0, description="distance travelled over the stage [mm]")
    force: Force | None = Field(
        default=None,
        gt=0,
        description="instead of a stroke: what the whole tool pushes with at the stage's end [N], reached linearly",
    )
    direction: Direction3 | None = Field(
        default=None, description="direction [x, y, z] of the stroke or force, of any length"
    )
    move: Point3 | None = Field(default=None, description="displacement [x, y, z] over the stage [mm]")
    turn: Angle = Field(
        default=0.0,
        description="angle turned over the stage about the tool's axis, counter-clockwise seen from its tip [degree]",
    )
    position: Place3 | None = Field(
        default=None,
        description="where the origin of the tool, as drawn, stands when the stage begins [x, y, z] [mm], its angle as "
        "before; touch: where the tool touches the workpiece on its path; without it: where the stage before has left "
        "the tool",
    )

    @model_validator(mode="after")
    def _check_single_motion(self) -> Self:
        check_motion(self, "[x, y, z]")
        if self.direction is not None:
            require_direction3(self.direction, "direction")
        return self

    def build(self) -> model.ToolMotion:
        """Return the Model's motion."""
        turn = math.radians(self.turn)
        if self.force is not None:
            assert self.direction is not None
            push = model.Push(unit_vector3(self.direction), np.array([[1.0, self.force]]))
            return model.ToolMotion(turn=turn, push=push, start=self.position)
        move = self.move or (0.0, 0.0, 0.0)
        if self.stroke is not None:
            assert self.direction is not None
            x, y, z = (self.stroke * part / math.hypot(*self.direction) + 0.0 for part in self.direction)
            move = (x, y, z)
        return model.ToolMotion(move=move, turn=turn, start=self.position)
