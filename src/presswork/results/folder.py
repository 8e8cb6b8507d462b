# SPDX-License-Identifier: Apache-2.0
"""The output folder of a run: which files it holds, and when a run may use it."""

from __future__ import annotations

import fcntl
import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from presswork.results.pause import PAUSE, end_pause, is_paused
from presswork.results.whole_file import CHECKPOINT as CHECKPOINT
from presswork.results.whole_file import HISTORY as HISTORY
from presswork.results.whole_file import OutputError, create_file, explain_write_error, list_temporaries

RESULTS = "results.vtkhdf"
SUMMARY = "summary.json"
LOG = "run.log"
CASE = "case.toml"
PROGRESS = "progress.json"
PLOTS = "plots"

# The case is not among them: a run may write where the user's own case.toml lies.
_MADE_BY_A_RUN = (CHECKPOINT, RESULTS, HISTORY, SUMMARY, LOG)
_DRAWN_OF_A_RUN = ("report.html", *(f"{PLOTS}/*.{kind}" for kind in ("png", "csv", "gif", "mp4")))
_WORTH_KEEPING = (CHECKPOINT, RESULTS, HISTORY, SUMMARY)


def open_output_folder(path: Path | str, *, overwrite: bool = False, resume: bool = False) -> Path:
    """Make the folder ready for a run, before anything is computed, and return its path.

    A new folder is created in an existing parent. A folder that holds results is refused unless `overwrite` (its
    results, pictures and page are deleted, other files stay) or `resume` (it must hold a checkpoint). What killed
    writers have left is removed. Refused are a folder in which a run is at work, and links in the place of what a run
    writes: what they lead to is neither deleted nor written. Raises OutputError with the remedy.
    """
    folder = Path(path)
    try:
        return _open(folder, overwrite=overwrite, resume=resume)
    except OSError as error:  # a name that is too long, for instance
        raise OutputError(f"{folder} cannot be used as an output folder: {error.strerror or error}") from error


def _open(folder: Path, *, overwrite: bool, resume: bool) -> Path:
    if overwrite and resume:
        raise OutputError("--overwrite and --resume exclude each other: the first deletes what the second continues")
    if resume and not (folder / CHECKPOINT).is_file():
        raise OutputError(f"{folder} holds no {CHECKPOINT} to resume from; run with --overwrite to start anew")
    _create(folder)
    with occupy(folder):
        pass
    refuse_link(folder / PLOTS)
    present = [name for name in _WORTH_KEEPING if os.path.lexists(folder / name)]
    if present and not (overwrite or resume):
        raise OutputError(
            f"{folder} already holds results ({', '.join(present)}); choose another folder, "
            "or run with --overwrite to replace them or --resume to continue"
        )
    for name in () if overwrite else _MADE_BY_A_RUN:
        _require_file(folder / name)
    _check_writable(folder)
    if not is_paused(folder):
        end_pause(folder)  # of a server that was killed
    for name in (*_MADE_BY_A_RUN, CASE, PROGRESS, PAUSE):
        for path in list_temporaries(folder, name):
            _delete(path)
    for name in _MADE_BY_A_RUN if overwrite else ():
        _delete(folder / name)
    for pattern in _DRAWN_OF_A_RUN if overwrite else ():  # of other steps and operations, they would stay among the new
        for path in folder.glob(pattern):
            _delete(path)
    return folder


@contextmanager
def occupy(folder: Path) -> Iterator[None]:
    """Keep other runs out of the folder meanwhile; a process that is killed leaves it free.

    Raises OutputError where one is at work.
    """
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OutputError(f"another run is at work in {folder}; {_find_remedy(folder)}") from None
        except OSError:
            pass  # a file system that knows no locks
        yield
    finally:
        os.close(handle)


def _find_remedy(folder: Path) -> str:
    """Return the remedy for a folder in which another run is at work."""
    from presswork.results.progress import find_stopped

    other = "or choose another folder by --output"
    if (process := find_stopped(folder)) is not None:
        return f"its process is stopped: continue it by `kill -CONT {process}`, {other}"
    if is_paused(folder):
        return f"it is paused in the browser: continue it there, {other}"
    return f"wait until it has ended, {other}"


def is_occupied(folder: Path) -> bool:
    """Return whether a run is at work in a folder."""
    try:
        with occupy(folder):
            return False
    except OutputError:
        return True


def _create(folder: Path) -> None:
    """Create the folder if it is not there; its parent must be."""
    if folder.is_dir():
        return
    if folder.exists():
        raise OutputError(f"{folder} is a file, not a folder")
    if not folder.parent.is_dir():
        raise OutputError(f"{folder} cannot be created: its parent folder {folder.parent} does not exist")
    try:
        folder.mkdir()
    except OSError as error:
        raise explain_write_error(error, folder, 0) from error


def _check_writable(folder: Path) -> None:
    """Write and remove a byte, the only test that holds on every file system."""
    probe = folder / f"writable-{os.getpid()}.tmp"
    try:
        with create_file(probe) as file:
            file.write(b"1")
    except OSError as error:
        with suppress(OSError):
            probe.unlink(missing_ok=True)
        raise explain_write_error(error, probe, 1) from error
    _delete(probe)


def _require_file(path: Path) -> None:
    """Raise OutputError if something else than a file of its own is there: a link, a pipe."""
    refuse_link(path)
    if path.exists() and not stat.S_ISREG(path.stat().st_mode):
        raise OutputError(f"{path} is not a file; remove it, or choose another folder by --output")


def refuse_link(path: Path) -> None:
    """Raise OutputError if a link is there, by which the program would write, or delete, where it leads."""
    if path.is_symlink():
        raise OutputError(f"{path} is a link, which is not followed; remove it, or choose another folder by --output")


def find_members(folder: Path, pattern: str) -> list[Path]:
    """Return the folders of the runs that a study keeps in its own. Raises OutputError where one is a link.

    pattern: of their names, such as "member_*".
    """
    found = sorted(folder.glob(pattern))
    for path in found:
        refuse_link(path)
    return found


def delete_folder(path: Path) -> None:
    """Delete a folder with all that it holds. Raises OutputError."""
    refuse_link(path)
    try:
        shutil.rmtree(path)
    except OSError as error:
        raise OutputError(f"{path} cannot be deleted: {error.strerror or error}") from error


def _delete(path: Path) -> None:
    """Delete one file."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"{path} cannot be deleted: {error.strerror}") from error
