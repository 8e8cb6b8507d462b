# SPDX-License-Identifier: Apache-2.0
"""Optimisation of functions whose constrained optimum is known, by the driver of real studies; the runs are given."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from presswork import CaseError, OutputError
from presswork.api import identify
from presswork.case import read_case
from presswork.examples import copy_example
from presswork.study.optimum.optimise import Optimum, check_study, search
from presswork.study.optimum.runs import open_study_folder
from presswork.study.optimum.search import Outcome, find_best
from presswork.study.optimum.study_file import read_study
from presswork.study.optimum.surrogate import search_by_surrogate
from presswork.study.runner import Ended, Event, Started, Task
from tests.unit.case.round_cup import CUP, changed

Function = Callable[[float, float], tuple[float, float] | None]
STUDY = """
case = "ring_compression.toml"
[[variables]]
key = "stages.0.tools.punch.stroke"
lower = {low}
upper = {high}
[[variables]]
key = "materials.steel.young"
lower = "{low}e5 MPa"
upper = "{high}e5 MPa"
[[goals]]
minimise = "max_equivalent_plastic_strain"
[[limits]]
measure = "max_effective_stress"
at_most = 0
[search]
"""


class GivenRuns:
    """A runner whose runs measure what a function of stroke and Young's modulus gives; None: the run gives up."""

    def __init__(self, function: Function, stop_after: int | None = None) -> None:
        self.function, self.stop_after = function, stop_after
        self.computed: list[tuple[float, float]] = []

    def run(self, tasks: Mapping[int, Task]) -> Iterator[Event]:
        for number, task in tasks.items():
            if self.stop_after is not None and len(self.computed) >= self.stop_after:
                return
            yield Started(number)
            x = task.job.stages[0].tools["punch"].stroke  # type: ignore[union-attr]
            y = task.job.materials["steel"].young / 1e5  # type: ignore[union-attr]
            self.computed.append((x, y))
            found = self.function(x, y)
            status, reason = ("gave_up", "no equilibrium") if found is None else ("completed", "")
            goal, limited = found or (None, None)
            task.folder.mkdir(exist_ok=True)
            extremes = {"equivalent_plastic_strain": [0.0, goal], "effective_stress": [0.0, limited]}
            summary = {"status": status, "reason": reason, "extremes": extremes, "model": identify(task.job)}
            (task.folder / "summary.json").write_text(json.dumps(summary))
            (task.folder / "case.toml").write_text(task.job.text)  # type: ignore[union-attr]
            (task.folder / "results.vtkhdf").write_text("")
            yield Ended(number, status, reason)  # type: ignore[arg-type]


def look(
    function: Function, folder: Path, settings: str, low: float = 0.5, high: float = 5.0, **given: int
) -> tuple[Optimum, GivenRuns]:
    folder.mkdir(exist_ok=True)
    if not (folder / "ring_compression.toml").exists():
        copy_example("ring_compression", folder)
    path = folder / "study.toml"
    path.write_text(STUDY.format(low=low, high=high) + settings)
    study, _ = read_study(path)
    runner = GivenRuns(function, **given)
    place = open_study_folder(folder / "out", resume=(folder / "out").exists(), overwrite=False)
    return search(study, path, place, (), runner), runner


def place_of(found: Optimum) -> list[float]:
    assert found.best is not None, found.reason
    return list(found.best.values.values())


def bowl(x: float, y: float) -> tuple[float, float]:
    """A bowl about (3, 4), with x + y <= 5: the least is 2, at (2, 3)."""
    return (x - 3.0) ** 2 + (y - 4.0) ** 2, x + y - 5.0


def hills(x: float, y: float) -> tuple[float, float]:
    """Several minima, after Gardner et al. (2014): cos 2x cos y + sin x, within cos x cos y - sin x sin y <= 0.5."""
    return np.cos(2 * x) * np.cos(y) + np.sin(x), np.cos(x) * np.cos(y) - np.sin(x) * np.sin(y) - 0.5


