# SPDX-License-Identifier: Apache-2.0
"""Operations of a press line: what a stamped part goes through after its first tools."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from presswork.model.sheet import Hem, Springback, TrimLine
from presswork.model.stage import Stage, Support
from presswork.model.tool import Drawbead, Tool


@dataclass(frozen=True)
class PartPlace:
    """How a part is laid into an operation: turned over, then turned, then moved, from where the one before left it."""

    over: Literal["x", "y"] | None = None
    """Axis through the origin about which it is turned by 180 degrees; None: it is not turned over."""
    turn: float = 0.0
    """Angle about z, counter-clockwise [rad]."""
    move: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """[mm]"""
    tips: bool = False
    """Whether it then sinks and tips until its weight rests on the dies."""


@dataclass(frozen=True)
class Closing:
    """A tool that goes on in a stage until it leaves a given room to dies; how far that is shows when the part lies."""

    stage: int
    tool: str
    dies: tuple[str, ...]
    gap: float
    """Room that is left [mm]."""
    is_timed: bool
    """Whether the stage has a duration of its own; else the Model has that of a travel of 1 mm."""


@dataclass(frozen=True)
class Operation:
    """An operation of a press line after the first one, with tools of its own.

    Names of its tools, beads, stages and trim lines begin with its own.
    """

    name: str
    tools: tuple[Tool, ...]
    supports: tuple[Support, ...]
    stages: tuple[Stage, ...]
    beads: tuple[Drawbead, ...] = ()
    trim: tuple[TrimLine, ...] = ()
    springback: Springback | None = None
    hem: Hem | None = None
    place: PartPlace = PartPlace()
    laid: tuple[str, ...] = ()
    """Names of tools whose height is where they just touch the part; their position gives x and y."""
    spaced: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Tools that are placed relative to another one: by name, the other tool, and how much higher the position is than
    that of the other [mm]."""
    closings: tuple[Closing, ...] = ()
