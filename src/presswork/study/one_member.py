# SPDX-License-Identifier: Apache-2.0
"""One run of a search that computes one after another: kept if it is there, continued if it was stopped."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from presswork.fingerprint import fingerprint
from presswork.model import Model
from presswork.recorder import Progress
from presswork.results import OutputError, load_checkpoint
from presswork.results.folder import CHECKPOINT, find_members
from presswork.study.member_process import Ending, Mode
from presswork.study.runner import Ended, Moved, Runner, Task
from presswork.study.table import read_summary


def compute_member(
    model: Model, folder: Path, runner: Runner, resume: bool, show: Callable[[Progress], None] | None
) -> tuple[Ending, str]:
    """Compute a run; with `resume` what is in the folder is kept, or goes on.

    Raises OutputError if it is of another case.
    """
    mode: Mode = "overwrite" if resume and folder.exists() else "new"
    if resume and (folder / CHECKPOINT).is_file():
        _, meta = load_checkpoint(folder / CHECKPOINT)
        if meta["model"] != fingerprint(model):
            raise OutputError(
                f"{folder} belongs to another case or target: resume with all as it was, or use --overwrite"
            )
        if read_summary(folder).get("status") == "completed":
            return "completed", ""
        mode = "resume"
    ended: tuple[Ending, str] = "interrupted", "stopped before it began"
    for event in runner.run({0: Task(model, folder, mode)}):
        match event:
            case Moved(_, fraction, text) if show is not None:
                show(Progress(fraction, text))
            case Ended(_, status, reason):
                ended = status, reason
    return ended


def open_search_folder(folder: Path, pattern: str, resume: bool, overwrite: bool) -> list[Path]:
    """Return the runs that a search's folder holds. Raises OutputError where it may not be used.

    pattern: of its runs' names, such as "draw_*".
    """
    if resume and overwrite:
        raise OutputError("--overwrite and --resume exclude each other: the first deletes what the second continues")
    present = find_members(folder, pattern)
    if resume and not present:
        raise OutputError(f"there is no search in {folder} to resume; run without --resume to start anew")
    if present and not (resume or overwrite):
        raise OutputError(
            f"{folder} already holds a search ({len(present)} {pattern.split('_')[0]}s); choose another folder, or "
            "run with --overwrite to replace it or --resume to continue"
        )
    return present
