# SPDX-License-Identifier: Apache-2.0
"""What the stepping of the implicit procedure keeps in the State, and what it reports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from presswork.outcome import IterationLog
from presswork.state import RUN, Arrays, OnNewMesh


@dataclass
class Progress(Arrays):
    """How far a run has come, and how it steps on."""

    owner = "progress"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = dict.fromkeys(
        (
            "time", "stage", "fraction", "increments", "iterations", "cutbacks", "last_size", "next_size",
            "peak_force", "negative_pivots",
        ),
        RUN,
    )  # fmt: skip
    time: float = 0.0
    """[s]"""
    stage: int = 0
    """The stage that the next increment belongs to, counted from 0."""
    fraction: float = 0.0
    """Part of this stage that is computed."""
    increments: int = 0
    iterations: int = 0
    cutbacks: int = 0
    """Counts since the start."""
    last_size: float = 0.0
    """Size of the last increment: part of the stage, with arc length the arc [mm]; 0 when a stage begins."""
    next_size: float = 0.0
    """Size of the next increment, in the same form."""
    peak_force: float = 0.0
    """Largest nodal force so far [N]: what a residual is small beside once the load is taken off."""
    negative_pivots: int = 0
    """Negative pivots of the tangent of a shell that no tool leads: more than zero at an unstable equilibrium."""


@dataclass(frozen=True)
class IncrementReport:
    """One converged increment."""

    number: int
    stage: str
    fraction: float
    """Fraction of the stage at the end of the increment."""
    time: float
    log: IterationLog
    cutbacks: list[str] = field(default_factory=list)
    """Why each earlier attempt at this increment was cut back."""
    is_save_point: bool = False
