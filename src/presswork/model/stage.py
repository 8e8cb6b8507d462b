# SPDX-License-Identifier: Apache-2.0
"""Stages: what holds, moves and loads the workpiece and its tools."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from presswork.model.arrays import FloatArray
from presswork.model.heat import HeatStage
from presswork.model.press import Drive


@dataclass(frozen=True)
class Support:
    """Displacement components held at zero: symmetry planes, the axis, clamps."""

    node_set: str
    fix: tuple[bool, ...]
    """Whether x, y are held; of a solid in space x, y, z; of a shell also the rotations about x, y, z."""
    name: str = ""
    """Name under which its reaction is recorded; empty: it is not recorded."""
    normal: tuple[float, float, float] | None = None
    """For a solid in space: the unit vector along which the nodes are held, where it is not x, y or z; fix then names
    the components of their reaction."""


@dataclass(frozen=True)
class CyclicSector:
    """A sector of a body that is the same when it is turned about z by an n-th of a whole turn."""

    first: str
    """Node set of the face from which the other one comes by turning counter-clockwise."""
    last: str
    sectors: int
    """Number of sectors in the whole body, at least two."""


@dataclass(frozen=True)
class PrescribedDisplacement:
    """A displacement component that grows linearly over the stage by `value` [mm]; of a shell also a rotation [rad]."""

    node_set: str
    component: Literal[0, 1, 2, 3, 4, 5]
    value: float


@dataclass(frozen=True)
class PointForce:
    """A total force [N] on a node set, shared equally by its nodes, reached linearly at the end of the stage.

    In axisymmetry it is the force on the whole ring; in plane strain on the whole depth. On a solid in space it has
    x, y, z; on a shell also the moments about x, y, z [N mm]; its directions stay as they are.
    """

    node_set: str
    force: tuple[float, ...]


@dataclass(frozen=True)
class Pressure:
    """A follower pressure [MPa] on an edge set, positive into the body, reached linearly at the end of the stage."""

    edge_set: str
    value: float


@dataclass(frozen=True)
class ShellPressure:
    """A follower pressure [MPa] on the cells of a shell whose nodes are all in a set, along the cells' normals, reached
    linearly at the end of the stage.
    """

    node_set: str
    value: float


@dataclass(frozen=True)
class FacePressure:
    """A follower pressure [MPa] on a face set of a solid in space, positive into the body, reached linearly at the end
    of the stage.
    """

    face_set: str
    value: float


@dataclass(frozen=True)
class FaceForce:
    """A force per undeformed area [MPa] of fixed direction on a face set, reached linearly at the end of the stage."""

    face_set: str
    force: tuple[float, float, float]


@dataclass(frozen=True)
class EdgeForce:
    """A force of fixed direction on an edge set, by its undeformed size, reached linearly at the end of the stage.

    On a shell a force per length [N/mm], and a moment per length [N]; on a solid a force per area [MPa].
    """

    edge_set: str
    force: tuple[float, ...]
    """x, y; of a shell x, y, z; or x, y, z and the moments about them."""
    area: float | None = None
    """Area of the set when the run began [mm2]: the total force stays the same on new meshes of a solid in the plane.
    None: the area in the mesh."""


@dataclass(frozen=True)
class BodyForce:
    """A force per undeformed volume [N/mm3] on a whole shell, such as its weight, reached linearly at the end of the
    stage.
    """

    force: tuple[float, float, float]


@dataclass(frozen=True)
class Push:
    """A force that places a tool."""

    direction: tuple[float, ...]
    """Unit vector along which it pushes and the tool is free to move."""
    force: FloatArray
    """Rows of part of the stage (0 to 1, increasing) and force on the whole tool [N] (n, 2), linear between them and
    constant beyond. Before the first row it changes linearly from the tool's force when the stage began."""
    stop: str = ""
    """In space: name of a tool that no force places, on which this one stands at last; empty: none."""
    clearance: float = math.inf
    """Excess of its travel along direction over that of the other tool, since the start [mm]."""


@dataclass(frozen=True)
class ToolMotion:
    """What a tool does over a stage: it moves and turns in proportion, or pushes with a force."""

    move: tuple[float, ...] = (0.0, 0.0, 0.0)
    """Displacement [mm]; in the plane x and y."""
    turn: float = 0.0
    """Turn of a tool of solids: angle [rad], counter-clockwise, about the tool's centre, in space about its axis."""
    push: Push | None = None
    """Force that places the tool, instead of a move."""
    start: tuple[float, ...] | Literal["touch", "touch_again"] | None = None
    """Start of a tool of solids: position of the origin of its frame when the stage begins [mm], from which its stroke
    counts;
    touch: where the tool first touches the workpiece along its motion; touch_again: the same, but its stroke goes on;
    None: where the stage before has left it."""

    @property
    def moves(self) -> bool:
        """Whether the tool moves, turns or is pushed."""
        return any(self.move) or self.turn != 0.0 or self.push is not None


