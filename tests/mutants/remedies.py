# SPDX-License-Identifier: Apache-2.0
"""Remedies of messages, done as their words say, so that a test can see whether they help."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import tomli_w

from presswork.case import CaseError, Problem, build_model, read_case
from tests.mutants.crosses import read_examples
from tests.mutants.mutate import change_data

_SET = re.compile(
    r"\b(?:set|take|give|write|for instance)\b (?:(?P<key>[a-z_][\w.]*) = )?(?P<value>\[[^\]]*\]|\"[^\"]*\"|-?[\d.]+)"
)
_MEANT = re.compile(r"did you mean `([^`]+)`")
_CHOICES = re.compile(r"(?:choices|one of): ([\w., ]+)")
_REMOVE = re.compile(r"^(?:remove it|leave it out|leave (?P<key>\w+)(?: or (?P<other>\w+))? out)")


@dataclass(frozen=True)
class Tried:
    """What came of the remedies of a case's messages."""

    helped: int = 0
    left: int = 0
    """Remedies whose words leave to the engineer what to do."""
    faults: tuple[str, ...] = ()
    """Remedies that leave the fault or lead to another."""


def try_remedies(path: Path, number: int) -> Tried:
    """Do each remedy of a spoilt example, written to a path beside its files, and see what is said then."""
    data = spoil(number)
    before = _list_problems(path, data)
    helped, left, faults = 0, 0, []
    for problem in before:
        ways = list(do_remedy(problem, data))
        if not ways:
            left += 1
            continue
        said = [_judge(problem, before, _list_problems(path, way)) for way in ways]
        if "" in said:
            helped += 1
        else:
            faults.append(f"{number}: {problem}\n    leads to {said[0]}")
    return Tried(helped, left, tuple(faults))


def _list_problems(path: Path, data: dict[str, Any]) -> tuple[Problem, ...]:
    """Return the problems of a case that show before its start is computed."""
    path.write_bytes(tomli_w.dumps(data).encode())
    try:
        build_model(read_case(path), run_user_code=False)
    except CaseError as error:
        return error.problems
    return ()


def _judge(problem: Problem, before: Sequence[Problem], after: Sequence[Problem]) -> str:
    """Return what is wrong after a remedy was done: the fault is still there, or a new one is; empty if it helped."""
    known = {str(one) for one in before}
    for one in after:
        is_same = (one.key, one.expected) == (problem.key, problem.expected)
        is_news = str(one) not in known and problem.expected != "unknown key"
        is_instance = "for instance" in problem.remedy or problem.expected.startswith(("expected", "unknown choice"))
        if is_news and is_instance:
            # A value for instance need not fit the others; one that shows how a quantity is written, not even its key.
            is_form = problem.expected.startswith(("expected [", "expected a number without a unit"))
            is_form = is_form or "or with a unit)" in problem.expected
            is_news = one.key == problem.key and not is_form
        if is_same or is_news:
            return str(one)
    return ""


def do_remedy(problem: Problem, data: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield a case's data with a remedy done, once a choice; nothing where its words leave it to the engineer."""
    *path, last = problem.key.split(".")
    if _find(data, path) is None:
        return

    def changed(change: Callable[[Any, dict[str, Any]], None]) -> Iterator[dict[str, Any]]:
        copied = copy.deepcopy(data)
        try:
            change(_find(copied, path), copied)
        except (KeyError, IndexError, TypeError, ValueError):  # the key stands elsewhere than the words say
            return
        yield copied

    if problem.expected == "unknown key":
        meant = _MEANT.search(problem.remedy)
        if meant and meant[1] not in _find(data, path):
            yield from changed(lambda here, _: here.update({meant[1]: here.pop(last)}))
        else:
            yield from changed(lambda here, _: here.pop(last))
    elif found := _REMOVE.search(problem.remedy):
        for key in filter(None, (found["key"] or last, found["other"])):
            yield from changed(lambda here, _, key=key: here.pop(_index(here, key)))
    elif problem.expected == "unknown choice":
        meant, choices = _MEANT.search(problem.remedy), _CHOICES.search(problem.remedy)
        for choice in [*([meant[1]] if meant else ()), *(choices[1].split(", ") if choices else ())]:
            yield from changed(lambda here, _, choice=choice: here.__setitem__(_index(here, last), choice))
    else:
        for found in _SET.finditer(problem.remedy):
            yield from changed(_put(found, last))


def _put(found: re.Match[str], last: str) -> Callable[[Any, dict[str, Any]], None]:
    """Return the change that sets a key to a value, as a remedy spells them."""
    *to, key = (found["key"] or last).split(".")

    def change(here: Any, whole: dict[str, Any]) -> None:
        value = tomllib.loads(f"value = {found['value'].rstrip('.')}")["value"]  # ValueError: [x, y], to be filled in
        (_find(whole, to) if to else here).__setitem__(_index(here, key), value)

    return change


def _index(here: Any, key: str) -> Any:
    return int(key) if isinstance(here, list) else key


def _find(data: Any, path: list[str]) -> Any:
    for name in path:
        if isinstance(data, list) and name.isdigit() and int(name) < len(data):
            data = data[int(name)]
        elif isinstance(data, dict) and name in data:
            data = data[name]
        else:
            return None
    return data


def spoil(number: int) -> dict[str, Any]:
    """Return the data of an example with one change; of every third with a key of another table put into it."""
    random = Random(number)
    examples = list(read_examples().values())
    data = copy.deepcopy(random.choice(examples))
    if number % 3:
        change_data(data, random)
        return data
    tables = [table for table in _list_tables(data) if table]
    others = [table for table in _list_tables(random.choice(examples)) if table]
    key, value = random.choice(list(random.choice(others).items()))
    random.choice(tables)[key] = copy.deepcopy(value)
    return data


def _list_tables(data: Any) -> list[dict[str, Any]]:
    found = [data] if isinstance(data, dict) else []
    for value in data.values() if isinstance(data, dict) else data:
        if isinstance(value, dict | list):
            found += _list_tables(value)
    return found
