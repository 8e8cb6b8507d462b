# SPDX-License-Identifier: Apache-2.0
"""How fast flow localises, as in a neck: the load falls, and ever less of the body flows, ever faster
(docs/theory/time_steps.md).

Equilibrium at the end of an increment decides on the flow of the whole increment. Where the flow pattern grows by
itself, half the change from increment to increment is an error that adds up: the neck runs ahead.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import log
from typing import ClassVar

import numpy as np

from presswork.outcome import Step
from presswork.state import RUN, Arrays, OnNewMesh, State

WINDOW = 0.05
"""Part of a stage over which changes are averaged, so that ripples of contact cancel."""

EARLY = 10.0
"""Largest rate of localisation over the rate by which the load falls: a steady load costs nothing."""

FASTER = 2.0
"""Rate of localisation over the rate by which flow becomes faster: in a neck its room shrinks about as fast."""

FLOWS = 0.05
"""Plastic strain per stage below which a body does not flow: what relaxes or springs back has no neck."""


@dataclass
class Localisation(Arrays):
    """What load and flow have come to, and how fast both change."""

    owner = "localisation"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = dict.fromkeys(
        ("load", "room", "pace", "load_rate", "room_rate", "pace_rate"), RUN
    )
    load: float = 0.0
    """Work of what drives the body in the last increment, over its part of the stage [N mm]; 0: none, or taken back."""
    room: float = 0.0
    """Part of the body that would flow if flow were even; 0: nothing flows."""
    pace: float = 0.0
    """Mean plastic strain where the body flows, per stage; 0: nothing flows."""
    load_rate: float = 0.0
    room_rate: float = 0.0
    pace_rate: float = 0.0
    """How fast the logarithms of the three change, per stage."""

    def begin_stage(self) -> None:
        """Forget what was before."""
        self.load = self.room = self.pace = self.load_rate = self.room_rate = self.pace_rate = 0.0

    @property
    def rate(self) -> float:
        """How fast flow localises, per stage; 0: it does not.

        In a neck flow becomes faster as its room shrinks; in a body that unloads or is bent at a hinge it does not.
        """
        return max(min(-self.room_rate, self.pace_rate * FASTER, -self.load_rate * EARLY), 0.0)


def note_localisation(state_n: State, trial: State, step: Step) -> None:
    """Note load and flow of a converged increment in its trial state."""
    kept, part = trial[Localisation], step.fraction - step.fraction_n
    if step.fraction_n == 0.0:
        kept.begin_stage()
    room, strain = _find_flow(state_n, trial)
    load = _find_load(trial) / part if strain > FLOWS * part else 0.0
    weight = part / (part + WINDOW)
    for name, now in (("load", load), ("room", room), ("pace", strain / part)):
        before, rate = getattr(kept, name), getattr(kept, f"{name}_rate")
        change = log(now / before) / part if now > 0.0 and before > 0.0 else 0.0
        setattr(kept, f"{name}_rate", rate + weight * (change - rate))
        setattr(kept, name, max(now, 0.0))


def _find_load(trial: State) -> float:
    nodes = trial.nodes
    return float((nodes.reaction[:, :3] * nodes.increment[:, :3]).sum())


def _find_flow(state_n: State, trial: State) -> tuple[float, float]:
    """Return the part of the body that would flow if flow were even, and its plastic strain in the increment."""
    total = squares = whole = 0.0
    for before, after, volume in zip(state_n.cells.eqps, trial.cells.eqps, trial.cells.volume, strict=True):
        grown = np.maximum(after - before, 0.0)
        total, squares = total + float((volume * grown).sum()), squares + float((volume * grown**2).sum())
        whole += float(volume.sum())
    return (total**2 / (squares * whole), squares / total) if squares > 0.0 else (0.0, 0.0)
