# SPDX-License-Identifier: Apache-2.0
"""Values change in a case's text, and nothing else does."""

from __future__ import annotations

import copy
import tomllib
from pathlib import Path

import pytest

from presswork import examples
from presswork.server.opened_folder import RefusedError
from presswork.server.toml_text import rewrite

CASES = sorted(Path(examples.__file__).parent.glob("*.toml"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_text_stays_to_the_letter_where_nothing_changes(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert rewrite(text, tomllib.loads(text)) == text


def test_values_change_and_comments_stay() -> None:
    text = 'a = 1.0  # first\n[t]  # table\nb = "20 mm"   # second\nc = [1, 2]\n'
    data = tomllib.loads(text)
    data["a"], data["t"]["b"], data["t"]["c"][1], data["t"]["d"] = 2, 30.5, 3, True
    changed = rewrite(text, data)
    assert tomllib.loads(changed) == data
    assert "a = 2  # first" in changed
    assert "b = 30.5   # second" in changed
    assert "[t]  # table" in changed


def test_tables_and_entries_come_and_go() -> None:
    text = "[[stages]]\nname = 'one'\n# between\n[[stages]]\nname = 'two'\n"
    text += "[tools.punch]\nmu = 0.1\n[tools.die]\nmu = 0.2\n"
    data = tomllib.loads(text)
    changed = copy.deepcopy(data)
    changed["stages"].append({"name": "three", "tools": {"punch": {"stroke": 5, "direction": [0, -1]}}})
    del changed["tools"]["die"]
    changed["output"] = {"steps": 4}
    assert tomllib.loads(rewrite(text, changed)) == changed
    changed["stages"] = changed["stages"][:1]
    assert tomllib.loads(rewrite(text, changed)) == changed
    assert tomllib.loads(rewrite(rewrite(text, changed), data)) == data


@pytest.mark.parametrize("text", ["[[stages]]\ntools.die = { stroke = 1 }\n", "tools.die.heat = { gap = 1 }\n"])
def test_what_comes_beside_a_dotted_key_stands_in_its_table(text: str) -> None:
    data = tomllib.loads(text)
    (data["stages"][0] if "stages" in data else data)["tools"]["punch"] = {"stroke": 2, "heat": {"gap": 1}}
    assert tomllib.loads(rewrite(text, data)) == data


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_value_of_an_example_can_be_changed(path: Path) -> None:
    """Each number in turn, wherever it stands: in dotted keys, lists, tables in lines."""
    text = path.read_text(encoding="utf-8")
    data = tomllib.loads(text)

    def change(value: object) -> object:
        if isinstance(value, dict):
            return {key: change(each) for key, each in value.items()}
        if isinstance(value, list):
            return [change(each) for each in value]
        return value + 7 if isinstance(value, int | float) and not isinstance(value, bool) else value

    changed = change(data)
    assert tomllib.loads(rewrite(text, changed)) == changed  # type: ignore[arg-type]


def test_text_that_is_no_toml_is_refused() -> None:
    with pytest.raises(RefusedError, match="not valid TOML"):
        rewrite("a = ", {"a": 1})
