# SPDX-License-Identifier: Apache-2.0
"""Explicit runs with heat from case file to picture: the same bits after a resume and with two threads."""

import tomllib
from importlib.resources import files
from pathlib import Path

import pytest

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.model import Model
from presswork.recorder import run_model
from presswork.view import plot_all
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end


@pytest.fixture(scope="module")
def model() -> Model:
    """The example hot_upsetting, explicit and short; the die conducts on a mesh of its own."""
    case = tomllib.loads(files("presswork").joinpath("examples/hot_upsetting.toml").read_text())
    case["workpiece"] |= {"element": "quad4_1pt", "mesh": {"size": [20, 30], "cells": [5, 8]}}
    die = {key: value for key, value in case["tools"]["die"].items() if key != "m"}
    heat = {key: value for key, value in die["heat"].items() if key != "warms_up"}
    heat |= {"mesh": {"size": 4, "depth": 30}, "gap": 0.5}
    case["tools"] = {"die": {**die, "contact": "coulomb", "mu": 0.2, "heat": heat}}
    case["stages"].append({"name": "dwell", "duration": 0.2})
    case |= {"procedure": "explicit", "explicit": {"target_step": 1e-5}, "output": {"rows": 20, "steps": 2}}
    return build_model(Case.model_validate(case))


def test_a_run_leaves_temperatures_of_body_and_die(model: Model, tmp_path: Path) -> None:
    result = run_to_end(model, tmp_path / "out")
    history = result.history
    incoming = sum(history[f"heat_{kind}"] for kind in ("plastic", "friction", "tools", "convection", "radiation"))
    assert history["heat_stored"] == pytest.approx(incoming, rel=1e-8)
    assert result.summary["heat"]["balance_error"] < 1e-8
    assert result.summary["heat"]["dies"]["balance_error"] < 1e-8
    assert result.field("nodal_temperature").min() == pytest.approx(history["temperature_min"][-1])
    assert history["die.temperature_max"][-1] > 300
    names = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"temperature_time.png", "contours_nodal_temperature_004.png"} <= names, names


@pytest.mark.validation
def test_a_resumed_run_and_two_threads_give_the_same_bits(model: Model, tmp_path: Path) -> None:
    run_to_end(model, tmp_path / "whole")
    run_in_two_parts(model, tmp_path / "cut", 23)
    assert_same_bits(tmp_path / "cut", tmp_path / "whole")
    run_model(model, tmp_path / "two", threads=2)
    assert_same_bits(tmp_path / "two", tmp_path / "whole")
