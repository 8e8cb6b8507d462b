# SPDX-License-Identifier: Apache-2.0
"""A process that is computed in rows of cycles: as many in every stage, each a row of the history."""

from __future__ import annotations

from collections.abc import Sequence


def remaining_in_rows(durations: Sequence[float], stage: int, row: int, rows: int) -> float:
    """Return the part of a process that is left after so many rows of a stage, by the durations of its stages.

    >>> remaining_in_rows([1.0, 3.0], stage=1, row=5, rows=10)
    0.375
    """
    if stage == len(durations):
        return 0.0
    return 1.0 - (sum(durations[:stage]) + durations[stage] * row / rows) / sum(durations)


def require_rows(found: float, wanted: int) -> None:
    """Raise ValueError for a checkpoint of a run with another number of rows, which its cycles depend on."""
    if found != wanted:
        raise ValueError(f"the checkpoint is of a run with output.rows = {found:g}, on which its steps depend")
