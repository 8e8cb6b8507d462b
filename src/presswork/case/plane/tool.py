# SPDX-License-Identifier: Apache-2.0
"""A rigid tool in the plane: its profile, where it stands, how it touches, and what carries it."""

from __future__ import annotations

import math
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.heat.forming import ToolHeat
from presswork.case.names import FileName
from presswork.case.part import Part, ShortForm
from presswork.case.plane.contact import require_friction
from presswork.case.plane.die_body import DieBody
from presswork.case.tools.friction import FrictionFactors
from presswork.case.tools.wear import Wear
from presswork.case.units import (
    Direction,
    Force,
    Length,
    Number,
    Place,
    Point,
    Stiffness,
    fault,
)
from presswork.mesh.files.cad import is_cad

Axis = Literal["x", "y"]


def require_direction(direction: tuple[float, float]) -> None:
    """Refuse a direction of no length."""
    if math.hypot(*direction) == 0.0:
        raise fault("expected a direction that is not zero", "for instance [0, -1] for downwards", key="direction")


def unit_vector(direction: tuple[float, float]) -> tuple[float, float]:
    """Return a direction at length 1."""
    length = math.hypot(*direction)
    return direction[0] / length + 0.0, direction[1] / length + 0.0


def check_motion(motion: Any, place: str = "[x, y]") -> None:
    """Refuse keys of a tool's motion, in the plane or in space, that do not fit; place: as remedies write it."""
    remedy = f"give stroke or force, with direction; or move = {place}; or turn"
    along = [name for name in ("stroke", "force") if getattr(motion, name) is not None]
    if motion.move is not None and (along or motion.direction is not None):
        raise fault(f"move and {(along or ['direction'])[0]} are both given", remedy, key="move")
    if len(along) == 2:
        raise fault("force and stroke are both given", "a tool either travels or pushes in a stage", key="force")
    if along and motion.direction is None:
        raise fault("missing key", remedy, key="direction")
    if motion.position == "touch" and not along and not (motion.move and any(motion.move)):
        remedy = f"give stroke, move or force, or position = {place}"
        raise fault("the tool has no direction from which it comes", remedy, key="position")
    is_placed = isinstance(motion.position, tuple)
    if not along and (motion.direction is not None or (motion.move is None and not motion.turn and not is_placed)):
        raise fault("missing key", remedy, key="stroke")


class ProfilePoint(ShortForm):
    """The next point of a tool's profile; short form [x, y]."""

    short_form = ("to",)

    to: Point = Field(description="the point [x, y] [mm]")
    radius: Length = Field(default=0.0, ge=0, description="fillet that rounds the corner here [mm]")
    centre: Point | None = Field(
        default=None, description="the piece that ends here is an arc about this point [x, y] [mm]"
    )
    turn: Literal["left", "right"] | None = Field(
        default=None, description="to which side that arc turns: left is counter-clockwise"
    )
    m: Number | None = Field(
        default=None, ge=0.0, le=1.0, description="friction factor of the piece that ends here, instead of the tool's"
    )
    mu: Number | None = Field(
        default=None, ge=0.0, description="coefficient of friction of the piece that ends here, instead of the tool's"
    )

    @model_validator(mode="after")
    def _check_arc(self) -> Self:
        if (self.centre is None) != (self.turn is None):
            text, centre = "missing key: an arc needs both centre and turn", "give the arc's centre [x, y], or no turn"
            if self.centre is None:
                raise fault(text, centre, key="centre")
            raise fault(text, 'for instance turn = "left"', key="turn")
        return self


class Spring(Part):
    """A spring behind a tool, which stands at its stop until it is pushed with more than the preload."""

    stiffness: Stiffness = Field(gt=0, description="stiffness of the spring of the whole tool [N/mm]")
    preload: Force = Field(default=0.0, ge=0, description="preload: the tool moves back where it is pushed by more [N]")
    direction: Direction = Field(description="direction [x, y] in which the tool is pushed back, of any length")

    @model_validator(mode="after")
    def _check_direction(self) -> Self:
        require_direction(self.direction)
        return self


