# SPDX-License-Identifier: Apache-2.0
"""presswork: simulate metal forming from a short case file or from Python.

>>> import presswork
>>> case = presswork.Case.from_toml("upsetting_4cst.toml")
>>> result = presswork.run(case, "out").result
>>> result.history["punch.force"], result.field("eqps", step=-1)
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

__version__ = "0.1.0"

import presswork.simd  # noqa: F401  loads presswork._core, and so comes first
from presswork.case import Case, CaseError, ShellCase, StampingCase, build_model
from presswork.results import OutputError, Result
from presswork.run import Outcome, run_model

if TYPE_CHECKING:
    from presswork.run import Progress

__all__ = [
    "Case",
    "CaseError",
    "Outcome",
    "OutputError",
    "Result",
    "ShellCase",
    "StampingCase",
    "build_model",
    "run",
    "run_model",
]


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
