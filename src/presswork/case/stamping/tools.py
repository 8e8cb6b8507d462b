# SPDX-License-Identifier: Apache-2.0
"""The tools of a stamping by their drawing dimensions, or from a file. Units as in schema.py."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from presswork.case.heat.forming import ToolHeat
from presswork.case.names import FileName
from presswork.case.part import Part
from presswork.case.stamping.plan_line import Trim
from presswork.case.tools.friction import FrictionFactors
from presswork.case.units import Direction3, Length, Number, Point, Point3, fault
from presswork.geometry.section_tool import SectionError, draw_one_sided, draw_round_x, draw_section
from presswork.mesh.files.cad import is_cad
from presswork.model import ToolKind


class _Tool(Part):
    """What tools of any shape have."""

    kind: ToolKind = Field(
        description="punch, above the blank and working downwards; holder, likewise; die, below the blank"
    )
    mu: Number = Field(
        default=0.1, ge=0, lt=1, description="coefficient of friction; 0.1 is a steel sheet with drawing oil"
    )
    position: Point3 | None = Field(
        default=None,
        description="where the tool's own origin starts [x, y, z] [mm]; without it the tool just touches the flat "
        "blank, whose middle lies at z = 0. Origin of drawn tools: the middle of the punch's bottom, or of the "
        "opening in the face of die or holder",
    )
    gap: Length | None = Field(
        default=None, gt=0, description="holder: distance of its face from the die's [mm]; without it: the thickness"
    )
    direction: Direction3 | None = Field(
        default=None,
        description="direction [x, y, z], of any length, in which it works: strokes and forces count along it; without "
        "it punch and holder work down, a die up. Another one needs a position",
    )
    heat: ToolHeat | None = Field(
        default=None, description="its temperature and conductance, with [heat]; without it: no heat passes into it"
    )

    friction: FrictionFactors | None = Field(
        default=None, description="how mu depends on pressure, speed, temperature and the path slid"
    )

    @model_validator(mode="after")
    def _check_gap(self) -> Self:
        if self.gap is not None and self.kind != "holder":
            raise fault("only a holder has a gap", "leave it out, or give the tool's position", key="gap")
        if self.gap is not None and self.position is not None:
            raise fault("gap and position both place the holder", "give one of them", key="gap")
        return self

    @model_validator(mode="after")
    def _check_direction(self) -> Self:
        if self.direction is None:
            return self
        if not any(self.direction):
            raise fault("has no length", "for instance [-1, 0, -1]: aslant, down and to the left", key="direction")
        down_or_up = 1.0 if self.kind == "die" else -1.0
        is_usual = not any(self.direction[:2]) and self.direction[2] * down_or_up > 0.0
        if self.position is None and not is_usual:
            fault_text = "where a tool that works another way than its kind does touches the blank is not looked for"
            raise fault(fault_text, "give its position = [x, y, z]", key="direction")
        return self


class _DrawnTool(_Tool):
    """What tools have that are drawn by the program."""

    edge_radius: Length = Field(
        ge=0, description="radius that the sheet is bent round: of the punch's nose or the die's shoulder [mm]"
    )
    face_width: Length | None = Field(
        default=None,
        gt=0,
        description="die, holder: width of the flat face round the opening [mm]; without it: as far as the blank",
    )

    depth: Length | None = Field(
        default=None, gt=0, description="die: depth of its flat bottom under its face [mm]; without it: open below"
    )
    bottom_radius: Length = Field(
        default=0.0, ge=0, description="die with a bottom: radius between bottom and wall [mm]"
    )

    @model_validator(mode="after")
    def _check_bottom(self) -> Self:
        if self.kind != "die" and self.depth is not None:
            raise fault("only a die has a bottom", "leave it out", key="depth")
        if self.depth is None and self.bottom_radius > 0.0:
            raise fault("a die that is open below has no bottom", "give depth, or leave it out", key="bottom_radius")
        if self.depth is not None and self.bottom_radius + self.edge_radius > self.depth:
            text = f"the wall is lower than the radii at its ends, {self.bottom_radius:g} and {self.edge_radius:g} mm"
            raise fault(text, "make the die deeper or the radii smaller", key="depth")
        return self

    @model_validator(mode="after")
    def _check_radius(self) -> Self:
        if self.edge_radius == 0 and self.kind != "holder":
            raise fault("a sheet cannot be bent round a sharp edge", "give a radius > 0", key="edge_radius")
        if self.face_width is not None and self.kind == "punch":
            raise fault("a punch has no face round an opening", "leave it out", key="face_width")
        if self.face_width is not None and self.face_width <= self.edge_radius:
            text = f"the face must be wider than its edge radius of {self.edge_radius:g} mm, which is part of it"
            raise fault(text, "make it wider", key="face_width")
        return self


class RoundTool(_DrawnTool):
    """A round punch, or a die or holder with a round opening."""

    shape: Literal["round"] = Field(description="a round punch or opening")
    diameter: Length = Field(gt=0, description="diameter of the punch, or of the opening [mm]")

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.diameter, 0.5 * self.diameter

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if self.kind == "punch" and self.edge_radius > 0.5 * self.diameter:
            raise fault(
                f"the edge radius is larger than the punch's radius of {0.5 * self.diameter:g} mm",
                'make it smaller; shape = "hemispherical" is the largest',
                key="edge_radius",
            )
        return self


class RectangularTool(_DrawnTool):
    """A rectangular punch, or a die or holder with a rectangular opening."""

    shape: Literal["rectangular"] = Field(description="a rectangular punch or opening with round corners")
    size: Point = Field(description="width along x and y of the punch, or of the opening [mm]")
    corner_radius: Length = Field(ge=0, description="radius of the corners in the plan [mm]")

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.size[0], 0.5 * self.size[1]

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if min(self.size) <= 0:
            raise fault("expected two values > 0", "give [x, y], both positive", key="size")
        if self.corner_radius > 0.5 * min(self.size):
            raise fault(
                f"the corners do not fit the plan, {min(self.size):g} mm wide",
                f"take at most {0.5 * min(self.size):g} mm",
                key="corner_radius",
            )
        if self.kind == "punch" and self.edge_radius > self.corner_radius:
            raise fault(
                f"the edge radius does not fit corners of {self.corner_radius:g} mm in the plan",
                "take at most corner_radius",
                key="edge_radius",
            )
        return self


class StripTool(_DrawnTool):
    """A punch, or a die or holder with an opening, that goes straight on along y."""

    shape: Literal["strip"] = Field(description="a punch or opening straight along y, without end")
    width: Length = Field(gt=0, description="width along x of the punch, or of the opening [mm]")

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.width, float("inf")

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if self.kind == "punch" and self.edge_radius > 0.5 * self.width:
            raise fault(
                f"the edge radii do not fit a punch of {self.width:g} mm",
                f"take at most {0.5 * self.width:g} mm",
                key="edge_radius",
            )
        return self


def _hide_gap(schema: dict[str, Any]) -> None:
    """Leave the gap of holders out of a schema: no holder has that shape, and `_check_kind` reports it."""
    schema["properties"].pop("gap")


class HemisphericalTool(_Tool):
    """A punch with a hemispherical nose."""

    model_config = ConfigDict(json_schema_extra=_hide_gap)

    shape: Literal["hemispherical"] = Field(description="a punch with a hemispherical nose")
    diameter: Length = Field(gt=0, description="diameter of the punch [mm]")

    def half_size(self) -> tuple[float, float]:
        """Return half the width along x and y [mm]."""
        return 0.5 * self.diameter, 0.5 * self.diameter

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        if self.kind != "punch":
            raise fault(f"a {self.kind} has no hemispherical nose", 'take shape = "round"', key="shape")
        return self


class RingTool(_Tool):
    """A round ring with a flat face, or a round post: flanging dies and punches, pads, sleeves for redrawing."""

    shape: Literal["ring"] = Field(
        description="a round ring with a flat face and walls away from the sheet inside and outside, or a post"
    )
    outer_diameter: Length = Field(gt=0, description="diameter of its outer wall [mm]")
    inner_diameter: Length = Field(default=0.0, ge=0, description="diameter of its opening [mm]; 0: a post without one")
    outer_radius: Length = Field(default=0.0, ge=0, description="radius of the outer edge of its face [mm]")
    inner_radius: Length = Field(default=0.0, ge=0, description="radius of the inner edge of its face [mm]")

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        width = 0.5 * (self.outer_diameter - self.inner_diameter)
        if width <= 0:
            text = f"the opening of {self.inner_diameter:g} mm is not smaller than the ring"
            raise fault(text, f"take less than outer_diameter, {self.outer_diameter:g} mm", key="inner_diameter")
        if self.inner_radius > 0 and self.inner_diameter == 0:
            raise fault("a post has no inner edge", "leave it out, or give inner_diameter", key="inner_radius")
        if self.inner_radius + self.outer_radius > width * (1 + 1e-9):
            text = f"the radii of the edges do not fit a face {width:g} mm wide"
            raise fault(text, f"take at most {width:g} mm for both together", key="outer_radius")
        return self


class SectionTool(_Tool):
    """A tool of any closed section, straight along y or round z or x: steels and panels of a hem, dies of a tube."""

    shape: Literal["section"] = Field(description="any closed section, straight along y or round the axis z or x")
    plan: Literal["strip", "one_sided", "round", "round_x"] = Field(
        default="strip",
        description="strip: straight along y without end, on both sides of x = 0; one_sided: where its corners are "
        "alone; round: round z; round_x: round x, as a tube lies, its corners with z from the axis",
    )
    corners: tuple[Point, ...] = Field(
        min_length=3,
        description="corners [x, z] of its section in turn, x from the middle or the axis [mm]; a side on x = 0 is no "
        "surface unless it is one-sided; z = 0 is what touches the flat blank where no position is given",
    )
    radius: Length | tuple[Length, ...] = Field(
        default=0.0, description="of its corners: one for all (of a strip or round: off x = 0), or one each [mm]"
    )

    def radii(self) -> tuple[float, ...]:
        """Return the radius of each corner [mm]."""
        if isinstance(self.radius, tuple):
            return self.radius
        middle = 1 if self.plan == "round_x" else 0
        return tuple(
            0.0 if corner[middle] == 0.0 and self.plan != "one_sided" else self.radius for corner in self.corners
        )

    @model_validator(mode="after")
    def _check_section(self) -> Self:
        if len(self.radii()) != len(self.corners) or min(self.radii()) < 0.0:
            text = f"expected one value >= 0, or {len(self.corners)}, one for each corner"
            raise fault(text, "0 leaves a corner sharp; corners on x = 0 need 0", key="radius")
        try:
            if self.plan == "one_sided":
                draw_one_sided(self.corners, self.radii(), 1.0)
            elif self.plan == "round_x":
                draw_round_x(self.corners, self.radii())
            else:
                draw_section(self.corners, self.radii(), is_round=self.plan == "round")
        except SectionError as error:
            remedy = "mend the corners, or take smaller radii"
            if self.plan == "strip" and "beyond the middle" in str(error):
                remedy = 'a strip stands on both sides of x = 0: draw the right one, or take plan = "one_sided"'
            raise fault(str(error), remedy, key="corners") from None
        return self

    @property
    def stands_free(self) -> bool:
        """Whether it stands where it is drawn alone, with no image on the other side of the middle."""
        return self.plan in ("one_sided", "round_x")


class ToolFile(_Tool):
    """A tool's surface from an STL, STEP or IGES file, its normals out of the metal."""

    shape: Literal["file"] = Field(description="a surface from a file")
    path: FileName = Field(description="the file, STL, STEP or IGES, relative to the case file")
    unit: str = Field(
        default="mm",
        description="length unit of the file's coordinates, e.g. mm, m, inch; STEP, IGES hold their own",
    )
    tolerance: Length | None = Field(
        default=None,
        gt=0,
        description="STEP, IGES: largest distance of triangles from the surface [mm]; default: 1e-4 of its diagonal",
    )
    offset: Length = Field(
        default=0.0,
        description="distance by which the surface is moved back from the sheet along its normals [mm]; so far from "
        "the die's face a punch of the same file stands when both have closed",
    )
    cut: Trim | None = Field(
        default=None,
        description="line in the plan along which the surface is cut, after it was moved; keep names the side that is "
        "the tool: a punch is what lies inside the die's opening, a holder what lies outside",
    )

    @model_validator(mode="after")
    def _check_file(self) -> Self:
        if is_cad(self.path) and "unit" in self.model_fields_set and self.unit != "mm":
            raise fault("a CAD file holds its unit itself", "remove it", key="unit")
        if not is_cad(self.path) and self.tolerance is not None:
            raise fault("has no meaning with triangles", "remove it, or give a CAD file", key="tolerance")
        return self


DrawnTool = RoundTool | RectangularTool | StripTool | HemisphericalTool
Tool = Annotated[
    RoundTool | RectangularTool | StripTool | HemisphericalTool | RingTool | SectionTool | ToolFile,
    Field(discriminator="shape"),
]
