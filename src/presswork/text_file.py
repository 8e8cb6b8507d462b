# SPDX-License-Identifier: Apache-2.0
"""Reading of files that users name: whole, in UTF-8, and only what is a file and of a size that a person could mean."""

from __future__ import annotations

import os
import stat
from pathlib import Path

LARGEST = 2_000_000_000
"""Bytes of the largest file that is read."""


class UnreadableError(Exception):
    """A file that cannot be read: what is wrong, and the remedy."""

    def __init__(self, fault: str, remedy: str) -> None:
        self.fault = fault
        self.remedy = remedy
        super().__init__(f"{fault}; {remedy}")


def read_bytes(path: Path, *, most: int = LARGEST) -> bytes:
    """Read a file of at most `most` bytes.

    A pipe or a device is refused before it is opened, which could wait for ever, or never end. Raises FileNotFoundError
    where there is none, UnreadableError for all else that is wrong.
    """
    try:
        status = os.stat(path)
        if stat.S_ISDIR(status.st_mode):
            raise UnreadableError("a folder, not a file", "check the path")
        if not stat.S_ISREG(status.st_mode):
            raise UnreadableError("a pipe or a device, not a file", "save it to a file")
        if status.st_size > most:
            raise UnreadableError(f"{status.st_size:,} bytes, more than the {most:,} that are read", "check the path")
        return path.read_bytes()
    except FileNotFoundError:
        raise
    except OSError as error:
        raise UnreadableError(f"cannot be read ({error.strerror})", "check the path") from error
    except ValueError as error:  # a path with a NUL in it
        raise UnreadableError(f"no path of a file ({error})", "check the path") from error


def read_text(path: Path, *, most: int = LARGEST) -> str:
    """Read a text file in UTF-8, as read_bytes does."""
    try:
        return read_bytes(path, most=most).decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise UnreadableError("not a text file in UTF-8", "save it as UTF-8") from error
