# SPDX-License-Identifier: Apache-2.0
"""Whether the equilibrium that an increment of a shell has found is stable.

The tangent of a stable equilibrium has no negative pivot. Newton's method does not ask for that: where a shell snaps
from wrinkle to wrinkle, it may come to an unstable branch, which ends at a limit load that the shell never meets. So an
increment that ends with more negative pivots than it began with is made shorter, which keeps to the stable branch. Past
a bifurcation no shorter increment has fewer; then the run follows the unstable branch, as an imperfection would have to
lead it to another one.
"""

from __future__ import annotations

from presswork.implicit.progress import Progress
from presswork.model import Model
from presswork.outcome import Converged, Failed
from presswork.state import State

BELIEVED = 0.1
"""Smallest increment over the one first tried at which instability is believed."""


def shows_stability(model: Model) -> bool:
    """Return whether negative pivots show instability: for shells that no tool leads, under loads with a potential.

    Moments about axes that stay have none: they make the tangent unsymmetric.
    """
    forces = [load.force for stage in model.stages for load in stage.forces]
    forces += [load.force for stage in model.stages for load in stage.edge_forces]
    return model.analysis == "shell" and not model.space_tools and not any(any(force[3:]) for force in forces)


def judge_stability(
    state_n: State, trial: State, found: Converged, pivots: int, *, is_shortest: bool
) -> Converged | Failed:
    """Return an equilibrium that is as stable as the one before, or why its increment is made shorter.

    pivots: how many of the last tangent are negative.
    """
    trial[Progress].negative_pivots = pivots
    if pivots <= state_n[Progress].negative_pivots or is_shortest:
        return found
    many = f"{pivots} negative pivots" if pivots > 1 else "a negative pivot"
    return Failed(found.log, f"the equilibrium is unstable, its tangent has {many}", 0.5)
