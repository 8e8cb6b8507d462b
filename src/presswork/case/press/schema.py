# SPDX-License-Identifier: Apache-2.0
"""The presses of a case, and the keys of a stage for the press that drives it."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Annotated, Any, Literal, Self

from pydantic import Field, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from presswork import model
from presswork.case.names import Name
from presswork.case.part import Part
from presswork.case.units import Angle, Energy, Force, Length, Mass, Number, Power, Time, Velocity, fault

GRAVITY = 9806.65
"""Standard acceleration of free fall [mm/s2]."""
N_MM = 1e6
"""Energy in a kJ."""
TONNE = 1e-3
"""Mass in a kg."""
RATED_ANGLE = 30.0
"""Crank angle before bottom dead centre at which presses are rated [degree]."""
MOST_BLOWS = 1000
Speeds = Velocity | tuple[tuple[Length, Velocity], ...]
"""A speed, or rows of travel and speed."""


def check_speeds(speeds: Speeds | None, key: str) -> None:
    """Refuse speeds that no ram can have."""
    if speeds is None:
        return
    rows = speeds if isinstance(speeds, tuple) else ((0.0, speeds),)
    if not rows or min(speed for _, speed in rows) <= 0:
        raise fault("expected speeds > 0", "for instance 100, or rows [[0, 100], [20, 10]]: travel, speed", key=key)
    if rows[0][0] != 0.0 or any(later[0] <= row[0] for row, later in itertools.pairwise(rows)):
        raise fault("expected travels that increase from 0", "for instance [[0, 100], [20, 10]]", key=key)


def tabulate(speeds: Speeds) -> model.SpeedTable:
    """Return the Model's table of speeds."""
    import numpy as np

    return model.SpeedTable(np.array(speeds if isinstance(speeds, tuple) else [(0.0, speeds)], dtype=float))


class CrankPress(Part):
    """A mechanical press: a crank that turns at constant speed moves the ram by a connecting rod."""

    kind: Literal["crank"] = Field(description="a slider-crank drive")
    stroke: Length = Field(gt=0, description="stroke of the press, twice the radius of the crank [mm]")
    rpm: Number = Field(gt=0, le=1e5, description="turns of the crank a minute")
    rod_ratio: Number = Field(
        ge=0, lt=1, description="radius of the crank over the length of the connecting rod; 0: a rod of infinite length"
    )

    force: Force | None = Field(
        default=None,
        gt=0,
        description="rated force, which the press bears near bottom dead centre [N]; higher up the torque of its drive "
        "allows less; the run warns where the ram needs more",
    )
    rated_angle: Angle | None = Field(
        default=None,
        gt=0,
        lt=90,
        description="crank angle before bottom dead centre from which on the press bears its rated force [degree]; 30 "
        "without it",
    )
    rated_height: Length | None = Field(
        default=None, gt=0, description="instead of an angle: height of the ram above bottom dead centre there [mm]"
    )
    energy: Energy | None = Field(
        default=None, gt=0, description="that the flywheel gives in one stroke [kJ]; the run warns where it needs more"
    )

    @model_validator(mode="after")
    def _check_rating(self) -> Self:
        if self.rated_angle is not None and self.rated_height is not None:
            raise fault("rated_angle and rated_height are both given", "give one of them", key="rated_height")
        key = "rated_angle" if self.rated_angle is not None else "rated_height"
        if self.force is None and getattr(self, key) is not None:
            raise fault("it is where the rated force begins, and there is none", "give force, too", key=key)
        if self.rated_height is not None and self.rated_height >= 0.5 * self.stroke:
            most = f"a press of this stroke has its rated force within the last {0.5 * self.stroke:g} mm"
            raise fault(f"expected less than half the stroke: {most}", "for instance 6 mm", key="rated_height")
        return self

    def place(self, start: float) -> model.Crank:
        """Return the drive from a distance before bottom dead centre on [mm]."""
        crank = model.Crank(0.5 * self.stroke, self.rod_ratio, 2.0 * math.pi * self.rpm / 60.0, start)
        angle = RATED_ANGLE if self.rated_angle is None else self.rated_angle
        height = crank.height_at(math.radians(angle)) if self.rated_height is None else self.rated_height
        return replace(crank, rated_height=height)


