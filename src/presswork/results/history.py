# SPDX-License-Identifier: Apache-2.0
"""history.csv: one row per converged increment, appended as it comes."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.results.whole_file import OutputError, explain_write_error, open_to_append, write_whole
from presswork.text_file import UnreadableError, read_bytes

INTEGERS = ("increment", "iteration", "iterations", "cycles", "blow", "remesh_cause")
TEXTS = ("stage",)
BY_OTHERS = (
    "by another program while the run was at work, so results would be missing; leave the folder alone, and start anew "
    "with --overwrite"
)


def history_columns(
    tools: Sequence[str], turning: Sequence[str] = (), contacts: Sequence[str] = (), axes: str = "xy"
) -> list[str]:
    """Return the columns of a run with these tools: times in s, strokes in mm, forces in N on the whole body.

    Tools that turn have their angle [degree] and torque [N mm] too. Contacts between bodies have forces along the axes:
    of the first body on the second.
    """
    columns = ["time", "stage", "increment", "iterations"]
    for tool in tools:
        quantities = ["stroke", "force", "force_x", "force_y", "force_z"]
        quantities += ["angle", "torque"] if tool in turning else []
        columns += [f"{tool}.{quantity}" for quantity in quantities]
    columns += [f"{contact}.force_{axis}" for contact in contacts for axis in axes]
    return columns


def name_derivative(of: str, by: str) -> str:
    """Return the column of the derivative of a column by a key of the case."""
    return f"d({of})/d({by})"


class History:
    """A table on disk that grows by a row at a time.

    A row is written in one go and handed to the operating system at once, so it outlives the process. If the file is
    there, it is continued; a last row that was cut short is removed first.
    """

    def __init__(self, path: Path | str, columns: Sequence[str]) -> None:
        self.path = Path(path)
        self.columns = list(columns)
        self._size = 0
        if self.path.exists() and self.path.stat().st_size > 0:
            self._continue()
        else:
            self._replace([_format_row(self.columns)])

    def append(self, row: Mapping[str, float | int | str]) -> None:
        """Append one row; it has every column and no other. Floats are written so that they read back exactly."""
        if set(row) != set(self.columns):
            odd = sorted(set(row) ^ set(self.columns))
            raise ValueError(f"a row of {self.path.name} has the columns {self.columns}; missing or unknown: {odd}")
        self._write(_format_row([_format_value(row[name]) for name in self.columns]))

    def truncate(self, n_rows: int) -> None:
        """Keep the first `n_rows` rows, so that a resumed run appends after its checkpoint."""
        lines = _whole_lines(self.path)
        if not 0 <= n_rows < len(lines):
            raise OutputError(f"{self.path} holds {len(lines) - 1} increments, {n_rows} are needed; use --overwrite")
        self._replace(lines[: n_rows + 1])

    def sync(self) -> None:
        """Wait until all rows are on the disk, as before a checkpoint that counts on them."""
        try:
            with open(self.path, "rb") as file:
                self._check_size(file.fileno())
                os.fsync(file.fileno())
        except OSError as error:
            raise self._explain(error, 0) from error

    def _continue(self) -> None:
        """Check that the file on disk is the beginning of this table, and drop a torn last row."""
        lines = _whole_lines(self.path)
        if not lines or _parse_row(lines[0]) != self.columns:
            raise OutputError(f"{self.path} has other columns than this run; run with --overwrite to start anew")
        self._size = self.path.stat().st_size
        if sum(len(line) for line in lines) != self._size:
            self._replace(lines)

    def _write(self, line: bytes) -> None:
        """Append a line; if it does not fit on the disk, take back the part that did."""
        rest = line
        try:
            handle = open_to_append(self.path)
            try:
                self._check_size(handle)
                while rest:
                    rest = rest[os.write(handle, rest) :]
            except OSError:
                os.ftruncate(handle, self._size)
                raise
            finally:
                os.close(handle)
        except OSError as error:
            raise self._explain(error, len(line)) from error
        self._size += len(line)

    def _replace(self, lines: Sequence[bytes]) -> None:
        """Put these lines in the place of the file."""
        content = b"".join(lines)
        write_whole(self.path, content)
        self._size = len(content)

    def _check_size(self, handle: int) -> None:
        """Raise OutputError if another program has written to the file."""
        if os.fstat(handle).st_size != self._size:
            raise OutputError(f"{self.path} was changed {BY_OTHERS}")

    def _explain(self, error: OSError, needed_bytes: int) -> OutputError:
        if isinstance(error, FileNotFoundError) and self._size:
            return OutputError(f"{self.path} was deleted {BY_OTHERS}")
        return explain_write_error(error, self.path, needed_bytes)


def read_history(path: Path | str) -> dict[str, NDArray[Any]]:
    """Return every column as an array of length n_rows.

    The stage is text, increment and iterations are int64, all else is float64. A last row cut short is left out.
    Raises OutputError if there is no history, or a row inside it is damaged.
    """
    path = Path(path)
    if not path.exists():
        raise OutputError(f"there is no history at {path}")
    rows = [_parse_row(line) for line in _whole_lines(path)]
    if not rows:
        raise OutputError(f"{path} is empty")
    names, body = rows[0], rows[1:]
    tools = [name.removesuffix(".stroke") for name in names if name.endswith(".stroke")]
    for column in ("stage", *(f"{tool}.force" for tool in tools)) if tools else ():
        if column not in names:
            raise OutputError(f"{path} lacks the column {column}: it was changed; run the case anew")
    for number, row in enumerate(body, start=2):
        if len(row) != len(names):
            raise OutputError(f"{path}, line {number}: {len(row)} values, {len(names)} expected")
    try:
        return {name: _column(name, [row[i] for row in body]) for i, name in enumerate(names)}
    except (ValueError, OverflowError) as error:
        raise OutputError(f"{path} is damaged: {error}") from error


def _column(name: str, values: list[str]) -> NDArray[Any]:
    """Convert one column's text."""
    if name in TEXTS:
        return np.array(values, dtype=np.str_)
    return np.array(values, dtype=np.str_).astype(np.int64 if name in INTEGERS else np.float64)


def _format_value(value: float | int | str) -> str:
    """Write a value so that it reads back exactly."""
    if isinstance(value, str):
        if "\n" in value or "\r" in value:
            raise ValueError(f"{value!r} holds a line break")
        return value
    return str(int(value)) if isinstance(value, (int, np.integer)) else repr(float(value))


def _format_row(values: Sequence[str]) -> bytes:
    """Write one line of CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(values)
    return text.getvalue().encode()


def _parse_row(line: bytes) -> list[str]:
    """Read one line of CSV."""
    return next(csv.reader([line.decode(errors="replace").rstrip("\n")]), [])


def _whole_lines(path: Path) -> list[bytes]:
    """Return the lines that end in a line break; only the last one can lack it."""
    try:
        content = read_bytes(path)
    except UnreadableError as error:
        raise OutputError(f"{path} is {error}") from error
    return [line for line in content.splitlines(keepends=True) if line.endswith(b"\n")]
