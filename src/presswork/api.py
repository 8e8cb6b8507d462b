# SPDX-License-Identifier: Apache-2.0
"""The front door: check, build and run a case of any kind. Modules are loaded when a call needs them."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, overload

from presswork.case import CaseError, build_model, describe, read_case
from presswork.case.any_case import list_libraries
from presswork.law.allowed import is_allowed
from presswork.model import FormedSheet, Model, OneStepModel
from presswork.outcome import StartError

if TYPE_CHECKING:
    from presswork.case.any_case import AnyCase, ProcessCase
    from presswork.ranks.world import World
    from presswork.recorder import Outcome, Progress

logger = logging.getLogger(__name__)


def run(
    job: AnyCase | Model | OneStepModel,
    folder: Path | str,
    *,
    overwrite: bool = False,
    resume: bool = False,
    threads: int = 0,
    on_increment: Callable[[Progress], None] | None = None,
    world: World | None = None,
) -> Outcome:
    """Compute a case, or the Model of one, into a folder and return how it ended; `.result` reads what it wrote.

    `threads` 0 uses every core. `on_increment` is called after every increment, or iteration of one step. `world`: the
    ranks of MPI that compute together. Raises CaseError for a case that cannot be computed, before anything is,
    StartError if nothing can be computed from its start, and OutputError for a folder that cannot be used.
    """
    from presswork.process.begin import begin
    from presswork.recorder import run_model
    from presswork.results import OutputError

    model = build(job)
    if isinstance(model, OneStepModel):
        if world is not None:
            raise StartError("a one-step run takes seconds and is not divided over ranks: run it without mpiexec")
        if resume:
            raise OutputError("a one-step run takes seconds and leaves nothing to resume; run it anew with --overwrite")
        return find_blank(model, folder, overwrite=overwrite, threads=threads, on_iteration=on_increment)
    procedure = begin
    if world is not None:
        from presswork.process.on_ranks import begin_on_ranks

        procedure = partial(begin_on_ranks, world=world)
    return run_model(
        model,
        folder,
        overwrite=overwrite,
        resume=resume,
        threads=threads,
        on_increment=on_increment,
        procedure=procedure,
        world=world,
    )


def find_blank(
    model: OneStepModel,
    folder: Path | str,
    *,
    overwrite: bool = False,
    threads: int = 0,
    on_iteration: Callable[[Progress], None] | None = None,
    write_case: Path | None = None,
    cells: int | None = None,
) -> Outcome:
    """Go one step back from a part to its blank, as `run` does with such a case.

    write_case: where a stamping of that blank goes, with tools made of the part; what is doubtful of them is logged.
    cells: shells of that whole blank at most; None: 8,000.
    Raises StartError for a part that cannot be meshed, and OutputError.
    """
    from presswork.mesh import MeshError
    from presswork.onestep.part import OneStepError
    from presswork.onestep.record import BLANK_POINTS, run_one_step
    from presswork.onestep.stamping_case import CELLS, check_case_path, write_stamping_case
    from presswork.recorder import Outcome, Progress

    def report(number: int, error: float) -> None:
        if on_iteration is not None:
            on_iteration(Progress(0.0, f"iteration {number}: unbalanced force {error:.1e} of the flow force"))

    folder = Path(folder)
    if write_case is not None:
        check_case_path(write_case, overwrite=overwrite)
    try:
        found, outline = run_one_step(model, folder, overwrite=overwrite, threads=threads, on_iteration=report)
    except OneStepError as error:
        return Outcome("gave_up", folder, str(error))
    except MeshError as error:
        raise StartError(str(error)) from error
    if write_case is not None:
        thinning = 100.0 * (1.0 - float(found.fields["thickness"].min()) / model.thickness)
        points = folder / BLANK_POINTS
        for note in write_stamping_case(write_case, model, outline, points, thinning, cells=cells or CELLS):
            logger.warning("%s: %s", write_case, note)
    return Outcome("completed", folder)


def load(path: Path | str, overrides: Sequence[str] = ()) -> Model | OneStepModel:
    """Read a case file of any kind, with `key=value` overrides, and build its Model. Raises CaseError."""
    return build(read_case(path, overrides))


@overload
def build(job: ProcessCase | Model, *, runs_code: bool = True) -> Model: ...
@overload
def build(job: AnyCase | Model | OneStepModel, *, runs_code: bool = True) -> Model | OneStepModel: ...
def build(job: AnyCase | Model | OneStepModel, *, runs_code: bool = True) -> Model | OneStepModel:
    """Return the Model of a case, which holds all that its files do; a Model as it is. Raises CaseError.

    Drawbeads that are given by their geometry are computed first, unless the file beside the case has their forces.
    runs_code: without it no library of a case is opened and no strip pulled through a bead: the Model can be
    described, not computed.
    """
    if isinstance(job, Model | OneStepModel):
        return job
    if getattr(job, "analysis", None) == "stamping":  # build_model refuses what is no case
        from presswork.bead_forces import find_bead_forces

        job = find_bead_forces(job, may_compute=runs_code)
    return build_model(job, run_user_code=runs_code)


@dataclass(frozen=True)
class Checked:
    """What a case would compute."""

    description: str
    fault: str
    """Why nothing can be computed from its start; empty if it can."""


def check(case: AnyCase) -> Checked:
    """Describe a case and try its start. Raises CaseError.

    Libraries that the case names are opened only if they may run (`allow_library`); without them the start is not
    tried.
    """
    libraries = list_libraries(case)
    model = build(case, runs_code=bool(libraries) and all(map(is_allowed, libraries)))
    words = describe(model)
    if isinstance(model, OneStepModel):
        return Checked(words, "")
    if any(material.umat and math.isnan(material.young) for material in model.materials):
        note = "not opened: the libraries of its materials, whose code would run; --run-user-code tries them"
        return Checked(f"{words}\n{note}", "")
    from presswork.process.begin import check_start

    try:
        run = check_start(model)
    except StartError as error:
        return Checked(words, str(error))
    if model.explicit is None:
        return Checked(words, "")
    from presswork.process.pace import estimate_seconds

    seconds = estimate_seconds(run)
    if seconds is not None:
        besides = "" if model.remeshing is None and model.separation is None else ", without new meshes"
        words += (
            f"\ntime: about {seconds:.2g} s of one core of this machine{besides} (an estimate by some of its cycles)"
        )
    return Checked(words, "")


def identify(case: AnyCase) -> str:
    """Return the fingerprint of a case's Model: equal for cases that compute the same. Raises CaseError."""
    model = build(case)
    if isinstance(model, Model):
        from presswork.fingerprint import fingerprint

        return fingerprint(model)
    from presswork.onestep.record import identify_model

    return identify_model(model)