class HydraulicPress(Part):
    """A hydraulic press: a speed, with limits of force and power."""

    kind: Literal["hydraulic"] = Field(description="a ram whose speed is given")
    velocity: Speeds = Field(description="speed of the ram [mm/s], or rows [travel in the stage, speed]")
    force: Force | None = Field(default=None, gt=0, description="largest force [N]: the stage ends where it is reached")
    power: Power | None = Field(
        default=None, gt=0, description="largest power [kW]: the ram slows down where force times speed would exceed it"
    )

    @model_validator(mode="after")
    def _check_speeds(self) -> Self:
        check_speeds(self.velocity, "velocity")
        return self


class EnergyPress(Part):
    """A hammer or a screw press: the ram strikes with its kinetic energy, and the blow ends when that is spent.

    Two of energy, velocity and mass are given, the velocity also by the height of a free fall.
    """

    kind: Literal["hammer", "screw"] = Field(description="a ram driven by its kinetic energy")
    energy: Energy | None = Field(
        default=None, gt=0, description="kinetic energy of ram and flywheel when it strikes [kJ]"
    )
    velocity: Velocity | None = Field(default=None, gt=0, description="speed of the ram when it strikes [mm/s]")
    mass: Mass | None = Field(default=None, gt=0, description="mass of the ram with the upper die [kg]")
    height: Length | None = Field(default=None, gt=0, description="instead of a velocity: height of its free fall [mm]")
    efficiency: Number = Field(
        gt=0,
        le=1,
        description="part of the kinetic energy that the workpiece takes; anvil and frame take the rest",
    )
    force: Force | None = Field(
        default=None, gt=0, description="screw: force that the frame bears [N]; the run warns where the blow needs more"
    )

    @model_validator(mode="after")
    def _check_two_of_three(self) -> Self:
        if self.velocity is not None and self.height is not None:
            raise fault("velocity and height are both given", "the height of its fall gives the velocity", key="height")
        if self.kind == "hammer" and self.force is not None:
            raise fault("a hammer has no frame that bears its force", "leave it out", key="force")
        if self.kind == "screw" and (self.height is not None or self.mass is not None):
            key = "height" if self.height is not None else "mass"
            raise fault("a screw press stores its energy in the flywheel", "give energy and velocity", key=key)
        speed = self.velocity if self.velocity is not None else self.height
        present = [name for name, value in (("energy", self.energy), ("velocity", speed), ("mass", self.mass)) if value]
        if len(present) != 2:
            remedy = "give two of: energy, velocity (or height), mass"
            if self.kind == "screw":
                remedy = "give energy and velocity"
            raise fault(f"expected two quantities, and found {', '.join(present) or 'none'}", remedy, key="energy")
        return self

    def strike(self, number: int) -> model.Blow:
        """Return a blow."""
        velocity = math.sqrt(2.0 * GRAVITY * self.height) if self.height is not None else self.velocity
        if self.energy is not None:
            energy = self.energy * N_MM
        else:
            assert self.mass is not None
            assert velocity is not None
            energy = 0.5 * self.mass * TONNE * velocity**2
        if velocity is None:
            assert self.mass is not None
            velocity = math.sqrt(2.0 * energy / (self.mass * TONNE))
        return model.Blow(self.efficiency * energy, velocity, number)


Press = Annotated[CrankPress | HydraulicPress | EnergyPress, Field(discriminator="kind")]


class StagePress(Part):
    """The press that drives a stage; short form: its name."""

    name: str = Field(description="name of one of the [presses]")
    before_bottom: Length | None = Field(
        default=None,
        gt=0,
        description="crank: distance of the ram from bottom dead centre as the stage begins [mm]; without: its travel, "
        "so that the stage ends there",
    )
    angle_before_bottom: Angle | None = Field(
        default=None, gt=0, le=180, description="crank, instead: angle before bottom dead centre [degree]"
    )
    blows: Annotated[int, Field(strict=True)] = Field(
        default=1, ge=1, le=MOST_BLOWS, description="hammer, screw: blows, each from where the tools touch"
    )
    pause: Time | None = Field(
        default=None, gt=0, description="hammer, screw: time between two blows [s], in which the tools go back"
    )

    @model_validator(mode="before")
    @classmethod
    def _take_name(cls, data: Any) -> Any:
        return {"name": data} if isinstance(data, str) else data

    @model_validator(mode="after")
    def _check_one_start(self) -> Self:
        if self.before_bottom is not None and self.angle_before_bottom is not None:
            remedy = "give one of them"
            raise fault("before_bottom and angle_before_bottom are both given", remedy, key="angle_before_bottom")
        if self.pause is not None and self.blows == 1:
            raise fault("a single blow has no pause", "leave it out, or give blows", key="pause")
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {"anyOf": [handler.resolve_ref_schema(handler(core_schema)), {"type": "string"}]}


Presses = dict[Name, Press]
