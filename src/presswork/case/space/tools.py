# SPDX-License-Identifier: Apache-2.0
"""Rigid tools that touch a solid in space, and how they move. Units as in case/units.py."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.part import Part
from presswork.case.solid.contact import require_friction
from presswork.case.solid.tool import ProfilePoint
from presswork.case.units import Direction3, Length, Number, Point3, fault


class _SpaceTool(Part):
    """What tools of any shape have."""

    contact: model.ContactLaw = Field(
        description="frictionless, sticking, or friction: shear (tau = m k), coulomb (tau = mu p), coulomb_capped"
    )
    m: Number = Field(default=0.0, ge=0.0, le=1.0, description="friction factor of shear and coulomb_capped, 0 to 1")
    mu: Number = Field(default=0.0, ge=0.0, description="coefficient of friction of coulomb and coulomb_capped")
    position: Point3 = Field(
        default=(0.0, 0.0, 0.0), description="where the origin of the tool, as drawn, starts [x, y, z] [mm]"
    )

    @model_validator(mode="after")
    def _check_friction(self) -> Self:
        require_friction(self, self.contact)
        return self


class PlaneTool(_SpaceTool):
    """A flat tool without end, through its position."""

    shape: Literal["plane"] = Field(description="a flat tool without end, through its position")
    normal: Direction3 = Field(description="direction [x, y, z] out of the tool, to the workpiece, of any length")

    @model_validator(mode="after")
    def _check_normal(self) -> Self:
        if not any(self.normal):
            raise fault("expected a direction that is not zero", "for instance [0, 0, -1] for an upper tool", "normal")
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


class ToolFile(_SpaceTool):
    """A tool's surface from an STL file, its normals out of the metal."""

    shape: Literal["file"] = Field(description="a surface from an STL file")
    path: str = Field(description="the file, relative to the case file")
    unit: str = Field(default="mm", description="length unit of the file's coordinates, e.g. mm, m, inch")


SpaceTool = Annotated[PlaneTool | ProfileTool | ToolFile, Field(discriminator="shape")]


class SpaceToolMotion(Part):
    """What a tool does over a stage: `move`, or `stroke` with `direction`."""

    stroke: Length | None = Field(default=None, ge=0, description="distance travelled over the stage [mm]")
    direction: Direction3 | None = Field(default=None, description="direction [x, y, z] of the stroke, of any length")
    move: Point3 | None = Field(default=None, description="instead: displacement [x, y, z] over the stage [mm]")

    @model_validator(mode="after")
    def _check_one_way_of_moving(self) -> Self:
        remedy = "give stroke with direction = [x, y, z], or move = [x, y, z]"
        if self.move is not None:
            for key in ("stroke", "direction"):
                if getattr(self, key) is not None:
                    raise fault(f"{key} stands beside move", remedy, key=key)
            return self
        for key in ("stroke", "direction"):
            if getattr(self, key) is None:
                raise fault("missing key", remedy, key=key)
        if self.direction is not None and not any(self.direction):
            raise fault("expected a direction that is not zero", "for instance [0, 0, -1]", key="direction")
        return self

    def build(self) -> model.ToolMotion:
        """Return the Model's motion."""
        if self.move is not None:
            return model.ToolMotion(move=self.move)
        assert self.direction is not None
        assert self.stroke is not None
        x, y, z = (self.stroke * part / math.hypot(*self.direction) + 0.0 for part in self.direction)
        return model.ToolMotion(move=(x, y, z))
