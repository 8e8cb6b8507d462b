# SPDX-License-Identifier: Apache-2.0
"""Run a case of any kind into an output folder: a process in time, or one step back from a part."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from presswork.bead_forces import find_bead_forces
from presswork.case import build_model
from presswork.case.onestep.schema import OneStepCase, build_onestep_model
from presswork.model import Model, OneStepModel
from presswork.recorder import Outcome, StartError, fingerprint, run_model
from presswork.results import OutputError

if TYPE_CHECKING:
    from presswork.case.kinds import AnyCase
    from presswork.recorder import Progress


def run(
    case: AnyCase,
    folder: Path | str,
    *,
    overwrite: bool = False,
    resume: bool = False,
    threads: int = 0,
    on_increment: Callable[[Progress], None] | None = None,
) -> Outcome:
    """Compute a case into a folder and return how it ended; `.result` reads what it wrote.

    `threads` 0 uses every core. `on_increment` is called after every increment; one step has none. Raises CaseError for
    a case that cannot be computed, before anything is, StartError if nothing can be computed from its start, and
    OutputError for a folder that cannot be used.
    """
    return compute(case, folder, overwrite=overwrite, resume=resume, threads=threads, on_increment=on_increment)


def build(job: AnyCase | Model | OneStepModel) -> Model | OneStepModel:
    """Return the Model of a case, which holds all that its files do; a Model as it is. Raises CaseError.

    Drawbeads that are given by their geometry are computed first, unless the file beside the case has their forces.
    """
    if isinstance(job, Model | OneStepModel):
        return job
    return build_onestep_model(job) if isinstance(job, OneStepCase) else build_model(find_bead_forces(job))


def compute(
    job: AnyCase | Model | OneStepModel,
    folder: Path | str,
    *,
    overwrite: bool = False,
    resume: bool = False,
    threads: int = 0,
    on_increment: Callable[[Progress], None] | None = None,
) -> Outcome:
    """Compute a case, or the Model that it made, as `run` does."""
    model = build(job)
    if isinstance(model, Model):
        return run_model(model, folder, overwrite=overwrite, resume=resume, threads=threads, on_increment=on_increment)
    from presswork.mesh import MeshError
    from presswork.onestep.part import OneStepError
    from presswork.onestep.record import run_one_step

    if resume:
        raise OutputError("a one-step run leaves nothing to resume; run it anew with overwrite")
    try:
        run_one_step(model, folder, overwrite=overwrite, threads=threads)
    except OneStepError as error:
        return Outcome("gave_up", Path(folder), str(error))
    except MeshError as error:
        raise StartError(str(error)) from error
    return Outcome("completed", Path(folder))


def identify(case: AnyCase) -> str:
    """Return the fingerprint of a case's Model: equal for cases that compute the same. Raises CaseError."""
    model = build(case)
    if isinstance(model, Model):
        return fingerprint(model)
    from presswork.onestep.record import identify_model

    return identify_model(model)
