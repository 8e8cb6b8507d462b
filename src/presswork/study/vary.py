# SPDX-License-Identifier: Apache-2.0
"""The cases of a sweep: `key=a:b:n` and `key=v1,v2` read, multiplied out, and every case checked."""

from __future__ import annotations

import itertools
import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from presswork.api import identify
from presswork.case import CaseError, read_case
from presswork.case.errors import Problem

if TYPE_CHECKING:
    from presswork.case.any_case import AnyCase

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"\s*({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*(\d+)\s*")
MAX_MEMBERS = 10_000


@dataclass(frozen=True)
class Member:
    """One case of a sweep, before it is run."""

    number: int
    values: dict[str, Any]
    """The varied keys and their values, which distinguish it from the others."""
    case: AnyCase | None
    """None if the case cannot be computed."""
    model_id: str = ""
    """Fingerprint of its Model."""
    fault: str = field(default="")
    """Why the case cannot be computed."""

    @property
    def folder_name(self) -> str:
        """Name of its output folder in that of the sweep."""
        return f"member_{self.number:03d}"


def parse_variation(text: str) -> tuple[str, list[Any]]:
    """Read `key=a:b:n` (n values from a to b) or `key=v1,v2,...` (values as TOML, or else strings).

    A range between whole numbers that meets only whole numbers gives whole numbers. Raises CaseError.
    """
    key, equals, values = text.partition("=")
    key = key.strip()
    remedy = "write --vary key=first:last:count or --vary key=v1,v2,v3"
    if not equals or not key or not values.strip():
        raise CaseError([Problem("", f"`{text}` varies nothing", remedy)])
    match = _RANGE.fullmatch(values)
    if match is None:
        if re.fullmatch(r"\s*[^:,\[\"']*:[^:,\[\"']*:[^:,\[\"']*\s*", values):
            raise CaseError([Problem(key, f"`{values}` is not a range of numbers", remedy)])
        return key, _parse_list(values)
    first, last, count = float(match[1]), float(match[2]), int(match[3])
    if count < 2 or first == last or count > MAX_MEMBERS:
        raise CaseError([Problem(key, f"`{values}`: a range has two different ends and 2 to 10000 values", remedy)])
    points = [float(f"{x:.12g}") for x in np.linspace(first, last, count)]
    if all(re.fullmatch(r"[+-]?\d+", match[i]) for i in (1, 2)) and all(x.is_integer() for x in points):
        return key, [int(x) for x in points]
    return key, points


def _parse_list(text: str) -> list[Any]:
    """Read values separated by commas; lists in brackets and texts in quotes hold together."""
    try:
        return list(tomllib.loads(f"value = [{text}]")["value"])
    except tomllib.TOMLDecodeError:
        return [_parse_value(part) for part in text.split(",") if part.strip()]


def _parse_value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text.strip()


def format_override(key: str, value: object) -> str:
    """Write `key=value` as --set takes it. Raises CaseError for a value that TOML cannot express."""
    try:
        return f"{key}={_format_toml(value)}"
    except (TypeError, ValueError):
        raise CaseError([Problem(key, f"`{value!r}` is not a value of a case file")]) from None


def _format_toml(value: object) -> str:
    """Write a value on one line of TOML."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(key)} = {_format_toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_format_toml(entry) for entry in value) + "]"
    return json.dumps(value, allow_nan=False)


def multiply_out(vary: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Return every combination of the values, the last key changing fastest. Raises CaseError."""
    if not vary:
        raise CaseError([Problem("", "nothing is varied", "give --vary key=first:last:count")])
    problems = [Problem(key, "no value to vary over", "give some") for key, values in vary.items() if not len(values)]
    for key, values in vary.items():
        texts = [format_override(key, value) for value in values]
        problems += [
            Problem("", f"`{t}` is given twice", "leave one out")
            for t in sorted({t for t in texts if texts.count(t) > 1})
        ]
    count = int(np.prod([float(len(values)) for values in vary.values()]))
    if count > MAX_MEMBERS:
        problems.append(Problem("", f"{count} cases are too many", f"vary less; at most {MAX_MEMBERS}"))
    if problems:
        raise CaseError(problems)
    return [dict(zip(vary, values, strict=True)) for values in itertools.product(*vary.values())]


def make_members(
    case_file: Path | str, combinations: Sequence[tuple[dict[str, Any], Sequence[str]]], settings: Sequence[str]
) -> list[Member]:
    """Read and build the case of every combination, given as what it is called and its overrides.

    A case that cannot be computed becomes a Member with a fault; raises CaseError if that is all of them.
    """
    members = []
    first_error: CaseError | None = None
    for number, (values, overrides) in enumerate(combinations):
        try:
            case = read_case(case_file, overrides=[*settings, *overrides])
            members.append(Member(number, values, case, identify(case)))
        except CaseError as error:
            first_error = first_error or error
            members.append(Member(number, values, None, fault="; ".join(str(p) for p in error.problems)))
    if first_error is not None and all(member.case is None for member in members):
        raise first_error
    return members
