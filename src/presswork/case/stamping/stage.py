# SPDX-License-Identifier: Apache-2.0
"""Stages of a stamping, its drawbeads, and trimming after the last. Units as in schema.py."""

from __future__ import annotations

import itertools
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.names import Name
from presswork.case.part import Part
from presswork.case.press.builder import Timing
from presswork.case.press.schema import StagePress
from presswork.case.shell.schema import ShellDisplacement
from presswork.case.stamping.bead import Bead
from presswork.case.stamping.bead_geometry import BeadGeometry
from presswork.case.stamping.heat import Dwell
from presswork.case.stamping.pressure import StagePressure
from presswork.case.units import Force, Length, LineForce, Point, Time, Velocity, fault

VELOCITY = 2000.0
"""Velocity of the fastest tool where a stage sets none [mm/s]."""
Whole = Annotated[int, Field(strict=True, ge=1)]
ForceRow = tuple[Length, Force]


ACTIONS = ("stroke", "force", "close")
"""Keys of which a tool takes one in a stage."""


class ToolAction(Part):
    """What a tool does in a stage."""

    stroke: Length | None = Field(
        default=None,
        description="moves so far: punch and holder down, die up, or along the tool's direction; negative: back [mm]",
    )
    force: Force | tuple[ForceRow, ...] | None = Field(
        default=None,
        description="instead: pushes with this force on the whole part [N], or a table of rows [stroke of the punch in "
        "this stage, force]",
    )

    close: Length | None = Field(
        default=None,
        gt=0,
        description="instead: punch or holder goes on until so much room is left between its surface and the die's "
        "[mm], as a binder that wraps the blank; in a first operation it starts and stops over the whole stage",
    )

    @model_validator(mode="after")
    def _check_one_action(self) -> Self:
        present = [key for key in ACTIONS if getattr(self, key) is not None]
        if len(present) > 1:
            first, second = present[:2]
            raise fault(f"{first} and {second} are both given", f"leave {first} or {second} out", key=second)
        rows = self.force if isinstance(self.force, tuple) else ((0.0, self.force or 0.0),)
        if not rows or min(force for _, force in rows) < 0:
            raise fault("expected forces >= 0", "a tool pushes, it does not pull", key="force")
        if any(later[0] <= row[0] for row, later in itertools.pairwise(rows)):
            raise fault("the strokes of the table do not increase", "sort its rows", key="force")
        return self

    @property
    def travel(self) -> float:
        """How far it moves [mm]; 1 where that shows once the tools are placed."""
        return 1.0 if self.close is not None and self.stroke is None else self.stroke or 0.0

    @property
    def closes_softly(self) -> bool:
        """Whether it closes by a distance whose stroke is known by now."""
        return self.close is not None and self.stroke is not None


class StampingStage(Part):
    """A part of the process; all that moves starts and stops smoothly with it."""

    name: Name = Field(description="name of the stage")
    tools: dict[str, ToolAction] = Field(default={}, description="what each tool does; one not named stands still")
    pressure: dict[str, StagePressure] = Field(
        default={}, description="how each pressure on the sheet goes; one not named stays as it is"
    )
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
    def _check_single_timing(self) -> Self:
        if self.velocity is not None and self.duration is not None:
            raise fault("velocity and duration are both given", "give one of them", key="duration")
        if self.press is not None and self.ramp is not None:
            raise fault("a press neither starts nor stops smoothly", "leave it out", key="ramp")
        if self.press is not None and self.process_time is not None:
            raise fault("the press gives the time", "leave it out", key="process_time")
        return self

    def find_timing(self, number: int) -> Timing:
        """Return this stage's data for its press, with its number from 0."""
        has_time = self.duration is not None or self.velocity is not None
        travel = max((abs(action.stroke) for action in self.tools.values() if action.stroke), default=0.0)
        return Timing(f"stages.{number}", None, self.press, has_time, travel)


class StampingBead(Bead):
    """A drawbead between die and holder."""

    force: LineForce = Field(default=0.0, ge=0, description="restraining force per length [N/mm]")
    geometry: BeadGeometry | None = Field(
        default=None,
        description="instead of force and closing_force: the bead's section, from which both are found by pulling a "
        "strip of the blank's sheet through it",
    )
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

    @model_validator(mode="after")
    def _check_one_source(self) -> Self:
        present = self.model_fields_set
        if self.geometry is None and "force" not in present:
            raise fault("a bead needs a force", 'give it, "50 N/mm", or geometry', key="force")
        if self.geometry is not None and present & {"force", "closing_force"}:
            key = "force" if "force" in present else "closing_force"
            raise fault("the geometry gives the forces", "leave it out, or leave geometry out", key=key)
        return self


class Hem(Part):
    """A hem that the summary measures: its edge and roll-in, its thickness, how far its flange opens."""

    outward: Point | Literal["radial"] = Field(
        default="radial",
        description="direction [x, y] in the plan from the panel over the folded edge; radial: away from the axis z",
    )

    @model_validator(mode="after")
    def _check_direction(self) -> Self:
        if not isinstance(self.outward, str) and not any(self.outward):
            raise fault("has no length", "for instance [1, 0]", key="outward")
        return self

    def build(self) -> model.Hem:
        """Return the Model's."""
        return model.Hem(None if isinstance(self.outward, str) else self.outward)
