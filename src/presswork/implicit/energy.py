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

import numpy as np

from presswork.model import BoolArray
from presswork.state import CONTACT, EXTERNAL, FRICTION, INERTIA, PLASTIC, State


def add_external_work(state_n: State, trial: State, fixed_n: BoolArray, fixed: BoolArray) -> None:
    """Add the work of plane tools, supports and loads in an increment to that of the trial state.

    fixed_n, fixed (n_points, freedoms): what supports and prescribed displacements hold at state_n, and in the
    increment. What they let go of at the start of a stage loses its reaction over the first increment.
    """
    on_nodes = state_n.reaction * fixed_n + trial.reaction * fixed + state_n.external_force + trial.external_force
    moved = np.column_stack(
        [trial.tool_displacement - state_n.tool_displacement, trial.tool_angle - state_n.tool_angle]
    )
    of_tools = -float(((state_n.tool_force + trial.tool_force) * moved).sum())
    trial.work[EXTERNAL] += 0.5 * (float((on_nodes * trial.increment).sum()) + of_tools)


PLACES = {
    "external_work": EXTERNAL,
    "plastic_work": PLASTIC,
    "friction_work": FRICTION,
    "inertia_work": INERTIA,
    "contact_energy": CONTACT,
}
"""Places in State.work by the names of balance()."""


def add_work(trial: State, work: Mapping[str, float]) -> None:
    """Add work done in an increment, by the names of balance() [N mm], to that of the trial state."""
    for name, value in work.items():
        trial.work[PLACES[name]] += value


def balance(state: State, elastic_energy: float) -> dict[str, float]:
    """Return both sides [N mm], and what is missing between them in per cent of the larger."""
    inside = {
        "elastic_energy": elastic_energy,
        "plastic_work": float(state.work[PLASTIC]),
        "friction_work": float(state.work[FRICTION]),
        "inertia_work": float(state.work[INERTIA]),
        "contact_energy": float(state.work[CONTACT]),
    }
    external, total = float(state.work[EXTERNAL]), sum(inside.values())
    largest = max(abs(external), abs(total), 1e-300)
    return {"external_work": external, **inside, "error_percent": 100.0 * (external - total) / largest}
