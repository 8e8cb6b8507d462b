# SPDX-License-Identifier: Apache-2.0
"""The table of a sweep in Parquet, and what is said without pyarrow."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from presswork.cli import app
from presswork.examples import copy_example
from presswork.study.table import write_parquet

ROWS = [
    {"member": "member_000", "m": 0.1, "cells": [10, 5], "increments": 7, "wall_seconds": 1},
    {"member": "member_001", "m": 0.2, "cells": [20, 10], "increments": None, "wall_seconds": 1.5},
    {"member": "member_002", "m": "none"},
]


def test_columns_keep_their_numbers(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    write_parquet(tmp_path / "table.parquet", ROWS)
    table = parquet.read_table(tmp_path / "table.parquet").to_pydict()
    assert table["member"] == ["member_000", "member_001", "member_002"]
    assert table["m"] == ["0.1", "0.2", "none"], "numbers and text make a column of text"
    assert table["cells"] == ["[10, 5]", "[20, 10]", None]
    assert table["increments"] == [7, None, None]
    assert table["wall_seconds"] == [1.0, 1.5, None]


def test_the_command_leaves_parquet_beside_csv(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    case = copy_example("ring_compression", tmp_path)
    settings = ["workpiece.mesh.cells=[4,2]", "stages.0.tools.punch.stroke=0.3", "output.steps=1"]
    sets = [part for setting in settings for part in ("--set", setting)]
    arguments = ["sweep", str(case), "--vary", "tools.punch.m=0.1,0.3", *sets, "--table-format", "parquet", "--quiet"]
    done = CliRunner().invoke(app, [*arguments, "--output", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    table = parquet.read_table(tmp_path / "out/table.parquet").to_pydict()
    assert table["tools.punch.m"] == [0.1, 0.3]
    assert table["status"] == ["completed", "completed"]
    assert all(force > 0 for force in table["punch.force"])
    assert (tmp_path / "out/table.csv").is_file()


def test_missing_pyarrow_is_named_before_anything_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    case = copy_example("ring_compression", tmp_path)
    arguments = ["sweep", str(case), "--vary", "tools.punch.m=0.1,0.3", "--table-format", "parquet"]
    done = CliRunner().invoke(app, [*arguments, "--output", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert 'pip install "presswork[parquet]"' in done.output
    assert not (tmp_path / "out").exists()
