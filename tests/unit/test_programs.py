# SPDX-License-Identifier: Apache-2.0
"""Programs beside the package go along with its names."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_an_example_finds_all_that_it_imports(path: Path) -> None:
    assert "main" in runpy.run_path(str(path), run_name="example")
