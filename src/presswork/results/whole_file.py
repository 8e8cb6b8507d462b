# SPDX-License-Identifier: Apache-2.0
"""Replace files so that what is on disk is always whole, and nothing is written where a link leads.

A file is written beside the one it replaces, under a name that nobody can guess (NAME.1a2b3c4d.tmp), forced to disk,
and then takes its name in one rename. A process killed at any instant leaves the former file as it was and at most a
stale temporary. A link in the place of a file is replaced; what it leads to stays as it is.
"""

from __future__ import annotations

import errno
import io
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import h5py

CHECKPOINT, HISTORY = "checkpoint.h5", "history.csv"
_COPIED_AT_A_TIME = 1 << 22
"""Bytes."""
DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class OutputError(Exception):
    """Results cannot be written or continued; the message holds the reason and the remedy."""


@contextmanager
def replace_whole(path: Path, *, needed_bytes: int, is_durable: bool = True) -> Iterator[io.BufferedRandom]:
    """Provide a new file to write to, and put it in the place of `path` when the block ends.

    `needed_bytes` is what the new file takes, for the message when the disk is full. is_durable: wait until it is on
    the disk. If the block fails, `path` stays as it was. Raises OutputError in place of OSError.
    """
    temporary = path.with_name(f"{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        with create_file(temporary) as file:
            yield file
            file.flush()
            if is_durable:
                os.fsync(file.fileno())
        os.replace(temporary, path)
        if is_durable:
            _force_to_disk(path.parent)
    except OSError as error:
        _remove(temporary)
        raise explain_write_error(error, path, needed_bytes) from error
    except BaseException:
        _remove(temporary)
        raise


def write_whole(path: Path, content: bytes) -> None:
    """Write a file as a whole or not at all. Raises OutputError."""
    with replace_whole(path, needed_bytes=len(content)) as file:
        file.write(content)


def create_file(path: Path) -> io.BufferedRandom:
    """Create a file and open it. Raises OSError where there is one, or a link."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
    return os.fdopen(handle, "w+b")


def copy_content(path: Path, file: io.BufferedRandom) -> None:
    """Write what a file holds to another. Raises OSError."""
    with open(path, "rb") as source:
        shutil.copyfileobj(source, file, _COPIED_AT_A_TIME)


def open_to_append(path: Path) -> int:
    """Open a file that is there, not one that a link leads to, and return its handle. Raises OSError."""
    return os.open(path, os.O_WRONLY | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC)


def list_temporaries(folder: Path, name: str) -> Iterator[Path]:
    """Return what killed writers of a file have left."""
    return folder.glob(f"{name}.{'[0-9a-f]' * 8}.tmp")


def _remove(path: Path) -> None:
    """Remove a file if it can be; where nothing can be written, as on a read-only disk, nothing can be removed."""
    with suppress(OSError):
        path.unlink(missing_ok=True)


def explain_write_error(error: OSError, path: Path, needed_bytes: int) -> OutputError:
    """Turn an operating-system error in writing `path` into one with a remedy."""
    if error.errno in DISK_FULL:
        return OutputError(
            f"disk full: {path} cannot be written, {needed_bytes} bytes needed; what is on disk is whole; "
            f"free space and {_how_to_go_on(path.parent)}"
        )
    return OutputError(f"{path} cannot be written: {error.strerror or error}; what is on disk is whole")


def _how_to_go_on(folder: Path) -> str:
    """Return the advice on how to run again in a folder: a run that has left no checkpoint cannot be resumed."""
    if (folder / CHECKPOINT).is_file():
        return "run with --resume"
    return "run with --overwrite" if (folder / HISTORY).is_file() else "run again"


@contextmanager
def write_hdf5(file: io.BufferedRandom, mode: str) -> Iterator[h5py.File]:
    """Open a file as HDF5 for writing ("w" new, "r+" what it holds); raise OSError if any write failed.

    The HDF5 library does not survive a failed write (it can crash the process as it closes the file), so it is shown a
    file whose writes always succeed, and the failure is raised once the library has closed it.
    """
    import h5py

    file.flush()
    raw = _ForgivingFile(file.raw)
    try:
        with h5py.File(raw, mode) as opened:
            yield opened
    except Exception:
        raw.raise_failure()
        raise
    raw.raise_failure()


class _ForgivingFile(io.RawIOBase):
    """A binary file that keeps the first error of a write to itself and then pretends that all is well."""

    def __init__(self, file: io.RawIOBase) -> None:
        self._file = cast(io.FileIO, file)
        self._failure: OSError | None = None

    def raise_failure(self) -> None:
        """Raise the first error, if there was one."""
        if self._failure is not None:
            raise self._failure

    def write(self, data: Any) -> int:
        """Write all of `data`, or note the error."""
        view = memoryview(data).cast("B")
        start = self._file.tell()
        try:
            rest = view
            while self._failure is None and len(rest):
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            self._failure = error
        self._file.seek(start + len(view))
        return len(view)

    def readinto(self, buffer: Any) -> int:
        """Read into `buffer`; what was never written, because writing failed, reads as zeros."""
        view = memoryview(buffer).cast("B")
        start = self._file.tell()
        count = 0
        while count < len(view):
            got = self._file.readinto(view[count:])
            if not got:
                break
            count += got
        view[count:] = bytes(len(view) - count)
        self._file.seek(start + len(view))
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        """Set the length of the file, or note the error."""
        size = self.tell() if size is None else size
        try:
            self._file.truncate(size)
        except OSError as error:
            self._failure = self._failure or error
        return size

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a position."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the position."""
        return self._file.tell()

    def flush(self) -> None:
        """Do nothing: there is no buffer."""

    def readable(self) -> bool:
        """Return True."""
        return True

    def writable(self) -> bool:
        """Return True."""
        return True

    def seekable(self) -> bool:
        """Return True."""
        return True


def _force_to_disk(path: Path) -> None:
    """Wait until a file's content, or a folder's entries, are on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
