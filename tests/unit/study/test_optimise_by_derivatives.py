# SPDX-License-Identifier: Apache-2.0
"""Studies whose runs find the derivatives themselves, beside differences of runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from presswork import CaseError
from presswork.api import build
from presswork.recorder import run_model
from presswork.study.optimum.optimise import Optimum, check_study, search
from presswork.study.optimum.runs import open_study_folder
from presswork.study.optimum.study_file import read_study
from presswork.study.runner import Ended, Event, Task
from tests.problems.differentiated import draw_under_holder, upset_cylinder

STUDY = """
case = "cylinder.toml"
goals = [{{minimise = "punch.max_force"}}]
limits = [{{measure = "{limited}", at_least = {least}}}]
search = {{method = "gradient", slopes = "{slopes}", runs = 30}}
[[variables]]
key = "stages.0.tools.punch.stroke"
lower = "0.04 cm"
upper = "0.2 cm"
[[variables]]
key = "workpiece.mesh.size.0"
lower = 8
upper = 11
"""


STAMPING = """
case = "cylinder.toml"
goals = [{{minimise = "max_thinning_percent"}}]
limits = [{{measure = "max:tip.z", at_most = 1}}]
search = {{method = "gradient", slopes = "{slopes}"}}
variables = [{{key = "stages.0.tools.holder.force", lower = "0.4 kN", upper = "4 kN"}}]
"""


class InThisProcess:
    """A runner that computes tasks one after the other."""

    def run(self, tasks: Mapping[int, Task]) -> Iterator[Event]:
        for number, task in tasks.items():
            outcome = run_model(build(task.job), task.folder)  # type: ignore[arg-type]
            yield Ended(number, outcome.status, outcome.reason)


def write_study(folder: Path, slopes: str, limited: str = "last:rim.x", least: float = 10.4) -> Path:
    settings = {"initial_increment": 0.5, "max_increment": 0.5}
    case = upset_cylinder(solver=settings, points={"rim": [7.5, 0]})
    case["workpiece"]["mesh"]["cells"] = [2, 3]
    (folder / "cylinder.toml").write_text(tomli_w.dumps(case))
    path = folder / "study.toml"
    path.write_text(STUDY.format(slopes=slopes, limited=limited, least=least))
    return path


def look(folder: Path, slopes: str) -> Optimum:
    folder.mkdir()
    path = write_study(folder, slopes, least=8.0)
    study, _ = read_study(path)
    columns, found = check_study(study, path)
    assert (found is None) == (slopes == "differences")
    return search(study, path, open_study_folder(folder / "out", False, False), columns, InThisProcess(), slopes=found)


@pytest.mark.validation
def test_derivatives_of_runs_find_the_optimum_of_differences_in_half_the_runs(tmp_path: Path) -> None:
    exact, differences = look(tmp_path / "exact", "auto"), look(tmp_path / "differences", "differences")
    assert exact.best is not None
    assert differences.best is not None
    assert not exact.reason
    assert exact.best.outcome is not None
    assert differences.best.outcome is not None
    assert exact.best.outcome.goal == pytest.approx(differences.best.outcome.goal, rel=2e-3)
    assert exact.best.x == pytest.approx(differences.best.x, abs=0.02)
    assert len(exact.runs) <= len(differences.runs) / 2
    assert "gradients" not in (tmp_path / "exact" / "out" / "best.toml").read_text()


def test_measure_that_the_history_does_not_have_is_refused_or_left_to_differences(tmp_path: Path) -> None:
    path = write_study(tmp_path, "exact", "max:eqps", 0.1)
    with pytest.raises(CaseError, match="its runs find no derivatives of it"):
        check_study(read_study(path)[0], path)
    path = write_study(tmp_path, "auto", "max:eqps", 0.1)
    assert check_study(read_study(path)[0], path)[1] is None


@pytest.mark.parametrize(("slopes", "are_exact"), [("auto", False), ("exact", True)])
def test_stampings_take_derivatives_of_runs_where_told_to(slopes: str, are_exact: bool, tmp_path: Path) -> None:
    """Of thinning over the range of the holder's force, as the history has it."""
    (tmp_path / "cylinder.toml").write_text(tomli_w.dumps(draw_under_holder()))
    path = tmp_path / "study.toml"
    path.write_text(STAMPING.format(slopes=slopes))
    found = check_study(read_study(path)[0], path)[1]
    assert (found is not None) == are_exact
    if found is not None:
        key = "stages.0.tools.holder.force"
        history = {"max_thinning_percent": np.array([1.0, 2.0]), "tip.z": np.array([3.0, 1.0])}
        history |= {f"d(max_thinning_percent)/d({key})": np.array([0.0, 0.002])}
        history |= {f"d(tip.z)/d({key})": np.array([0.005, 0.0])}
        slope = found.measure(history)
        assert slope["max_thinning_percent"] == pytest.approx([0.002 * 3600.0])
        assert slope["max:tip.z"] == pytest.approx([0.005 * 3600.0])
