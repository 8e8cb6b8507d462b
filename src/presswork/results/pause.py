# SPDX-License-Identifier: Apache-2.0
"""Pauses of a run that is at work: a file in its folder, which the run looks at between its steps.

The process that wants the pause keeps a lock on the file. The kernel takes the lock from a process that ends, however
it ends; so a run whose server was killed goes on by itself, and a file without a lock means nothing.
"""

from __future__ import annotations

import fcntl
import os
import secrets
from contextlib import suppress
from pathlib import Path

from presswork.results.whole_file import OutputError, create_file

PAUSE = "pause.lock"


def pause_run(folder: Path) -> int:
    """Pause the run that is at work in a folder until the handle that comes back is closed, or `end_pause`.

    Raises OutputError.
    """
    path = folder / PAUSE
    temporary = path.with_name(f"{PAUSE}.{secrets.token_hex(4)}.tmp")
    try:
        with create_file(temporary) as file:
            handle = os.dup(file.fileno())
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.replace(temporary, path)  # from here on the run sees it, locked
    except OSError as error:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise OutputError(f"{path} cannot be made: {error.strerror or error}; stop the run instead") from error
    return handle


def is_paused(folder: Path) -> bool:
    """Return whether a process that is alive wants the run in a folder to pause."""
    try:
        handle = os.open(folder / PAUSE, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # a file system that knows no locks
        return False
    finally:
        os.close(handle)
    return False


def end_pause(folder: Path) -> None:
    """Let the run in a folder go on, whoever has paused it."""
    with suppress(OSError):
        (folder / PAUSE).unlink(missing_ok=True)
