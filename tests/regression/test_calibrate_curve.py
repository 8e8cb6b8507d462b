# SPDX-License-Identifier: Apache-2.0
"""Numbers of a case from a curve that the case itself has computed with others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

from presswork.case import CaseError
from presswork.case.plane.schema import Case
from presswork.cli import app
from presswork.implicit import sensitivities
from presswork.implicit.progress import Progress
from presswork.implicit.sensitivities import Sensitivities
from presswork.outcome import StartError
from presswork.study.calibrate_curve import calibrate_curve
from tests.problems.differentiated import run_case, set_value, upset_cylinder

TRUE = {
    "materials.steel.hardening.K": 812.0,
    "materials.steel.hardening.e0": 0.013,
    "materials.steel.hardening.n": 0.17,
    "tools.punch.m": 0.27,
}
SETTINGS = {"initial_increment": 0.05, "max_increment": 0.05, "force_tolerance": 1e-6}


def make_test(folder: Path) -> tuple[Path, Path]:
    """Return a case with guesses, and the curve that it computes with the true numbers, to six digits."""
    data = upset_cylinder(solver=SETTINGS)
    data["stages"] = [{"name": "upset", "tools": {"punch": {"stroke": 7.0, "direction": [0, -1]}}}]
    case = folder / "case.toml"
    case.write_text(tomli_w.dumps(data), encoding="utf-8")
    for key, value in TRUE.items():
        data = set_value(data, key, value)
    history = run_case(Case, data, folder / "truth").history
    curve = folder / "curve.csv"
    points = np.column_stack([history["punch.stroke"], history["punch.force"]])
    np.savetxt(curve, points, delimiter=",", header="punch.stroke,punch.force", comments="", fmt="%.6g")
    return case, curve


@pytest.mark.validation
def test_four_numbers_are_found_from_one_curve_within_eight_runs(tmp_path: Path) -> None:
    case, curve = make_test(tmp_path)
    told: list[str] = []
    fit = calibrate_curve(
        curve,
        case,
        tmp_path / "fit",
        keys=list(TRUE),
        on_run=lambda number, values, misfit: told.append(f"{number} {misfit:.1e} {values}"),
    )
    assert fit.runs <= 8
    assert fit.misfit < 1e-5
    for key, value in TRUE.items():
        assert fit.values[key] == pytest.approx(value, rel=1e-3), key


def test_command_finds_one_number_and_writes_it(tmp_path: Path) -> None:
    case, curve = make_test(tmp_path)
    others = [f"--set={key}={value}" for key, value in TRUE.items() if key != "tools.punch.m"]
    command = ["calibrate", "curve", str(curve), "--case", str(case), "--fit", "tools.punch.m", *others]
    found = CliRunner().invoke(app, command)
    assert found.exit_code == 0, found.output
    assert "tools.punch.m = 0.27" in found.output
    assert (tmp_path / "curve_calibration" / "calibration.json").exists()


def test_curve_with_columns_that_the_history_does_not_have_is_refused(tmp_path: Path) -> None:
    case, curve = make_test(tmp_path)
    text = curve.read_text("utf-8").replace("punch.force", "ram.force")
    curve.write_text(text, encoding="utf-8")
    with pytest.raises(StartError, match=r"no column `ram\.force`"):
        calibrate_curve(curve, case, tmp_path / "fit", keys=["tools.punch.m"])


def test_a_run_that_gives_up_is_told_by_its_numbers(tmp_path: Path) -> None:
    case, curve = make_test(tmp_path)
    lame = ["solver.max_iterations=2", "solver.min_increment=0.04"]
    with pytest.raises(CaseError, match=r"run 1 \(tools\.punch\.m=.*\) ended early: .*no equilibrium"):
        calibrate_curve(curve, case, tmp_path / "fit", keys=["tools.punch.m"], settings=lame)


@pytest.mark.validation
def test_a_derivative_that_is_lost_costs_the_run_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No round is allowed from the third increment on: the history goes on, its derivatives do not."""
    data = upset_cylinder(gradients={"by": ["tools.punch.m"]}, solver=SETTINGS)
    whole = run_case(Case, data, tmp_path / "whole")
    go_along = Sensitivities._go_along

    def go_along_lamed(self: Sensitivities, *given: object) -> object:
        if self._procedure.state[Progress].increments >= 2:
            monkeypatch.setattr(sensitivities, "MOST_ROUNDS", 0)
        return go_along(self, *given)

    monkeypatch.setattr(Sensitivities, "_go_along", go_along_lamed)
    lost = run_case(Case, data, tmp_path / "lost")
    name = "d(punch.force)/d(tools.punch.m)"
    assert np.isnan(lost.history[name][2:]).all()
    np.testing.assert_array_equal(lost.history[name][:2], whole.history[name][:2])
    np.testing.assert_array_equal(lost.history["punch.force"], whole.history["punch.force"])
    assert any("derivative by tools.punch.m was not found in increment 3" in w for w in lost.summary["warnings"])
    case, curve = make_test(tmp_path)
    with pytest.raises(CaseError, match=r"derivative by tools\.punch\.m was not found during the run"):
        calibrate_curve(curve, case, tmp_path / "fit", keys=["tools.punch.m"])
