# SPDX-License-Identifier: Apache-2.0
"""The format that a case file says it has."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

import presswork
from presswork.case import json_schema
from presswork.case.errors import CaseError
from presswork.case.kinds import KINDS
from presswork.case.plane.schema import Case

EXAMPLES = Path(presswork.__file__).parent / "examples"


@pytest.fixture
def data() -> dict[str, Any]:
    return tomllib.loads((EXAMPLES / "upsetting_q4.toml").read_text("utf-8"))


def test_format_1_changes_nothing_of_a_case(data: dict[str, Any]) -> None:
    assert Case.model_validate({"format": 1, **data}) == Case.model_validate(data)


def test_a_later_format_is_refused_first_and_says_what_to_do(data: dict[str, Any]) -> None:
    with pytest.raises(CaseError) as refused:
        Case.model_validate({**data, "key_of_the_future": 1, "format": 2})
    first = refused.value.problems[0]
    assert (first.key, first.value) == ("format", 2)
    assert "later presswork; this one reads format 1" in first.expected
    assert "install" in first.remedy


def test_a_kind_of_case_of_a_later_format_is_refused_by_its_format(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text('format = 2\ntitle = "later"\nanalysis = "superplastic"\n', encoding="utf-8")
    with pytest.raises(CaseError) as refused:
        presswork.read_case(path)
    assert refused.value.problems[0].key == "format"


@pytest.mark.parametrize("wrong", [0, -1, 1.5, "1", True])
def test_a_format_that_is_no_count_is_refused(data: dict[str, Any], wrong: object) -> None:
    with pytest.raises(CaseError, match="format"):
        Case.model_validate({**data, "format": wrong})


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_case_has_a_format(kind: str) -> None:
    assert json_schema(kind)["properties"]["format"]["default"] == 1
