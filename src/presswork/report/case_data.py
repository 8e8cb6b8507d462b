# SPDX-License-Identifier: Apache-2.0
"""The case of a run as a page shows it: its text, and the values that it left to their defaults."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from presswork.case import CaseError, read_case


def read_text(path: Path) -> str:
    """Return the text of a case file; empty if there is none."""
    return path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""


def list_defaults(path: Path) -> list[tuple[str, str]]:
    """Return key and value of all that a case file leaves to its defaults, without those that switch something off.

    Empty where the file cannot be read as a case by this version.
    """
    try:
        whole = read_case(path).model_dump(mode="json")
        written = set(_flatten(tomllib.loads(read_text(path))))
    except (CaseError, OSError, ValueError):
        return []
    given = {key for key, _ in written}
    return [(key, value) for key, value in _flatten(whole) if key not in given and value not in ("null", "{}", "[]")]


def _flatten(values: Any, before: str = "") -> Iterator[tuple[str, str]]:
    """Yield keys joined by dots, with values as JSON, of tables and of lists of tables."""
    if isinstance(values, dict) and values:
        for key, value in values.items():
            yield from _flatten(value, f"{before}.{key}" if before else str(key))
    elif isinstance(values, list) and any(isinstance(item, dict) for item in values):
        for number, item in enumerate(values):
            yield from _flatten(item, f"{before}.{number}")
    else:
        yield before, json.dumps(values, ensure_ascii=False, default=str)
