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
    """What the file says."""

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

    def tell(self, fraction: float, text: str) -> None:
        """Write how far the run is, unless it was said just now."""
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
    try:
        found: dict[str, Any] = json.loads(read_text(folder / PROGRESS, most=_LARGEST))
        progress = RunProgress(int(found["process"]), float(found["fraction"]), str(found["text"]))
        os.kill(progress.process, 0)
    except (OSError, UnreadableError, ValueError, TypeError, KeyError, OverflowError):
        return None
    return progress if progress.process > 1 and is_occupied(folder) else None
