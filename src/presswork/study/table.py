# SPDX-License-Identifier: Apache-2.0
"""table.csv, and table.parquet if asked for: one row a member."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from presswork.results import OutputError
from presswork.results.folder import SUMMARY
from presswork.results.whole_file import replace_whole, write_whole
from presswork.text_file import UnreadableError, read_text


def read_summary(folder: Path) -> dict[str, Any]:
    """Return a run's summary; empty if there is none, or a damaged one."""
    try:
        summary: dict[str, Any] = json.loads(read_text(folder / SUMMARY))
    except (OSError, UnreadableError, ValueError):
        return {}
    return summary


def write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Replace the table; a value that a row lacks is left empty. Raises OutputError."""
    columns = _columns(rows)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_format(row.get(name)) for name in columns] for row in rows)
    content = text.getvalue().encode()
    write_whole(path, content)


def write_parquet(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Replace the table in Parquet: numbers as int64 or float64, lists and mixed columns as text, as in the CSV.

    Raises OutputError.
    """
    pyarrow = require_pyarrow()
    from pyarrow import parquet

    arrays = {name: pyarrow.array(_column([row.get(name) for row in rows])) for name in _columns(rows)}
    table = pyarrow.table(arrays)
    with replace_whole(path, needed_bytes=table.nbytes + 65536) as file:
        parquet.write_table(table, file)


def require_pyarrow() -> Any:
    """Return pyarrow. Raises OutputError with the remedy if it is missing."""
    try:
        import pyarrow
    except ImportError as error:
        raise OutputError('a Parquet table needs pyarrow: pip install "presswork[parquet]"') from error
    return pyarrow


def _columns(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the names of all columns, in the order of the fullest row."""
    return list(dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row))


def _column(values: Sequence[Any]) -> list[Any]:
    """Return a column of one type: all numbers, or else text; None stays."""
    plain = [value.tolist() if isinstance(value, np.generic | np.ndarray) else value for value in values]
    kinds = {type(value) for value in plain if value is not None}
    if kinds <= {int}:
        return plain
    if kinds <= {int, float}:
        return [None if value is None else float(value) for value in plain]
    return [None if value is None else _format(value) for value in plain]


def _format(value: Any) -> str:
    """Write a number so that it reads back exactly, a text as it is, a list as in the case file."""
    if value is None:
        return ""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    return value.replace("\n", " ") if isinstance(value, str) else json.dumps(value)