def read_last_sheet(folder: Path | str) -> FormedSheet | None:
    """Return the sheet at the end of a stamping with all its layers, by the case and the checkpoint of its folder.

    None where the case is not there, names files that are not, or has changed since.
    """
    from presswork.fingerprint import fingerprint
    from presswork.process.begin import begin
    from presswork.process.explicit.stamping import ExplicitStamping
    from presswork.process.implicit.stamping import ImplicitStamping
    from presswork.process.line.formed_sheet import make_formed
    from presswork.process.line.press_line import PressLine
    from presswork.process.line.springback import ReleasedStamping
    from presswork.results import OutputError, load_checkpoint
    from presswork.results.folder import CASE, CHECKPOINT

    path = Path(folder)
    if not (path / CASE).is_file() or not (path / CHECKPOINT).is_file():
        return None
    try:
        model = load(path / CASE)
        arrays, meta = load_checkpoint(path / CHECKPOINT)
        if not isinstance(model, Model) or meta["model"] != fingerprint(model):
            return None
        run = begin(model, 0)
        run.load_arrays(arrays)
        run.load_meta(meta)
    except (CaseError, StartError, OutputError, ValueError):
        return None
    run = run.now if isinstance(run, PressLine) else run
    if not isinstance(run, ReleasedStamping | ExplicitStamping | ImplicitStamping):
        return None
    return make_formed(run.sheet(), run.mesh, model.formed)
