# SPDX-License-Identifier: Apache-2.0
"""Energy balance of the implicit procedure: what comes in from outside against what the bodies store and lose.

Each side follows from physical power by itself, so that a wrong force or slip shows as an error:

    external   forces of the tools times their own motion, reactions times prescribed displacements, loads times the
               displacement of their nodes
    inside     elastic energy, plastic work, friction times slip, inertia and damping, energy of elastic contact

All are integrated over an increment by the trapezoidal rule. Friction, sheet contact and bodies add their own losses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from presswork.model import BoolArray
from presswork.state import RUN, Arrays, OnNewMesh, State


@dataclass
class Work(Arrays):
    """Work done since the start [N mm], by the names of energy.balance."""

    owner = "work"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = dict.fromkeys(
        ("external_work", "plastic_work", "friction_work", "inertia_work", "thermal_work"), RUN
    )
    external_work: float = 0.0
    """External work of tools, supports and loads."""
    plastic_work: float = 0.0
    friction_work: float = 0.0
    """Lost on tools, beads and between bodies."""
    inertia_work: float = 0.0
    """Against inertia and damping."""
    thermal_work: float = 0.0
    """Work of the stress on thermal strain, and the elastic energy that moduli lose as they fall with temperature."""


def add_external_work(state_n: State, trial: State, fixed_n: BoolArray, fixed: BoolArray) -> None:
    """Add the work of supports and loads in an increment to that of the trial state.

    fixed_n, fixed (n_points, freedoms): what supports and prescribed displacements hold at state_n, and in the
    increment. What they release at the start of a stage loses its reaction over the first increment.
    """
    on_nodes = (
        state_n.nodes.reaction * fixed_n
        + trial.nodes.reaction * fixed
        + state_n.nodes.external_force
        + trial.nodes.external_force
    )
    trial[Work].external_work += 0.5 * float((on_nodes * trial.nodes.increment).sum())


def add_work(trial: State, work: Mapping[str, float]) -> None:
    """Add work done in an increment, by the names of balance() [N mm], to that of the trial state."""
    total = trial[Work]
    for name, value in work.items():
        setattr(total, name, getattr(total, name) + value)


def balance(state: State, elastic_energy: float, contact_energy: float) -> dict[str, float]:
    """Return both sides [N mm], and what is missing between them in per cent of the larger, or of the thermal work.

    elastic_energy, contact_energy: stored in the cells, and in the interactions.
    """
    work = state[Work]
    inside = {
        "elastic_energy": elastic_energy,
        "plastic_work": work.plastic_work,
        "friction_work": work.friction_work,
        "inertia_work": work.inertia_work,
        "contact_energy": contact_energy,
    }
    if work.thermal_work:
        inside["thermal_work"] = work.thermal_work
    external, total = work.external_work, sum(inside.values())
    largest = max(abs(external), abs(total), abs(work.thermal_work), 1e-300)
    return {"external_work": external, **inside, "error_percent": 100.0 * (external - total) / largest}
