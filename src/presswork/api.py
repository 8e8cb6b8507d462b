# SPDX-License-Identifier: Apache-2.0
"""The way from a case to its results in one call."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from presswork.case import Case, ShellCase, StampingCase, build_model
from presswork.recorder import Outcome, Progress, run_model


def run(
    case: Case | ShellCase | StampingCase,
    folder: Path | str,
    *,
    overwrite: bool = False,
    resume: bool = False,
    threads: int = 0,
    on_increment: Callable[[Progress], None] | None = None,
) -> Outcome:
    """Compute a case into a folder and return how it ended; `.result` reads what it wrote.

    `threads` 0 uses every core. Raises CaseError for a case that cannot be computed, before anything is, and
    OutputError for a folder that cannot be used.
    """
    return run_model(
        build_model(case), folder, overwrite=overwrite, resume=resume, threads=threads, on_increment=on_increment
    )