class Tool(Part):
    """A rigid tool, given by its profile: points here, or a file."""

    profile: tuple[ProfilePoint, ...] | None = Field(
        default=None,
        description="points [x, y], joined by lines; {to = [x, y], radius = 2} rounds a corner, "
        '{to = [x, y], centre = [x, y], turn = "left"} ends an arc',
    )
    profile_file: FileName | None = Field(
        default=None,
        description="instead of profile: a text file of two columns, x and y, a .dxf drawing, or the section of "
        "a model in STEP, relative to the case",
    )
    unit: str | None = Field(
        default=None, description="length unit of the file, e.g. mm, m, inch; default: a drawing's own, or else mm"
    )
    layer: str | None = Field(default=None, description="the layer of the drawing that holds the profile")
    section: Literal["xy", "xz", "yz"] | None = Field(
        default=None,
        description="STEP: the plane through the origin that cuts the model, its first axis x (axisymmetric: r, of "
        "which the half r >= 0 is taken); default: xy",
    )
    curve: Literal["polyline", "spline"] | None = Field(
        default=None,
        description="how points are joined: polyline, by lines (default for profile), or spline, by a smooth curve "
        "between corners (default for a text file)",
    )
    corner_angle: Number = Field(
        default=30.0, gt=0, lt=180, description="turn [degrees] above which a point of a spline stays a corner"
    )
    tolerance: Length | None = Field(
        default=None,
        gt=0,
        description="how far the arcs of the profile may lie off the smooth curve [mm], and how far apart the ends of "
        "a drawing's pieces; default: 1e-5 of the profile's extent",
    )
    contact: model.ToolContactLaw = Field(
        description="frictionless, sticking, or friction: shear (tau = m k), coulomb (tau = mu p), coulomb_capped, "
        "wanheim_bay (mu p, which turns smoothly to m k), levanov (m k (1 - exp(-1.25 p / flow stress)))"
    )
    m: Number = Field(default=0.0, ge=0.0, le=1.0, description="friction factor of the other laws, 0 to 1")
    mu: Number = Field(default=0.0, ge=0.0, description="coefficient of friction of coulomb and coulomb_capped")
    closed: bool = Field(default=False, description="join the last point to the first")
    free_side: Literal["auto", "left", "right"] = Field(
        default="auto",
        description="the side of the profile, as drawn, on which the tool's metal is not; auto: where the workpiece is",
    )
    mirrored: tuple[Axis, ...] | None = Field(
        default=None,
        description="plane strain: the whole tool is this one and its mirror image along x | y, so that its force "
        "counts twice; without it: wherever the profile reaches a symmetry plane",
    )
    centre: Point | None = Field(
        default=None,
        description="the point [x, y] about which the tool turns, and its torque is taken [mm]; without it: the centre "
        "that all its arcs share, as of a roll",
    )
    position: Place | None = Field(
        default=None,
        description="where the origin of the profile, as drawn, starts [x, y] [mm], centre included; touch: it is "
        "moved from there along its first motion until it touches the workpiece; one that stands comes against the "
        "first motion of the others",
    )
    spring: Spring | None = Field(default=None, description="a spring on which the tool rests, as a cushion does")
    heat: ToolHeat | None = Field(default=None, description="temperature of the tool; without it: no heat passes")
    body: DieBody | None = Field(
        default=None, description="the tool's body, whose stress `presswork dies` finds after the run"
    )
    wear: Wear | None = Field(default=None, description="how the tool's surface wears")
    friction: FrictionFactors | None = Field(
        default=None, description="how m and mu depend on pressure, speed, temperature and the path slid"
    )

    @model_validator(mode="after")
    def _check_friction(self) -> Self:
        pieces = [
            f"profile.{index}.{key}"
            for index, point in enumerate(self.profile or ())
            for key in ("m", "mu")
            if getattr(point, key) is not None
        ]
        require_friction(self, self.contact, pieces)
        return self

    @model_validator(mode="after")
    def _check_profile(self) -> Self:
        if self.profile is None:
            self._check_file()
            return self
        if self.profile_file is not None:
            raise fault("profile and profile_file are both given", "give one of them", key="profile_file")
        for key in ("unit", "layer"):
            if getattr(self, key) is not None:
                raise fault("has no meaning without profile_file", "remove it", key=key)
        ends_meet = len(self.profile) > 2 and self.profile[0].to == self.profile[-1].to
        is_closed, has_arcs = self.closed or ends_meet, any(point.centre for point in self.profile)
        least = 3 if is_closed and not has_arcs else 2
        if len(self.profile) - ends_meet < least:
            kind, example = ("a closed profile of lines", ", [15, 30]") if is_closed else ("a profile", "")
            remedy = f"for instance [[0, 15], [30, 15]{example}]"
            raise fault(f"{kind} needs at least {least} points", remedy, key="profile")
        if self.profile[0].centre is not None and (ends_meet or not self.closed):
            raise fault("the first point of an open profile ends no arc", "start with [x, y]", key="profile")
        self._check_spline(self.curve == "spline")
        for index, point in enumerate(self.profile):
            if self.curve == "spline" and (point.radius or point.centre is not None):
                remedy = 'give plain points, or leave curve = "spline" out'
                raise fault("a spline takes no radius and no arc", remedy, key=f"profile.{index}")
        return self

    def _check_file(self) -> None:
        if self.profile_file is None:
            remedy = "give points [x, y], joined by lines, or profile_file"
            raise fault("missing key", remedy, key="profile")
        if self.section is not None and not is_cad(self.profile_file):
            raise fault("has a meaning with a CAD file only", "remove it", key="section")
        if is_cad(self.profile_file):
            for key in {"layer", "unit"} & self.model_fields_set:
                raise fault("has no meaning with a CAD file", "remove it", key=key)
        elif not self.profile_file.lower().endswith(".dxf"):
            if self.layer is not None:
                raise fault("has no meaning with a text file", "remove it", key="layer")
            self._check_spline(self.curve != "polyline")
            return
        for key in {"curve", "corner_angle"} & self.model_fields_set:
            raise fault("has no meaning with a drawing, whose lines and arcs stay", "remove it", key=key)

    def _check_spline(self, is_spline: bool) -> None:
        for key in ("corner_angle", "tolerance"):
            if key in self.model_fields_set and not is_spline:
                raise fault('has a meaning with curve = "spline" only', "remove it", key=key)
