# SPDX-License-Identifier: Apache-2.0
"""The time that explicit runs will take, by cycles of their start. `validation/test_pace.py` compares it with runs."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from presswork.api import check, load
from presswork.case import read_case
from presswork.examples import copy_example
from presswork.model import Model
from presswork.process.begin import check_start
from presswork.process.pace import estimate_seconds


def find_seconds(model: Model) -> float:
    seconds = estimate_seconds(check_start(model))
    assert seconds is not None
    return seconds


@pytest.mark.parametrize("name", ["square_cup", "hot_stamping_hat", "tube_hydroforming", "taylor_bar", "blanking"])
def test_check_estimates_the_time_of_explicit_runs(tmp_path: Path, name: str) -> None:
    words = check(read_case(copy_example(name, tmp_path))).description
    found = re.search(r"time: about ([\d.e+]+) s of one core", words)
    assert found
    assert 0.5 < float(found[1]) < 1e3


def test_the_estimate_grows_with_cells_and_rows(tmp_path: Path) -> None:
    case = copy_example("square_cup", tmp_path)
    coarse, fine = (load(case, [f"blank.element_size={size}"]) for size in (4, 1.5))
    assert isinstance(coarse, Model)
    assert isinstance(fine, Model)
    assert find_seconds(fine) > 3.0 * find_seconds(coarse)
    many = replace(coarse, output=replace(coarse.output, rows=5000))
    assert find_seconds(many) > find_seconds(coarse) + 10.0


def test_implicit_runs_have_no_estimate(tmp_path: Path) -> None:
    assert "time: about" not in check(read_case(copy_example("upsetting_4cst", tmp_path))).description
