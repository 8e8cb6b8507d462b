# SPDX-License-Identifier: Apache-2.0
"""table.csv: one row a member, with what its summary and the end of its history say."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from presswork.results import OutputError, read_history
from presswork.results.folder import HISTORY, SUMMARY
from presswork.results.whole_file import replace_whole


def read_summary(folder: Path) -> dict[str, Any]:
    """Return a run's summary; empty if there is none, or a damaged one."""
    try:
        summary: dict[str, Any] = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return summary


def make_row(folder: Path, name: str, values: Mapping[str, Any], status: str, reason: str) -> dict[str, Any]:
    """Return a member's row: counts, time [s], stroke [mm] and force [N] of every moving tool, extremes [1, MPa]."""
    row: dict[str, Any] = {"member": name, **values, "status": status, "reason": reason}
    if status in ("bad_input", "waiting", "running"):
        return row
    summary = read_summary(folder)
    for key in ("fraction_computed", "increments", "iterations", "cutbacks"):
        row[key] = summary.get(key)
    row["wall_seconds"] = summary.get("wall_seconds", {}).get("total")
    for key in ("equivalent_plastic_strain", "effective_stress"):
        row[f"max_{key}"] = summary.get("extremes", {}).get(key, [None, None])[1]
    try:
        history = read_history(folder / HISTORY)
    except OutputError:
        return row
    for column, numbers in history.items():
        tool, _, quantity = column.rpartition(".")
        if quantity == "stroke" and len(numbers) and np.any(numbers != 0):
            row[column] = float(numbers[-1])
            row[f"{tool}.force"] = float(history[f"{tool}.force"][-1])
    return row


def write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Replace the table; a value that a row lacks is left empty. Raises OutputError."""
    columns = list(dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_format(row.get(name)) for name in columns] for row in rows)
    content = text.getvalue().encode()
    with replace_whole(path, needed_bytes=len(content)) as temporary:
        temporary.write_bytes(content)


def _format(value: Any) -> str:
    """Write a number so that it reads back exactly, a text as it is, a list as in the case file."""
    if value is None:
        return ""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    return value.replace("\n", " ") if isinstance(value, str) else json.dumps(value)
