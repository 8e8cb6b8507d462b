# SPDX-License-Identifier: Apache-2.0
"""Saved steps of the implicit procedure: where they lie does not make increments smaller."""

import pytest

from presswork import Case, build_model
from presswork.case.description import describe
from presswork.implicit.stepping import ImplicitProcedure


def bar(**output) -> Case:
    return Case(
        title="bar",
        analysis="plane_strain",
        workpiece={"material": "steel", "element": "quad4", "mesh": {"size": [4, 6], "cells": [1, 1]}},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 700}}},
        boundary={"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "pull", "displacement": [{"set": "top", "component": "y", "value": 0.01}]}],
        solver={"initial_increment": 0.25, "max_increment": 0.25},
        output=output,
    )


def run(**output):
    reports = list(ImplicitProcedure(build_model(bar(**output)), threads=1).advance())
    return [r.fraction for r in reports], [r.fraction for r in reports if r.is_save_point]


@pytest.mark.parametrize("steps", [20, 100])
def test_steps_closer_than_increments_leave_them_alone(steps):
    assert run(steps=steps) == ([0.25, 0.5, 0.75, 1.0], [0.25, 0.5, 0.75, 1.0])
    assert f"output.steps = {steps} a stage lie closer together" in describe(build_model(bar(steps=steps)))


def test_steps_further_apart_than_increments_end_one_each_and_hold_no_other_back():
    increments, saved = run(steps=3)
    assert saved == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert len(increments) == 6
    assert "closer together" not in describe(build_model(bar(steps=3)))


def test_times_asked_for_one_by_one_end_increments_always():
    increments, saved = run(steps=100, at=[0.1, 0.6])
    assert {0.1, 0.6, 1.0} <= set(saved)
    assert {0.1, 0.6} <= set(increments)
