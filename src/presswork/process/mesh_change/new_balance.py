# SPDX-License-Identifier: Apache-2.0
"""Equilibrium of a state that has come to a new mesh.

Metal that flows answers any disturbance by yielding, so a tool at rest loses force: 1 to 3 % until it moves on. Where
the motion of tools alone drives the metal, it therefore responds elastically. That disturbs the force by no more than
the transfer does (0.1 to 0.4 %), and leaves stresses beyond the flow stress by half a per cent, which the next
increment returns to the law while the tools drive the flow. Metal that softens as it warms, or hardens with the rate,
does so, too. Where a point would come beyond MOST_BEYOND times its flow stress (a pocket of a full die has closed), it
flows.

A force that stays would press such metal on beyond its limit load. So metal under loads or pushed tools responds by its
law, and so it does when a stage has ended and the next one releases it.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace

import numpy as np

from presswork.body.solids import Mechanics
from presswork.implicit.epochs import balance_at_rest
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.law.elastic_plastic import is_plain
from presswork.model import Model
from presswork.outcome import Converged, Failed
from presswork.state import State

MOST_BEYOND = 3.0
"""Effective stress over the flow stress up to which metal may answer a new mesh elastically."""


def balance_new_mesh(
    run: ImplicitProcedure, *, may_yield: bool = False, beside: Sequence[ImplicitProcedure] = ()
) -> Converged | Failed:
    """Find equilibrium with the tools at rest; run.state is converged then.

    may_yield: the metal follows its law. beside: neighbours of the run, whose metal answers as its own does.
    """
    model = run.model
    isotropic = all(is_plain(replace(m, heating=None, rate=None)) for m in model.materials)
    if may_yield or run.state[Progress].fraction == 0.0 or not isotropic or not _is_driven_by_motion(model):
        return balance_at_rest(run)
    with ExitStack() as stack:
        for each in (run, *beside):
            assert isinstance(each.mechanics, Mechanics)
            stack.enter_context(each.mechanics.answering_elastically(MOST_BEYOND))
        outcome = balance_at_rest(run)
    return balance_at_rest(run) if isinstance(outcome, Failed) else outcome


def _is_driven_by_motion(model: Model) -> bool:
    """Return whether no load, no weight and no force on a tool acts in any stage."""
    return not model.gravity and not any(
        stage.forces or stage.pressures or stage.edge_forces or stage.face_forces or stage.face_pressures
        or stage.body_forces or stage.drive or any(motion.push for motion in stage.tool_motion.values())
        for stage in model.stages
    )  # fmt: skip


def measure_jump(before: State, after: State) -> float:
    """Return the largest change of a tool's force over the largest force."""
    if SpaceToolArrays in before:
        force, force_n = (state[SpaceToolArrays].force.sum(axis=1) for state in (after, before))
    elif ToolArrays in before:
        force, force_n = (state[ToolArrays].force[:, :2] for state in (after, before))
    else:
        return 0.0
    largest = float(np.abs(force_n).max(initial=0.0))
    return float(np.abs(force - force_n).max(initial=0.0)) / largest if largest > 0.0 else 0.0
