# SPDX-License-Identifier: Apache-2.0
"""How long an explicit run takes on this machine, by some of its cycles: at rest, and while all of it flows."""

from __future__ import annotations

from contextlib import suppress
from time import process_time

import numpy as np

from presswork.explicit.dynamics import Dynamics
from presswork.explicit.input_checks import ExplicitError
from presswork.model import ExplicitSheet, ExplicitSolid, Model
from presswork.process.run import Run

_FLOWING = 0.4
"""Share of the cells that flow, in the mean of a run."""
_STRAIN, _CYCLES = 5e-5, 200
"""Strain of a cycle in which all flows, and cycles after which it does."""
_SHORT = 0.1
"""Step of measured cycles over the run's, since nothing adapts it."""
_BATCH, _REPEATS, _MOST = 0.01, 3, 0.5
"""Time of cycles that are measured at once [s], how often, and the time that may be spent on flow [s]."""
_FLOWS = 2.0
"""Time of a cycle in which all flows over that of one at rest, where it is not measured."""
_OF_RUN, _OF_ROW, _OF_CELL_AND_ROW, _OF_STEP = 1.0, 4e-3, 9e-6, 0.15
"""Time of a run that is not cycles [s]: start and end, a row of the history, a cell in it, and a saved step."""


def estimate_seconds(run: Run) -> float | None:
    """Return about how long one core takes [s] for a run at its start; None of procedures without explicit cycles.

    The run has computed cycles then, and is of no other use.
    """
    at_work = run.at_work()
    loop = getattr(at_work, "shells", None) or getattr(at_work, "solids", None)
    if at_work is None or not isinstance(loop, Dynamics):
        return None
    model, explicit = at_work.model, at_work.model.explicit
    if not isinstance(explicit, ExplicitSheet | ExplicitSolid) or explicit.device != "cpu":
        return None
    step = explicit.target_step or explicit.safety * loop.stable_step()
    operations = [model, *(model.of_operation(k) for k in range(1, len(model.following) + 1))]
    stages = [stage for each in operations for stage in each.stages]
    duration = sum(stage.duration for stage in stages if stage.dwell is None)
    try:
        pace = _measure_cycle(loop, _SHORT * min(step, loop.dt))
    except ExplicitError:
        return None
    return pace * duration / step + len(stages) * _time_output(model)


def _time_output(model: Model) -> float:
    """Return the time for what is recorded of a stage [s]."""
    cells = sum(len(block.connectivity) for block in model.mesh.blocks)
    return _OF_RUN + model.output.rows * (_OF_ROW + cells * _OF_CELL_AND_ROW) + model.output.steps * _OF_STEP


def _measure_cycle(loop: Dynamics, step: float) -> float:
    """Return the time of a cycle in the mean of a run [s]."""
    loop.dt = step
    rest = _time_cycles(loop, 0.0)
    flow = _FLOWS * rest
    if _CYCLES * flow < _MOST:
        with suppress(ExplicitError):  # a body that flies at a wall is not stretched
            flow = max(_time_flow(loop), rest)
    return rest + _FLOWING * (flow - rest)


def _time_flow(loop: Dynamics) -> float:
    """Return the time of a cycle in which all is stretched along x and y [s]."""
    position = np.asarray(loop.position)
    for axis, letter in zip(range(2), loop.FREEDOMS, strict=False):
        loop.fix(np.arange(len(position)), letter, _STRAIN / loop.dt * position[:, axis])
    loop.advance(_CYCLES)
    return _time_cycles(loop, 1.0)


def _time_cycles(loop: Dynamics, scale: float) -> float:
    """Return the least time of a cycle [s]; scale: of prescribed velocities."""
    count, least = 1, np.inf
    for _ in range(_REPEATS + 1):
        started = process_time()
        loop.advance(count, velocity_scale=scale)
        least = min(least, (process_time() - started) / count)
        count = max(1, min(100, round(_BATCH / max(least, 1e-9))))
    return float(least)
