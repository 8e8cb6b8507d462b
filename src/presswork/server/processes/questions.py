# SPDX-License-Identifier: Apache-2.0
"""What a process asks before its case is written, and how answers are read."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic_core import PydanticCustomError

from presswork.case.units import ANGLE, FORCE, LENGTH, PURE_NUMBER, TIME, Dimension, to_number
from presswork.server.opened_folder import RefusedError

Data = dict[str, Any]
"""The data of a case, as in its TOML."""
What = Literal["length", "force", "angle", "temperature", "time", "number", "material", "file", "choice"]
_DIMENSIONS: dict[str, Dimension] = {
    "length": LENGTH,
    "force": FORCE,
    "angle": ANGLE,
    "temperature": PURE_NUMBER,
    "time": TIME,
    "number": PURE_NUMBER,
}
_UNITS = {"length": "mm", "force": "kN", "angle": "degrees", "temperature": "°C", "time": "s", "number": ""}
_KN = 1000.0
CURVES = ("dxf", "step", "stp", "iges", "igs", "csv", "txt")
"""Endings of files with a profile."""
SURFACES = ("stl", "step", "stp", "iges", "igs")
"""Endings of files with a surface."""


@dataclass(frozen=True)
class Ask:
    """One thing to fill in."""

    key: str
    label: str
    what: What
    default: str | float = ""
    choices: tuple[str, ...] = ()
    """Words of a choice, endings of a file, names of materials to offer first."""
    is_needed: bool = True
    """Whether nothing can be set up without it: only a file may be left out."""
    above: float = 0.0
    """What a number must exceed."""

    def to_data(self) -> Data:
        """Return it as the page takes it."""
        return {
            "key": self.key,
            "label": self.label,
            "what": self.what,
            "default": self.default,
            "unit": _UNITS.get(self.what, ""),
            "choices": list(self.choices),
            "is_needed": self.is_needed,
        }


@dataclass(frozen=True)
class Question:
    """One of the things that a designer knows: a line of a few fields."""

    title: str
    asks: tuple[Ask, ...]
    help: str = ""


@dataclass(frozen=True)
class Answers:
    """What was answered, by the key of what was asked: numbers in mm, N, s, degrees, °C; texts as they are."""

    values: Mapping[str, Any] = field(default_factory=dict)

    def number(self, key: str) -> float:
        """Return a number."""
        return float(self.values[key])

    def text(self, key: str) -> str:
        """Return a text; empty if nothing was answered."""
        return str(self.values.get(key, ""))


@dataclass(frozen=True)
class Process:
    """A process of forming that a case begins with."""

    key: str
    group: str
    title: str
    summary: str
    questions: tuple[Question, ...]
    fill: Callable[[Data, Answers], None]
    """Writes the answers into the data of the starter of that name."""

    def to_data(self) -> Data:
        """Return it as the page takes it."""
        asked = [
            {"title": question.title, "help": question.help, "asks": [ask.to_data() for ask in question.asks]}
            for question in self.questions
        ]
        return {
            "name": self.key,
            "title": self.title,
            "group": self.group,
            "summary": self.summary,
            "questions": asked,
            "kind": "starter",
        }

    def read(self, given: Mapping[str, Any]) -> Answers:
        """Return the answers as numbers and texts; what is not given has its default. Raises RefusedError."""
        asks = [ask for question in self.questions for ask in question.asks]
        return Answers({ask.key: _read(ask, given.get(ask.key, ask.default)) for ask in asks})


def _read(ask: Ask, given: object) -> float | str:
    """Return an answer. Raises RefusedError that names what was asked."""
    text = str(given).strip()
    if not text:
        text = str(ask.default)
    if ask.what in ("material", "file"):
        if not text and ask.is_needed:
            raise RefusedError(f"{ask.label}: choose a {ask.what}")
        return text
    if ask.what == "choice":
        if text not in ask.choices:
            raise RefusedError(f"{ask.label}: {text} is none of {', '.join(ask.choices)}")
        return text
    text = re.sub(r"^([+-]?\d*),(\d+)", r"\1.\2", text)
    if ask.what == "temperature":
        text = text.removesuffix("°C").strip()
    is_plain = re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", text) is not None
    try:
        value = to_number(float(text) if is_plain else text, _DIMENSIONS[ask.what])
    except (PydanticCustomError, ValueError) as error:
        raise RefusedError(f"{ask.label}: {error}") from error
    value = float(value) * (_KN if is_plain and ask.what == "force" else 1.0)
    if value <= ask.above:
        raise RefusedError(f"{ask.label}: must be above {ask.above:g}, not {value:g}")
    return value


def whole(value: float) -> float | int:
    """Return a number of six digits as a case has it, without a point where it is whole."""
    short = float(f"{value:.6g}")
    return int(short) if short.is_integer() else short
