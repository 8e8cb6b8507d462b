# SPDX-License-Identifier: Apache-2.0
"""progress.json: how far a run is, for those who look at its folder while it computes. It goes when the run ends."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any

from presswork.results.folder import PROGRESS, is_occupied
from presswork.results.whole_file import OutputError, replace_whole
from presswork.text_file import UnreadableError, read_text

_PAUSE = 0.5
"""Seconds between two writings, at least."""
_LARGEST = 100_000
"""Bytes of the file, at most."""


@dataclass(frozen=True)
class RunProgress:
    """Contents of the file."""

    process: int
    """Number of the process that computes."""
    fraction: float
    """Fraction of the whole process."""
    text: str
    """Stage, increment and tools in a line."""


class ProgressFile:
    """Writes the file; one that cannot be written is no reason to stop a run."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / PROGRESS
        self._last = -_PAUSE

    def report(self, fraction: float, text: str) -> None:
        """Write the progress of the run, unless it was written a moment ago."""
        if monotonic() - self._last < _PAUSE:
            return
        content = json.dumps({"process": os.getpid(), "fraction": fraction, "text": text}).encode()
        with suppress(OutputError), replace_whole(self._path, needed_bytes=len(content), is_durable=False) as file:
            file.write(content)
        self._last = monotonic()

    def remove(self) -> None:
        """Remove the file."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)


def read_progress(folder: Path) -> RunProgress | None:
    """Return how far the run is that is at work in a folder; None if there is none."""
    progress = _read(folder)
    return progress if progress and is_occupied(folder) else None


def find_stopped(folder: Path) -> int | None:
    """Return the process of the run that is at work in a folder if it is stopped, as by Ctrl-Z, and waits to go on."""
    progress = _read(folder)
    return progress.process if progress and is_stopped(progress.process) else None


def _read(folder: Path) -> RunProgress | None:
    """Return the contents of the file, if the process that it names is there and has the folder open."""
    try:
        found: dict[str, Any] = json.loads(read_text(folder / PROGRESS, most=_LARGEST))
        progress = RunProgress(int(found["process"]), float(found["fraction"]), str(found["text"]))
        os.kill(progress.process, 0)
    except (OSError, UnreadableError, ValueError, TypeError, KeyError, OverflowError):
        return None
    return progress if progress.process > 1 and _has_open(progress.process, folder) else None


def _has_open(process: int, folder: Path) -> bool:
    """Return whether a process has a folder open, as the run at work there has; the file may name any process."""
    handles = Path(f"/proc/{process}/fd")
    try:
        own = os.stat(folder)
        for handle in handles.iterdir():
            with suppress(OSError):  # closed meanwhile
                if os.path.samestat(os.stat(handle), own):
                    return True
    except OSError:
        return not Path("/proc/self/fd").exists()  # a system that does not say what processes have open
    return False


def is_stopped(process: int) -> bool:
    """Return whether a process is stopped, as by Ctrl-Z or SIGSTOP, and waits for SIGCONT."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return False
    return state in "Tt"