def find_direction(motion: ToolMotion, dimension: int = 3) -> FloatArray:
    """Return the unit vector along which a motion moves or pushes its tool (d,)."""
    direction = np.asarray(motion.push.direction if motion.push else motion.move[:dimension], dtype=np.float64)
    return np.asarray(direction / np.linalg.norm(direction))


@dataclass(frozen=True)
class HeldRate:
    """A strain rate of the pressed sheet at which a pressure is held between limits."""

    target: float
    """Equivalent strain rate of the middle surface [1/s]."""
    of: Literal["greatest", "mean"]
    """Strain of the cell that is strained fastest, or the mean over the pressed area."""
    least: float
    """Pressure that it begins with, and does not fall below [MPa]."""
    most: float
    """[MPa]"""


@dataclass(frozen=True)
class PressureCourse:
    """How a pressure on a sheet, or what has flowed into its fluid, goes over a stage."""

    rows: FloatArray
    """Part of the stage (0 to 1) and pressure [MPa], or volume since the start, of the whole part [mm3] (n, 2); linear
    between them."""
    over: Literal["way", "time"] = "way"
    """Whether the part is that of the travel of all that moves in the stage, or that of its time."""
    held: HeldRate | None = None
    """Strain rate from which the pressure follows in place of the rows."""


@dataclass(frozen=True)
class Dwell:
    """A stage of a stamping in which nothing moves, and heat alone flows."""

    in_tools: bool
    """Whether the tools lie on the sheet as the stage before has left them; otherwise it is in the air."""
    pressure: float | None = None
    """Pressure of the tools where they touch [MPa]; None: that of the end of the stage before."""


@dataclass(frozen=True)
class Stage:
    """A part of the process, in which motions go in proportion to the part that is done.

    Loads go linearly from their value at its beginning to that given, to zero where none is given.
    """

    name: str
    duration: float = 1.0
    """[s]; in increments it matters only to laws with a rate, to heat and to inertia."""
    ramp: float = 0.0
    """Explicit: time of the smooth start, and of the smooth end, of all motions [s], at most half the duration; 0:
    constant velocity."""
    clock: FloatArray | None = None
    """Shells: rows of part of the stage (0 to 1) and time [s] (n, 2), linear between them; None: in proportion."""
    tool_motion: Mapping[str, ToolMotion] = field(default_factory=dict)
    """Motion by name of tool; a tool that is not named stands still, or in a stamping keeps pushing."""
    bead_share: Mapping[str, FloatArray] = field(default_factory=dict)
    """Share of its force by name of drawbead: rows of part of the stage (0 to 1) and share (n, 2), linear between them;
    a bead that is not named holds with its whole force."""
    pressure_course: Mapping[str, PressureCourse] = field(default_factory=dict)
    """For stampings: course of each pressure on the sheet by its name."""
    prescribed: tuple[PrescribedDisplacement, ...] = ()
    forces: tuple[PointForce, ...] = ()
    pressures: tuple[Pressure, ...] = ()
    shell_pressures: tuple[ShellPressure, ...] = ()
    edge_forces: tuple[EdgeForce, ...] = ()
    face_pressures: tuple[FacePressure, ...] = ()
    face_forces: tuple[FaceForce, ...] = ()
    body_forces: tuple[BodyForce, ...] = ()
    released: tuple[str, ...] = ()
    """Names of the supports that do not hold in this stage."""
    heat: HeatStage | None = None
    drive: Drive | None = None
    """The ram that moves the tools, from which time follows; None: all moves evenly in time."""
    process_time: float | None = None
    """Duration of a stamping's stage in the press [s], which sets rates and the flow of heat; None: the duration."""
    dwell: Dwell | None = None
    """Dwell of a stamping's stage, in which only heat flows."""

    @property
    def slower(self) -> float:
        """Return how many times longer the stage takes in the press than in the computation."""
        return 1.0 if self.process_time is None else self.process_time / self.duration

    def time_between(self, start: float, end: float) -> float:
        """Return the time between two parts of the stage [s]; an estimate where the course of a stage decides."""
        if self.drive is not None and self.drive.is_prescribed:
            return self.drive.time_between(start, end)
        if self.clock is None:
            return self.duration * (end - start)
        first, last = np.interp([start, end], *self.clock.T)
        return float(last - first)
