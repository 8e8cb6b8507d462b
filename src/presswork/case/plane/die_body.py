# SPDX-License-Identifier: Apache-2.0
"""The body of a tool in the plane: its outline behind the profile, its steel, and rings shrunk onto it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Self

from pydantic import Field, ValidationError, model_validator

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.part import Part
from presswork.case.reader import list_problems, read_toml
from presswork.case.units import Length, Number, Point, Stress, fault

HELD = 'for instance held = ["bottom"], where it rests on the press'


class Fatigue(Part):
    """Strain amplitude against the number of cycles N: (strength/E) (2N)^b + ductility (2N)^c."""

    strength: Stress = Field(gt=0, description="fatigue strength coefficient [MPa]")
    strength_exponent: Number = Field(lt=0, gt=-1, description="b, negative, as -0.08")
    ductility: Number = Field(gt=0, description="fatigue ductility coefficient")
    ductility_exponent: Number = Field(lt=0, gt=-2, description="c, negative, as -0.7")


class DieSteel(Part):
    """An elastic die material, and what it bears."""

    young: Stress = Field(gt=0, description='Young\'s modulus [MPa], e.g. "210 kN/mm^2"; carbide has 450 to 650')
    poisson: Number = Field(ge=0, lt=0.5, description="Poisson's ratio")
    yield_stress: Stress | None = Field(
        default=None, gt=0, description="yield stress [MPa]; without it: no safety against yield"
    )
    tensile_strength: Stress | None = Field(
        default=None,
        gt=0,
        description="largest principal stress that a brittle material such as carbide bears [MPa]; without it: no "
        "safety against tension",
    )
    fatigue: Fatigue | None = Field(
        default=None, description="how many cycles it bears; `presswork dies` then finds the number of parts"
    )

    def build_steel(self) -> model.DieSteel:
        """Return the Model's."""
        return model.DieSteel(
            young=self.young,
            poisson=self.poisson,
            yield_stress=self.yield_stress,
            tensile_strength=self.tensile_strength,
            fatigue=None if self.fatigue is None else model.Fatigue(**self.fatigue.model_dump()),
        )


class DieRing(DieSteel):
    """A ring round a die, joined to the part inside with an interference; they may slide and part."""

    outer: Length = Field(gt=0, description="outer radius [mm]")
    bottom: Length | None = Field(
        default=None, description="y of its lower face [mm]; without it: that of the part inside"
    )
    top: Length | None = Field(
        default=None, description="y of its upper face [mm]; without it: that of the part inside"
    )
    interference: Length = Field(
        default=0.0, ge=0, description="by how much the part inside is larger in radius than the ring's bore [mm]"
    )
    held: tuple[model.Side, ...] | None = Field(
        default=None, description="sides that do not move across themselves; without it: those of the body"
    )


class DieBody(DieSteel):
    """The body of a tool, whose stress `presswork dies` finds after a run."""

    size: Length = Field(gt=0, description="size of cells at the profile; they grow away from it [mm]")
    outer: Length | None = Field(
        default=None,
        description="x of the upright outer side of the part that holds the profile [mm]; its faces are level from the "
        "ends of the profile, or from bottom and top",
    )
    bottom: Length | None = Field(
        default=None, description="y of the lower face [mm]; without it: that of the end of the profile there"
    )
    top: Length | None = Field(
        default=None, description="y of the upper face [mm]; without it: that of the end of the profile there"
    )
    corners: tuple[Point, ...] = Field(
        default=(),
        description="instead of outer: the other corners [x, y] from one end of the profile round [mm]",
    )
    held: tuple[model.Side, ...] = Field(
        default=(),
        description="sides that do not move across themselves, on the press or at a symmetry plane: bottom, top, left, "
        "right",
    )
    clamped: tuple[model.Side, ...] = Field(default=(), description="sides that do not move at all")
    rings: tuple[DieRing, ...] = Field(default=(), description="axisymmetric: rings round it, from inside outwards")

    @model_validator(mode="after")
    def _check_outline(self) -> Self:
        if self.corners and self.outer is not None:
            raise fault("corners and outer are both given", "give one of them", key="corners")
        for key in ("bottom", "top"):
            if getattr(self, key) is not None and self.outer is None:
                raise fault("has no meaning without outer", "add outer, or remove it", key=key)
        if self.bottom is not None and self.top is not None and self.bottom >= self.top:
            raise fault("the lower face is above the upper one", "give bottom < top", key="bottom")
        return self

    @model_validator(mode="after")
    def _check_held(self) -> Self:
        if not self.held and not self.clamped:
            raise fault("nothing holds the body", HELD, key="held")
        for number, ring in enumerate(self.rings):
            if ring.held is not None and not ring.held:
                raise fault("nothing holds the ring", HELD, key=f"rings.{number}.held")
        return self

    def build(self) -> model.DieBody:
        """Return the Model's body."""
        core = model.DiePart(
            steel=self.build_steel(),
            outer=self.outer,
            bottom=self.bottom,
            top=self.top,
            corners=self.corners,
            held=self.held,
            clamped=self.clamped,
        )
        rings = [
            model.DiePart(
                steel=ring.build_steel(),
                outer=ring.outer,
                bottom=ring.bottom,
                top=ring.top,
                held=self.held if ring.held is None else ring.held,
                clamped=self.clamped if ring.held is None else (),
                interference=ring.interference,
            )
            for ring in self.rings
        ]
        return model.DieBody(self.size, (core, *rings))


def check_rings(key: str, body: DieBody | None, analysis: str) -> list[Problem]:
    """Return the problem of rings that are none; key: of the body."""
    if body is None or not body.rings or analysis == "axisymmetric":
        return []
    return [Problem(f"{key}.rings", "a ring closes round an axis, and this analysis has none", "remove it")]


def has_bodies(path: Path) -> bool:
    """Return whether a tool of a case file has a body."""
    entries = read_toml(path)[0].get("tools", {})
    return any("body" in entry for entry in entries.values() if isinstance(entry, dict))


def read_bodies(path: Path, tools: Sequence[str] | None = None) -> dict[str, DieBody]:
    """Return the bodies of tools in a case file, or in a file of [tools.NAME.body] alone; tools: those wanted.

    Raises CaseError for a file without one, for a tool without one, and with every problem of those there are.
    """
    data, _ = read_toml(path)
    entries = data.get("tools", {})
    found = {name: entry["body"] for name, entry in entries.items() if isinstance(entry, dict) and "body" in entry}
    example = f"add [tools.{(tools or list(entries) or ['die'])[0]}.body], or give a file of it by --body"
    if not found:
        raise CaseError([Problem("tools", "no tool has a body", example)], path)
    for name in tools or ():
        if name not in found:
            raise CaseError([Problem(f"tools.{name}.body", "missing key", example)], path)
    bodies, problems = {}, []
    for name in tools or found:
        try:
            bodies[name] = DieBody.model_validate(found[name])
        except ValidationError as error:
            own = list_problems(error, found[name], DieBody.model_json_schema())
            problems += [replace(each, key=f"tools.{name}.body.{each.key}".rstrip(".")) for each in own]
    if problems:
        raise CaseError(problems, path)
    return bodies