@pytest.mark.parametrize(("method", "most"), [("surrogate", 25), ("gradient", 20)])
def test_optimum_on_a_limit_is_found(tmp_path: Path, method: str, most: int) -> None:
    found, runner = look(bowl, tmp_path, f'method = "{method}"\nruns = 60')
    assert (found.status, found.reason) == ("completed", "")
    np.testing.assert_allclose(place_of(found), [2.0, 3e5], rtol=0.03)
    assert found.best is not None
    assert found.best.outcome is not None
    assert 2.0 < found.best.outcome.goal < 2.03
    assert len(runner.computed) == len(found.runs) <= most
    best = read_case(found.folder / "best.toml")
    assert best.stages[0].tools["punch"].stroke == found.best.values["stages.0.tools.punch.stroke"]  # type: ignore[union-attr]
    assert (found.folder / "progress.png").read_bytes().startswith(b"\x89PNG")


def test_a_variable_can_be_a_goal(tmp_path: Path) -> None:
    """The longest stroke within x + y <= 5, y from 0.5 on: 4.5."""
    goal = '[[goals]]\nmaximise = "stages.0.tools.punch.stroke"\n'
    found, _ = look(lambda x, y: (0.0, x + y - 5.0), tmp_path, f"runs = 40\n{goal}")
    assert place_of(found)[0] == pytest.approx(4.5, rel=0.03)
    study, _ = read_study(tmp_path / "study.toml")
    assert [column.title for column in check_study(study, tmp_path / "study.toml")[0]] == []


def test_a_field_that_runs_of_a_sheet_will_not_have_is_refused_before_they_run(tmp_path: Path) -> None:
    (tmp_path / "cup.toml").write_text(tomli_w.dumps(changed(CUP, ("blank.element_size", 12))))
    path = tmp_path / "study.toml"
    text = """
case = "cup.toml"
[[variables]]
key = "blank.diameter"
lower = 98
upper = 102
[[goals]]
maximise = "max:{field}"
"""
    for field in ("thickness", "initial_position"):
        path.write_text(text.format(field=field))
        if field == "thickness":
            check_study(read_study(path)[0], path)
            continue
        with pytest.raises(CaseError, match=r"goals\.0\.maximise.*the runs of this case have no initial_position"):
            check_study(read_study(path)[0], path)


def test_surrogate_leaves_local_minima_behind(tmp_path: Path) -> None:
    """The least, -2, is where x = 3 pi / 2 and y at its lower bound."""
    found, _ = look(hills, tmp_path, "runs = 60\ntogether = 4", 0.01, 6.0)
    assert found.best is not None
    assert found.best.outcome is not None
    assert found.best.x[0] == pytest.approx((1.5 * np.pi - 0.01) / 5.99, abs=0.01)
    assert found.best.outcome.goal < -1.98, "0.5 % of its range, and flat in y"


def test_one_variable_with_a_kink_on_its_limit_is_found() -> None:
    """|x - 0.3| within x >= 0.35, whose start is one of Halton's points, too."""
    found: list[Outcome] = []

    def evaluate(points: Sequence[np.ndarray]) -> list[Outcome]:
        outcomes = [Outcome(x, abs(float(x[0]) - 0.3), 0.35 - x) for x in points]
        found.extend(outcomes)
        assert len(found) <= 20
        return outcomes

    search_by_surrogate(evaluate, np.array([0.5]), together=2, tolerance=0.01)
    place = find_best(found)
    assert place is not None
    assert found[place].x[0] == pytest.approx(0.35, abs=0.005)


@pytest.mark.parametrize("method", ["surrogate", "gradient"])
def test_failed_runs_count_as_infeasible_and_say_why(tmp_path: Path, method: str) -> None:
    """Nothing can be computed beyond y = 3.5, so near the bowl's middle."""
    found, _ = look(lambda x, y: None if y > 3.5 else bowl(x, y), tmp_path, f'method = "{method}"\nruns = 60')
    np.testing.assert_allclose(place_of(found), [2.0, 3e5], rtol=0.03)
    rows = read_rows(found.folder)
    assert {row["reason"] for row in rows if row["status"] == "gave_up"} <= {"no equilibrium"}
    assert all(row["feasible"] == "false" for row in rows if row["reason"])
    assert any("max_effective_stress = " in row["reason"] and "is above 0" in row["reason"] for row in rows)


