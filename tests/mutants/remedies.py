# SPDX-License-Identifier: Apache-2.0
"""Remedies of messages, done as their words say, so that a test can see whether they help."""

from __future__ import annotations

import copy
import re
import tomllib
from random import Random
from typing import Any

from presswork.case.errors import Problem
from tests.mutants.crosses import read_examples
from tests.mutants.mutate import change_data

_SET = re.compile(r"\b(?:set|take|give|write)\b (?:(?P<key>[a-z_][\w.]*) = )?(?P<value>\[[^\]]*\]|\"[^\"]*\"|-?[\d.]+)")
_MEANT = re.compile(r"did you mean `([^`]+)`")
_CHOICES = re.compile(r"(?:choices|take|one of)[ :]+([\w.]+)")
_REMOVE = re.compile(r"^(?:remove it|leave it out|leave (?P<key>\w+) out)")


def do_remedy(problem: Problem, data: dict[str, Any]) -> dict[str, Any] | None:
    """Return a case's data with a remedy done; None where its words leave it to the engineer what to do."""
    data = copy.deepcopy(data)
    *path, last = problem.key.split(".")
    here = _find(data, path)
    if here is None:
        return None
    if found := _MEANT.search(problem.remedy):
        if problem.expected == "unknown key" and isinstance(here, dict):
            here.setdefault(found[1], here.pop(last))
            return data
        return _put(here, last, found[1], data)
    if found := _REMOVE.search(problem.remedy):
        return _remove(here, found["key"] or last, data)
    if problem.expected == "unknown key":
        return _remove(here, last, data)
    if problem.expected == "unknown choice" and (found := _CHOICES.search(problem.remedy)):
        return _put(here, last, found[1], data)
    if found := _SET.search(problem.remedy):
        try:
            value = tomllib.loads(f"value = {found['value'].rstrip('.')}")["value"]
        except tomllib.TOMLDecodeError:  # [x, y], for the engineer to fill in
            return None
        *to, key = (found["key"] or last).split(".")
        table = _find(data, to) if to else here
        return None if table is None else _put(table, key, value, data)
    return None


def _find(data: Any, path: list[str]) -> Any:
    for name in path:
        if isinstance(data, list) and name.isdigit() and int(name) < len(data):
            data = data[int(name)]
        elif isinstance(data, dict) and name in data:
            data = data[name]
        else:
            return None
    return data


def _put(here: Any, key: str, value: Any, data: dict[str, Any]) -> dict[str, Any] | None:
    if isinstance(here, dict):
        here[key] = value
    elif isinstance(here, list) and key.isdigit() and int(key) < len(here):
        here[int(key)] = value
    else:
        return None
    return data


def _remove(here: Any, key: str, data: dict[str, Any]) -> dict[str, Any] | None:
    if isinstance(here, dict) and key in here:
        del here[key]
    elif isinstance(here, list) and key.isdigit() and int(key) < len(here):
        del here[int(key)]
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
