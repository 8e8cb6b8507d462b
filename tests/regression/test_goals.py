# SPDX-License-Identifier: Apache-2.0
"""Runs that are complete when a column of the history reaches a value (limits.end)."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import StampingCase
from presswork.model import Goal
from presswork.observe.memory.goals import Goals
from presswork.outcome import StartError
from presswork.process.begin import check_start
from presswork.recorder import run_model
from tests.regression.test_implicit_stamping import CUP
from tests.verification.test_wear import SPACE, UPSET


def change(*goals: dict[str, Any], **keys: Any) -> dict[str, Any]:
    """Return the billet that is upset by 3 mm, with goals."""
    return deepcopy(UPSET) | {"limits": {"end": list(goals)}} | keys


def quick() -> dict[str, Any]:
    """Return what makes it explicit."""
    data = deepcopy(UPSET)
    data["workpiece"]["element"] = "quad4_1pt"
    data["stages"][0]["duration"] = 3e-4
    return {"procedure": "explicit", "workpiece": data["workpiece"], "stages": data["stages"]}


@pytest.mark.parametrize("kind", ["implicit", "explicit"])
def test_a_run_ends_at_the_first_row_that_reaches_its_goal(tmp_path: Path, kind: str) -> None:
    data = change({"column": "die.stroke", "above": 1.2}, **(quick() if kind == "explicit" else {}))
    outcome = run_model(build_model(Case.model_validate(data)), tmp_path / "out", threads=1)
    assert outcome.status == "completed"
    result = outcome.result
    stroke = result.history["die.stroke"]
    assert stroke[-1] >= 1.2
    assert (stroke[:-1] < 1.2).all()
    assert result.summary["ended_by"].endswith("complete (limits.end, above = 1.2)")
    assert result.times[-1] == pytest.approx(result.history["time"][-1])
    assert len(np.unique(result.times)) == len(result.times), "no step is saved twice"


def test_a_block_in_space_and_a_sheet_end_at_their_goals(tmp_path: Path) -> None:
    block = deepcopy(SPACE) | {"limits": {"end": [{"column": "die.force", "above": 5000}]}}
    sheet = deepcopy(CUP) | {"limits": {"end": [{"column": "punch.stroke", "above": 1.5}]}}
    models = build_model(SpaceCase.model_validate(block)), build_model(StampingCase.model_validate(sheet))
    for name, column, above, model in zip("ab", ("die.force", "punch.stroke"), (5000, 1.5), models, strict=True):
        outcome = run_model(model, tmp_path / name, threads=1)
        values = outcome.result.history[column]
        assert outcome.status == "completed"
        assert values[-1] >= above
        assert (values[:-1] < above).all()


def test_a_goal_below_and_the_first_of_two_count() -> None:
    goals = Goals([Goal("die.force", above=1e9), Goal("die.flash_thickness", below=2.0)])
    row: dict[str, Any] = {"time": 0.0, "stage": "forge", "die.force": 5.0}
    for thickness in (4.0, 2.1):
        assert goals.look(None, row | {"die.flash_thickness": thickness}) is None
        assert goals.reached() == ""
    goals.look(None, row | {"die.flash_thickness": 1.9, "die.stroke": 7.5})
    assert goals.reached() == (
        "stage 'forge', die at 7.5 mm: die.flash_thickness is 1.9: complete (limits.end, below = 2)"
    )


def test_a_goal_that_is_never_reached_changes_nothing(tmp_path: Path) -> None:
    for name, data in (("plain", UPSET), ("goal", change({"column": "die.stroke", "above": 9}))):
        run_model(build_model(Case.model_validate(data)), tmp_path / name, threads=1)
    assert (tmp_path / "plain" / "history.csv").read_bytes() == (tmp_path / "goal" / "history.csv").read_bytes()


def test_a_run_that_is_complete_stays_so_when_it_is_resumed(tmp_path: Path) -> None:
    model = build_model(Case.model_validate(change({"column": "die.stroke", "above": 1.2})))
    run_model(model, tmp_path / "out", threads=1)
    history = (tmp_path / "out" / "history.csv").read_bytes()
    again = run_model(model, tmp_path / "out", threads=1, resume=True)
    assert again.status == "completed"
    assert (tmp_path / "out" / "history.csv").read_bytes() == history


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ({"column": "die.fors", "above": 1}, "no such column: die.fors; did you mean `die.force`?"),
        ({"column": "stage", "above": 1}, "no such column: stage"),
    ],
)
def test_a_goal_of_no_column_is_refused_by_check(goal: dict[str, Any], said: str) -> None:
    with pytest.raises(StartError, match=r"limits\.end\.0\.column") as error:
        check_start(build_model(Case.model_validate(change(goal))))
    assert said in str(error.value)


def test_a_goal_has_one_bound() -> None:
    for goal in ({"column": "die.force"}, {"column": "die.force", "above": 1, "below": 2}):
        with pytest.raises(CaseError, match="give either above or below"):
            Case.model_validate(change(goal))


def test_a_goal_of_a_run_with_springback_is_refused() -> None:
    data = deepcopy(CUP) | {"springback": {}, "limits": {"end": [{"column": "punch.force", "above": 1e4}]}}
    with pytest.raises(StartError, match=r"limits\.end: operations, trimming, springback"):
        check_start(build_model(StampingCase.model_validate(data)))
