# SPDX-License-Identifier: Apache-2.0
"""How long increments of a stage are, where they must end, and which of them are saved."""

from __future__ import annotations

import numpy as np

from presswork.implicit.progress import Progress
from presswork.model import FloatArray, Model, SolverSettings
from presswork.outcome import IterationLog

GROWTH = 1.5
SMALLEST = 10.0
"""Smallest size of increments that converge slowly, over min_increment, or the run would not end."""


def list_ends(model: Model, stage: int) -> FloatArray:
    """Return the fractions of a stage at which an increment must end and fields are saved; the last is 1.

    Saved steps that lie closer together than the largest increment end none: they would make it smaller.
    """
    output = model.output
    end_increments = output.every == 0 and not output.is_closer_than(model.solver.max_increment)
    points = list(np.linspace(0, 1, output.steps + 1)[1:]) if end_increments else []
    if stage == len(model.stages) - 1:
        points += output.at
    return np.unique(np.round([*points, 1.0], 12))


def is_saved(model: Model, number: int, fraction_n: float, fraction: float, *, at_end: bool) -> bool:
    """Return whether an increment of a stage is saved: every so many, or what passes one of the equal steps.

    number: of the increment. at_end: it ends where one must, which is always saved.
    """
    output = model.output
    if output.every:
        return at_end or number % output.every == 0
    before, now = (np.floor(f * output.steps * (1 + 1e-12)) for f in (fraction_n, fraction))
    return at_end or bool(now != before)


def find_next_size(settings: SolverSettings, size: float, log: IterationLog, cutbacks: int) -> float:
    """Return the part of the stage that the next increment takes as far as iterations count.

    size: that this one was to take.
    """
    if len(log) <= settings.target_iterations and not cutbacks:
        size = min(size * GROWTH, settings.max_increment)
    elif log.smooth_iterations > settings.target_iterations + 4:
        size = max(0.7 * size, min(size, SMALLEST * settings.min_increment))
    return size


def find_remaining(model: Model, progress: Progress) -> float:
    """Return the part of the whole process still to be computed, counted in stage durations."""
    stage, fraction = progress.stage, progress.fraction
    durations = np.array([s.duration for s in model.stages])
    done = durations[:stage].sum() + (durations[stage] * fraction if stage < len(durations) else 0.0)
    return float(1.0 - done / durations.sum())
