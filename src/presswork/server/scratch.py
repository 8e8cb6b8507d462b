# SPDX-License-Identifier: Apache-2.0
"""Folders for temporary files: deleted when their process ends; those of processes that were killed by the next one."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

_PREFIX = "presswork-"


class Scratch:
    """A folder among the temporary ones. Its process holds a lock on it, which no process that is killed keeps."""

    def __init__(self) -> None:
        clear_stale(Path(tempfile.gettempdir()))
        self.folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
        self._handle = os.open(self.folder, os.O_RDONLY)
        with suppress(OSError):  # a file system that knows no locks
            fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def close(self) -> None:
        """Delete the folder."""
        shutil.rmtree(self.folder, ignore_errors=True)
        os.close(self._handle)


def clear_stale(place: Path) -> None:
    """Delete the folders of this user's processes that are no more."""
    for folder in place.glob(f"{_PREFIX}*"):
        with suppress(OSError):
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                if os.fstat(handle).st_uid == os.getuid():
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    shutil.rmtree(folder)
            finally:
                os.close(handle)
