# SPDX-License-Identifier: Apache-2.0
"""Make the procedure that a model asks for; only that one is imported."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

import numpy as np

from presswork.explicit.input_checks import ExplicitError
from presswork.memory import TooLargeError, available_memory, check_memory, estimate_memory, explain_shortage
from presswork.model import Model
from presswork.observe.memory.goals import TEXTS
from presswork.outcome import ShortOfMemoryError, StartError
from presswork.process.run import Run
from presswork.ranks.world import World


def begin(model: Model, threads: int) -> Run:
    """Return the model's procedure before its first increment.

    Raises StartError if nothing can be computed from this start: as ShortOfMemoryError if the machine's memory does not
    hold it, as NotHeldError if the workpiece is free to move as a rigid body.
    """
    try:
        check_memory(model)
        run = choose(model, threads)
        _check_goals(model, run.columns)
        return run
    except ExplicitError as error:
        raise StartError(str(error)) from error
    except TooLargeError as error:
        raise ShortOfMemoryError(str(error)) from error
    except MemoryError as error:
        raise ShortOfMemoryError(explain_shortage(estimate_memory(model), available_memory())) from error


def _check_goals(model: Model, columns: Sequence[str]) -> None:
    """Raise StartError for goals of columns that a run does not have, and of runs of several parts."""
    if not model.limits.end:
        return
    is_line = model.following or model.trim or model.springback is not None or model.output.dynain
    if is_line or model.series is not None or model.gradients is not None:
        text = (
            "limits.end: operations, trimming, springback, dynain, a series and derivatives follow all stages of a run"
        )
        raise StartError(f"{text}; leave limits.end out, or compute the first operation alone")
    for number, goal in enumerate(model.limits.end):
        known = [column for column in columns if column not in TEXTS]
        if goal.column not in known:
            near = difflib.get_close_matches(goal.column, known, n=1)
            meant = f"did you mean `{near[0]}`? " if near else ""
            listed = ", ".join(known)
            raise StartError(f"limits.end.{number}.column: no such column: {goal.column}; {meant}(columns: {listed})")


def begin_formed_part(model: Model, threads: int, world: World | None = None) -> Run:
    """Return what goes on with a part that is formed already. world: ranks that share it. Raises StartError."""
    from presswork.process.line.formed_sheet import begin_formed
    from presswork.process.line.springback import LaidPart, ReleasedStamping
    from presswork.process.mesh_change.transfer import TransferError

    try:
        state = begin_formed(model)
        assert state is not None
        return ReleasedStamping(model, threads=threads, begin=LaidPart(state, np.eye(3)), world=world)
    except TransferError as error:
        raise StartError(str(error)) from error


def choose(model: Model, threads: int, world: World | None = None) -> Run:
    """Return the procedure that a model asks for. world: ranks that share it. Raises StartError, ExplicitError."""
    if model.gradients is not None:
        from presswork.process.derivatives.differentiated import begin_differentiated

        return begin_differentiated(model, threads)
    if model.formed is not None:
        return begin_formed_part(model, threads, world)
    if model.following:
        from presswork.process.line.press_line import PressLine

        return PressLine(model, threads=threads, world=world)
    if model.trim or model.springback is not None or model.output.dynain:
        from presswork.process.line.springback import ReleasedStamping

        return ReleasedStamping(model, threads=threads, world=world)
    if model.analysis == "stamping" and model.explicit is None:
        from presswork.process.implicit.stamping import ImplicitStamping

        return ImplicitStamping(model, threads=threads, world=world)
    if model.analysis == "stamping":
        from presswork.process.explicit.stamping import ExplicitStamping

        return ExplicitStamping(model, threads=threads, world=world)
    if model.heat is not None and model.heat.alone:
        from presswork.process.heat_run import HeatRun

        return HeatRun(model, threads=threads)
    if model.explicit is not None:
        from presswork.process.explicit.begin_forming import begin_explicit_forming

        return begin_explicit_forming(model, threads=threads, world=world)
    if model.series is not None:
        from presswork.process.line.series import SeriesForming

        return SeriesForming(model, threads=threads)
    from presswork.process.implicit.begin_forming import begin_forming

    return begin_forming(model, threads=threads, world=world)


def check_start(model: Model) -> Run:
    """Return the run at its start.

    Raises StartError if nothing can be computed: the workpiece is free to move, or lies in a tool, for instance.
    """
    return begin(model, threads=1)
