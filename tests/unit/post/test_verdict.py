# SPDX-License-Identifier: Apache-2.0
"""The verdict on a run: each line by its figure and limit, of runs of every kind, without a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.post import judge_result, judge_summary
from presswork.post.verdict import Line
from presswork.results import Result, write_summary
from tests.unit.results.upset_output import write_upset_output

INSTANT = {"time_s": 0.5, "stage": "forge", "strokes_mm": {"die": 5.0}}
FORCE = {"die": {"force_n": -2.0e6, **INSTANT}, "anvil": {"force_n": 2.0e6, "time_s": 0.5, "strokes_mm": {}}}
DONE = {"status": "completed", "warnings": []}


def lines_of(summary: dict[str, Any], **options: Any) -> dict[str, Line]:
    """Return the lines of a summary by their names."""
    return {line.name: line for line in judge_summary(summary, **options).lines}


def test_force_is_judged_by_the_press_on_tools_that_move_alone() -> None:
    for limit, state in ((None, "figure"), (2.1e6, "ok"), (1.9e6, "fail")):
        equipment = {} if limit is None else {"equipment": {"force_n": limit}}
        found = lines_of({**DONE, "largest_forces": FORCE, **equipment})
        assert found["force of die"].state == state
        assert found["force of die"].figure == "2000 kN"
        assert found["force of die"].note == "in forge, die at 5 mm"
        assert "force of anvil" not in found


def test_pressure_that_passed_its_maximum_is_a_risk() -> None:
    found = {"largest_mpa": 12.5, "height_mm": 33.0, "largest_height_mm": 40.0, "stage": "bulge", "time_s": 30.0}
    for passed, state in ((False, "figure"), (True, "risk")):
        line = lines_of({**DONE, "sheet_pressures": {"oil": {**found, "passed": passed}}})["largest pressure of oil"]
        assert (line.state, line.figure) == (state, "12.5 MPa")
        assert ("at a height of 33 mm of 40 mm" in line.note) is passed


def test_die_that_is_not_full_fails_where_its_gap_is_widest() -> None:
    fill = {"wall_filled": 0.9, "largest_gap_mm": 0.4, "largest_gap_at_mm": [3.0, 4.0], "flash_thickness_mm": 2.0}
    found = lines_of({**DONE, "die_fill": {"upper": fill}})
    line = found["fill of upper"]
    assert (line.state, line.figure, line.at_mm, line.field) == ("fail", "90.0 %", (3.0, 4.0), "gap")
    assert found["flash at upper"].figure == "2 mm thick"
    assert lines_of({**DONE, "die_fill": {"upper": {**fill, "wall_filled": 0.985}}})["fill of upper"].state == "ok"


def test_joint_fails_without_interlock_and_its_die_need_not_be_full() -> None:
    fill = {"largest_gap_mm": 0.11, "wall_filled": 0.685, "flash_thickness_mm": None}
    sizes = {"interlock_mm": 0.15, "neck_mm": 0.45, "bottom_mm": 0.6}
    held = lines_of({**DONE, "die_fill": {"die": fill}, "joints": {"sheets": sizes}})
    assert held["fill of die"].state == "figure"
    assert held["interlock of sheets"].state == "figure"
    assert held["interlock of sheets"].note == "neck 0.45 mm, bottom 0.6 mm"
    loose = lines_of({**DONE, "joints": {"sheets": {**sizes, "interlock_mm": 0.0}}})
    assert loose["interlock of sheets"].state == "fail"


def test_laps_cracks_and_contact_pressure_fail_by_their_limits() -> None:
    lap = {"x_mm": 1.0, "y_mm": 2.0, "length_mm": 0.7}
    peak = {"value": 0.8, "at_mm": [5.0, 6.0], **INSTANT}
    damage = {"damage_cockcroft_latham": {"largest_mean": peak, "critical": 0.6, "first_exceeded": peak}}
    pressure = {"contact_pressure": {"largest": {"value": 1500.0, "at_mm": [1.0, 1.0, 0.0], "time_s": 0.5}}}
    summary = {**DONE, "laps": [lap], "damage": damage, "fields": pressure, "equipment": {"contact_pressure_mpa": 1400}}
    found = lines_of(summary, dimension=2)
    crack = found["cracks by cockcroft latham"]
    assert {line.state for name, line in found.items() if name not in ("run", "warnings of the run")} == {"fail"}
    assert (found["lap"].figure, found["lap"].at_mm) == ("0.7 mm long", (1.0, 2.0))
    assert (crack.figure, crack.limit, crack.note) == ("0.8", "0.6", "first crack in forge, die at 5 mm")
    assert found["contact pressure on tools"].at_mm == (1.0, 1.0)
    spared = lines_of({**DONE, "laps": [], "damage": {"damage_x": {"largest_mean": peak, "critical": None}}})
    assert (spared["laps"].state, spared["damage, x"].state) == ("ok", "figure")


@pytest.mark.parametrize(("margin", "state"), [(0.3, "ok"), (0.05, "risk"), (-0.1, "fail")])
def test_forming_limit_is_judged_by_the_safety_margin(margin: float, state: str) -> None:
    worst = {"value": margin, "cell": 3, "place": [1.0, 2.0, 3.0]}
    formability = {"least_margin": worst, "largest_thinning_percent": {**worst, "value": 20.0}}
    limits = {"thinning": {"limit": 0.7, "largest": 0.2, "fact": "", **INSTANT}}
    summary = {**DONE, "formability": formability, "first_crack": INSTANT, "limits": limits}
    found = lines_of(summary, safety_margin=0.1)
    assert found["margin to the forming limit at the end"].state == state
    assert found["thinning"].state == "figure", "a limit of 70 % is that of a sheet that has torn"
    assert found["thinning"].note == ""
    assert judge_summary(summary).state == state
    formability["one_step_thinning_percent"] = 17.0
    assert lines_of(summary)["thinning"].note == "one step estimated 17.0 %"


@pytest.mark.parametrize(("worst", "state"), [(0.4, "ok"), (-0.9, "fail")])
def test_springback_is_judged_by_its_tolerance(worst: float, state: str) -> None:
    judged = {"band_mm": [-0.5, 0.5], "share_within": 0.9, "worst_mm": worst, "at_mm": [1.0, 2.0, 3.0]}
    sprung = {"largest_mm": 2.0, "at_mm": [0.0, 0.0, 0.0]}
    line = lines_of({**DONE, "springback": {**sprung, "tolerance": judged}})["springback"]
    assert (line.state, line.limit, line.at_mm) == (state, "-0.5 to 0.5 mm", (1.0, 2.0, 3.0))
    assert lines_of({**DONE, "springback": sprung})["springback"].state == "figure"


def test_metal_hotter_than_the_window_of_its_law_is_a_risk() -> None:
    inside = {"window": [800.0, 1200.0], "reached": [850.0, 1100.0], "share_below": 0.0, "share_above": 0.0}
    for above, state in ((0.0, "ok"), (5e-4, "ok"), (0.2, "risk")):
        windows = {"c45": {"temperature": {**inside, "share_above": above}, "strain": {**inside, "share_below": 1.0}}}
        found = lines_of({**DONE, "law_windows": windows})
        assert found["temperature in the law of c45"].state == state
        assert found["temperature in the law of c45"].limit == "800 to 1200 °C"
        assert found["strain in the law of c45"].state == "ok", "metal that begins to yield is below every window"


def test_failed_run_says_its_reason_first_and_a_run_without_summary_is_not_judged() -> None:
    failed = judge_summary({"status": "gave_up", "reason": "too deep: refine", "fraction_computed": 0.4, "laps": []})
    assert (failed.state, failed.lines[0].figure, failed.lines[0].note) == (
        "fail", "gave up after 40.0 %", "too deep: refine",
    )  # fmt: skip
    nothing = judge_summary({**DONE, "verdict": "nothing was formed: the punch never touched"})
    assert (nothing.state, nothing.lines[0].note) == ("fail", "the punch never touched")
    assert judge_summary({**DONE, "warnings": ["x is odd"]}).state == "risk"
    assert judge_summary({}).state == "figure"
    assert not judge_summary({}).lines


def test_limits_of_press_and_tools_in_a_case_judge_its_run(tmp_path: Path) -> None:
    """An upsetting whose force and contact pressure are known from the run without limits."""
    changes = ["workpiece.mesh.cells=[4,4]", "output.steps=2"]
    path = copy_example("upsetting_q4", tmp_path)
    free = run(Case.from_toml(path, overrides=changes), tmp_path / "free").result
    force = free.summary["largest_forces"]["punch"]["force_n"]
    pressure = free.summary["fields"]["contact_pressure"]["largest"]["value"]
    assert {line.name: line.state for line in judge_result(free).lines}["force of punch"] == "figure"
    limits = [f"limits.force={0.9 * abs(force)}", f"limits.contact_pressure={1.1 * pressure}"]
    held = run(Case.from_toml(path, overrides=[*changes, *limits]), tmp_path / "held").result
    found = {line.name: line for line in judge_result(held).lines}
    assert found["force of punch"].state == "fail"
    assert found["contact pressure on tools"].state == "ok"
    assert len(found["contact pressure on tools"].at_mm) == 2, "a run in the plane has places of two coordinates"
    assert held.summary["status"] == "completed", "the limits of the equipment stop no run"
    assert judge_result(held).text().startswith("result: fail")


def test_verdict_of_an_output_folder_is_that_of_its_summary(tmp_path: Path) -> None:
    folder = write_upset_output(tmp_path / "upset")
    write_summary(folder / "summary.json", {**DONE, "laps": []})
    found = judge_result(Result(folder))
    assert (found.state, [line.name for line in found.lines]) == ("ok", ["run", "laps", "warnings of the run"])


def test_first_crack_and_parting_lead_to_their_times() -> None:
    found = {
        "cracks": 2,
        "pieces": 2,
        "first_crack": {"time_s": 0.4, "stroke_mm": 3.5},
        "parted": {"time_s": 0.8, "stroke_mm": 7.0},
    }
    lines = {line.name: line for line in judge_summary({"status": "completed", "separation": found}).lines}
    assert (lines["first crack"].time_s, lines["separation"].time_s) == (0.4, 0.8)
    assert lines["first crack"].state == "figure"