def test_no_feasible_run_is_told_with_the_nearest(tmp_path: Path) -> None:
    found, _ = look(lambda x, y: (x, 1.0 + x), tmp_path, "runs = 12")
    assert (found.status, found.best) == ("gave_up", None)
    assert "no run of 12 keeps all limits; nearest, run_" in found.reason
    assert "max_effective_stress = 1.5" in found.reason
    assert not (found.folder / "best.toml").exists()


@pytest.mark.parametrize("method", ["surrogate", "gradient"])
def test_resumed_study_keeps_its_runs_and_ends_with_the_same_bits(tmp_path: Path, method: str) -> None:
    settings = f'method = "{method}"\nruns = 11\ntogether = 3'
    whole, first = look(bowl, tmp_path / "whole", settings)
    stopped, before = look(bowl, tmp_path / "parts", settings, stop_after=5)
    assert stopped.status == "interrupted"
    resumed, after = look(bowl, tmp_path / "parts", settings)
    assert before.computed + after.computed == first.computed
    for name in ("table.csv", "best.toml"):
        assert (resumed.folder / name).read_bytes() == (whole.folder / name).read_bytes()
    more, last = look(bowl, tmp_path / "parts", settings.replace("11", "13"))
    assert len(last.computed) == 2, "a larger number of runs goes on from those that are there"
    assert [run.values for run in more.runs[:11]] == [run.values for run in whole.runs]


def read_rows(folder: Path) -> list[dict[str, str]]:
    with open(folder / "table.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


BAD = {
    "lower = 0.5\n": ("lower = 7\n", "variables.0.upper = 5.0", "not above the lower one, 7", "exchange"),
    "punch.stroke": ("punch.strok", "variables.0.lower", "strok", "did you mean `stroke`?"),
    "materials.steel.young": ("stages.3.name", "variables.1.lower", "stages.3.name", "is not an index from 0 to 0"),
    'upper = "5.0e5 MPa"': ('upper = "500 GPa"', "variables.1.upper", "not that of lower (`MPa`)", "one unit"),
    'lower = "0.5e5 MPa"': ('lower = "-1e5 MPa"', "variables.1.lower", "-100000.0 MPa is not possible", "> 0"),
    '[[goals]]\nminimise = "max_equivalent_plastic_strain"\n': ("", "goals", "missing key", "add it"),
    "max_equivalent_plastic_strain": ("max_thinning_percent", "goals.0.minimise", "no such measure", "max_force"),
    "max_effective_stress": ("last:pnch.force", "limits.0.measure", "no pnch.force", "did you mean `punch.force`?"),
    "at_most = 0": ("", "limits.0.measure", "a limit needs a value", "give at_most or at_least"),
    "ring_compression": ("ring_compresion", "", "no such case file", "did you mean"),
    "[search]": ('[search]\nmethod = "genetic"', "search.method", "unknown choice", "gradient"),
}


@pytest.mark.parametrize("old", BAD)
def test_bad_studies_are_refused_before_anything_is_computed(tmp_path: Path, old: str) -> None:
    copy_example("ring_compression", tmp_path)
    path = tmp_path / "study.toml"
    new, *wanted = BAD[old]
    text = STUDY.format(low=0.5, high=5.0)
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(CaseError) as refused:
        check_study(read_study(path)[0], path)
    for part in wanted:
        assert part in str(refused.value)


def test_study_is_accepted_with_fields_and_columns_of_history(tmp_path: Path) -> None:
    copy_example("ring_compression", tmp_path)
    path = tmp_path / "study.toml"
    limits = "".join(f'[[limits]]\nmeasure = "max:{name}"\nat_most = 1e6\n' for name in ("punch.force", "eqps"))
    path.write_text(STUDY.format(low=0.5, high=5.0).replace("[search]", limits))
    study, _ = read_study(path)
    assert [column.title for column in check_study(study, path)[0]] == ["max:punch.force", "max:eqps"]


def test_folder_that_holds_a_study_is_not_replaced_unasked(tmp_path: Path) -> None:
    found, _ = look(bowl, tmp_path, "runs = 3")
    with pytest.raises(OutputError, match="already holds a study"):
        open_study_folder(found.folder, resume=False, overwrite=False)
    open_study_folder(found.folder, resume=False, overwrite=True)
    assert not list(found.folder.glob("run_*"))
