# SPDX-License-Identifier: Apache-2.0
"""The kinds of case: told apart by `analysis`, each in the JSON schema; and the error that passes between processes."""

from __future__ import annotations

import json
import pickle
import re
import tomllib
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest
from typer.testing import CliRunner

from presswork.case import CaseError, Problem, json_schema, read_case
from presswork.case.kinds import KINDS
from presswork.cli import app
from presswork.examples import copy_example, list_examples


def references(node: object) -> list[str]:
    """Every $ref under a node."""
    if isinstance(node, list):
        return [ref for item in node for ref in references(item)]
    if not isinstance(node, dict):
        return []
    own = [node["$ref"]] if "$ref" in node else []
    return own + [ref for item in node.values() for ref in references(item)]


def definition(schema: dict[str, Any], ref: str) -> dict[str, Any]:
    return schema["$defs"][ref.removeprefix("#/$defs/")]


def test_one_schema_holds_every_kind_by_its_analysis() -> None:
    schema = json_schema()
    mapping = schema["discriminator"]["mapping"]
    assert set(mapping) >= {"axisymmetric", "plane_strain", "shell"}
    assert {option["$ref"] for option in schema["oneOf"]} == set(mapping.values())
    assert len(schema["oneOf"]) == len(KINDS)
    for word, ref in mapping.items():
        analysis = definition(schema, ref)["properties"]["analysis"]
        assert word in analysis.get("enum", [analysis.get("const")])
    for ref in references(schema):
        assert definition(schema, ref)


def test_no_two_kinds_share_an_analysis() -> None:
    words = [word for kind in KINDS.values() for word in kind.analyses]
    assert len(words) == len(set(words))


def test_table_of_kinds_has_the_words_that_their_schemas_take() -> None:
    for kind in KINDS.values():
        assert resolve_name(kind.place).__name__ == kind.name
        assert resolve_name(kind.place).analyses() == kind.analyses


def test_schema_command_prints_all_kinds_or_one() -> None:
    runner = CliRunner()
    assert "oneOf" in json.loads(runner.invoke(app, ["schema"]).stdout)
    for name, kind in KINDS.items():
        printed = json.loads(runner.invoke(app, ["schema", name]).stdout)
        assert printed["title"] == kind.name
        assert "blank" in printed["properties"] or "workpiece" in printed["properties"]
        for word in kind.analyses:
            assert json.loads(runner.invoke(app, ["schema", word]).stdout) == printed
    assert "SpaceCase" in json.loads(runner.invoke(app, ["schema", "solid"]).stdout)["title"]
    refused = runner.invoke(app, ["schema", "shel"])
    assert refused.exit_code == 2
    assert "did you mean `shell`?" in refused.output


def test_examples_are_read_as_their_kind(tmp_path: Path) -> None:
    for example in list_examples():
        path = copy_example(example, tmp_path)
        analysis = re.search(r'^analysis = "(\w+)"', path.read_text("utf-8"), re.MULTILINE)
        assert analysis is not None
        assert analysis[1] in read_case(path).analyses()


def test_an_unknown_analysis_names_those_of_every_kind(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text('analysis = "shel"\n', encoding="utf-8")
    with pytest.raises(CaseError, match=r'case.toml: analysis = "shel": .*did you mean `shell`\?.*plane_strain'):
        read_case(path)


def test_case_error_survives_pickling() -> None:
    """As when a member of a sweep is refused in a process of its own."""
    error = CaseError([Problem("a.b", "missing key", "add it"), Problem("c", "expected a value > 0", "", 0)], "x.toml")
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error)
    assert copy.problems == error.problems
    assert copy.source == "x.toml"


@pytest.mark.parametrize("example", list_examples())
def test_every_example_names_its_schema_and_its_kind_is_in_it(example: str, tmp_path: Path) -> None:
    text = copy_example(example, tmp_path).read_text()
    assert text.startswith("#:schema presswork.schema.json\n")
    assert tomllib.loads(text)["analysis"] in json_schema()["discriminator"]["mapping"]
