# SPDX-License-Identifier: Apache-2.0
"""Cases crossed from the examples: tables of one in another, other analyses and procedures, values of any kind.

Every cross is described or refused; what refuses it names a key of the case, what is wrong there and the remedy.
"""

from __future__ import annotations

import copy
import functools
import tempfile
import tomllib
from pathlib import Path
from random import Random
from typing import Any

import tomli_w

from presswork.case import CaseError, Problem, build_model, read_case
from presswork.case.description import describe
from presswork.case.kinds import KINDS
from presswork.examples import copy_example, list_examples
from presswork.model import Model
from presswork.outcome import StartError
from presswork.process.begin import check_start
from tests.mutants.mutate import change_data

FEW_CELLS = 1000
"""Of a case whose start is computed, too."""
WHOLE_FILE = ("not valid TOML", "tables and lists are nested more than", "not a text file")
"""Faults that belong to no key."""


class TooLittleSaidError(Exception):
    """A refusal that names no file, no key or no remedy."""


@functools.cache
def read_examples() -> dict[str, dict[str, Any]]:
    """Return the data of all examples by name."""
    with tempfile.TemporaryDirectory() as folder:
        return {
            name: tomllib.loads(copy_example(name, Path(folder) / name).read_text(encoding="utf-8"))
            for name in list_examples()
        }


def write_files(folder: Path) -> None:
    """Write the files that the examples name into a folder."""
    for name in list_examples():
        with tempfile.TemporaryDirectory() as place:
            copy_example(name, place)
            for file in Path(place).iterdir():
                (folder / file.name).write_bytes(file.read_bytes())


def cross(random: Random) -> dict[str, Any]:
    """Return the data of one example with tables of others, another analysis or procedure, or changed values."""
    examples = list(read_examples().values())
    data = copy.deepcopy(random.choice(examples))
    for _ in range(random.choice((0, 1, 1, 2, 3))):
        _graft(data, random.choice(examples), random)
    if random.random() < 0.25:
        data["procedure"] = random.choice(("explicit", "implicit"))
    if random.random() < 0.2:
        data["analysis"] = random.choice([word for kind in KINDS.values() for word in kind.analyses])
    for _ in range(random.choice((0, 1, 1, 2))):
        change_data(data, random)
    return data


def _graft(data: dict[str, Any], other: dict[str, Any], random: Random) -> None:
    """Put a table of another case at its place, or one of its entries into that table."""
    key = random.choice([key for key, value in other.items() if isinstance(value, dict | list)])
    value = copy.deepcopy(other[key])
    if random.random() < 0.5 and isinstance(value, dict) and isinstance(data.get(key), dict) and value:
        inner = random.choice(list(value))
        data[key][inner] = value[inner]
    elif random.random() < 0.3 and isinstance(value, list) and isinstance(data.get(key), list):
        data[key] += value
    else:
        data[key] = value


def read_cross(path: Path) -> None:
    """Go the way of `presswork check`. Raises TooLittleSaidError for a refusal that lacks file, key or remedy."""
    try:
        case = read_case(path)
        model = build_model(case, run_user_code=False)
        describe(model)
        if isinstance(model, Model) and sum(len(block.connectivity) for block in model.mesh.blocks) < FEW_CELLS:
            check_start(model)
    except CaseError as error:
        if error.source != str(path):
            raise TooLittleSaidError(f"no file: {error}") from None
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        for problem in error.problems:
            if lack := find_lack(problem, data):
                raise TooLittleSaidError(f"{lack}: {problem!r}") from None
    except StartError as error:
        if ";" not in str(error):
            raise TooLittleSaidError(f"no remedy: {error}") from None


def find_lack(problem: Problem, data: dict[str, Any]) -> str:
    """Return what a problem fails to say; empty if it names a key, a fault and a remedy."""
    if not problem.expected:
        return "no fault"
    if not problem.remedy:
        return "no remedy"
    if any(problem.expected.startswith(fault) for fault in WHOLE_FILE):
        return ""
    if not problem.key:
        return "no key"
    here: Any = data
    *path, _ = problem.key.split(".")
    for name in path:
        if isinstance(here, list) and name.isdigit() and int(name) < len(here):
            here = here[int(name)]
        elif isinstance(here, dict) and name in here:
            here = here[name]
        elif isinstance(here, dict):
            return ""  # a table that is missing, or named in quotes
        else:
            return f"no such place as {problem.key}"
    return ""


def write_cross(number: int) -> bytes:
    """Return the case of a number as TOML."""
    return tomli_w.dumps(cross(Random(number))).encode(errors="surrogatepass")
