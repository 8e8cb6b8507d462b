# SPDX-License-Identifier: Apache-2.0
"""Errors of a case in one form: key, value, what was expected, and the remedy."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path


class _Missing(Enum):
    """What stands for no value: a member of an Enum is itself again after pickling."""

    VALUE = "no value"


@dataclass(frozen=True)
class Problem:
    """One fault of a case file."""

    key: str
    """Dotted path, e.g. `workpiece.mesh.pattern`; empty when the whole file is meant."""
    expected: str
    """What the key expects, or what is wrong, in one clause."""
    remedy: str = ""
    """What to do about it."""
    value: object = _Missing.VALUE
    """The value given; left out when there is none."""

    def __str__(self) -> str:
        head = self.key
        if self.value is not _Missing.VALUE:
            head = f"{head} = {format_value(self.value)}" if head else format_value(self.value)
        text = f"{head}: {self.expected}" if head else self.expected
        return f"{text}; {self.remedy}" if self.remedy else text


class CaseError(Exception):
    """A case that cannot be computed; lists every problem found."""

    def __init__(self, problems: Sequence[Problem], source: str | Path | None = None) -> None:
        self.problems = tuple(problems)
        self.source = None if source is None else str(source)
        super().__init__(self._text())

    def __reduce__(self) -> tuple[type[CaseError], tuple[tuple[Problem, ...], str | None]]:
        """Pickle by problems and source, so that it passes from one process to another."""
        return CaseError, (self.problems, self.source)

    def _text(self) -> str:
        where = self.source or "case"
        if len(self.problems) == 1:
            return f"{where}: {self.problems[0]}"
        return "\n".join([f"{where}: {len(self.problems)} problems", *(f"  {problem}" for problem in self.problems)])


def format_value(value: object, limit: int = 70) -> str:
    """Write a value as TOML writes it; lists and tables cut to `limit` characters, texts whole, which may be paths."""
    try:
        text = json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        text = str(value)
    return text if isinstance(value, str) or len(text) <= limit else text[: limit - 4] + " ..."


def suggest(name: str, choices: Iterable[str], what: str = "choices") -> str:
    """Name the nearest of the choices, and all of them."""
    known = sorted(choices)
    if not known:
        return f"there are no {what} here"
    lowered = {choice.lower(): choice for choice in known}
    near = difflib.get_close_matches(name.lower(), list(lowered), n=1, cutoff=0.5)
    listed = ", ".join(known)
    return f"did you mean `{lowered[near[0]]}`? ({what}: {listed})" if near else f"{what}: {listed}"


def explain_syntax(text: str, error: ValueError) -> str:
    """Return the remedy for a fault of syntax in TOML.

    >>> explain_syntax("thickness = 0,8", ValueError("Expected newline (at line 1, column 14)"))
    'a decimal comma stands there: write 0.8'
    """
    line = re.search(r"at line (\d+)", str(error))
    words = text.splitlines()[int(line[1]) - 1] if line and int(line[1]) <= len(text.splitlines()) else ""
    number = re.match(r"[^=\[{#]*=\s*([+-]?\d+),(\d+)\s*(?:#.*)?$", words)
    return f"a decimal comma stands there: write {number[1]}.{number[2]}" if number else "mend the syntax there"
