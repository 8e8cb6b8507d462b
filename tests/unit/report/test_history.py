# SPDX-License-Identifier: Apache-2.0
"""The curves of the page: tools that take turns have the way of their stage; temperatures, ram and damage are found."""

from __future__ import annotations

import numpy as np

from presswork.report.history import (
    _choose_charts,
    _find_idle,
    _find_strokes,
    _find_strokes_at_work,
    describe_column,
)

TURNS = {
    "time": np.array([0.1, 0.2, 0.3, 1.1, 1.2, 1.3]),
    "stage": np.array(["block", "block", "block", "finish", "finish", "finish"]),
    "blocker.stroke": np.array([1.0, 2.0, 3.0, -60.0, -60.0, -60.0]),
    "blocker.force": np.array([10.0, 20.0, 30.0, 0.0, 0.0, 0.0]),
    "finisher.stroke": np.array([0.0, 0.0, 0.0, 52.5, 53.0, 53.5]),
    "finisher.force": np.array([0.0, 0.0, 0.0, 40.0, 50.0, 60.0]),
}


def test_tools_that_take_turns_have_the_way_of_their_stage() -> None:
    ways = _find_strokes(TURNS)
    nan = np.nan
    np.testing.assert_allclose(ways["blocker.way_in_stage"], [1.0, 2.0, 3.0, nan, nan, nan])
    np.testing.assert_allclose(ways["finisher.way_in_stage"], [nan, nan, nan, 0.5, 1.0, 1.5])


def test_tools_that_work_together_keep_their_strokes() -> None:
    both = {**TURNS, "blocker.force": np.ones(6)}
    assert _find_strokes(both) == {}
    alone = {name: values for name, values in TURNS.items() if "blocker" not in name}
    assert _find_strokes(alone) == {}


def test_tools_of_a_press_line_have_their_strokes_while_they_press() -> None:
    line = {
        "stage": np.array(["draw_form", "draw_form", "draw_springback", "flange_laid", "flange_down"]),
        "draw_punch.stroke": np.array([1.0, 2.0, 2.0, 0.0, 0.0]),
        "draw_punch.force": np.array([10.0, 20.0, 0.0, 0.0, 0.0]),
        "flange_punch.stroke": np.array([0.0, 0.0, 0.0, 0.0, 3.0]),
        "flange_punch.force": np.array([0.0, 0.0, 0.0, 0.0, 5.0]),
    }
    strokes = _find_strokes_at_work(line)
    nan = np.nan
    np.testing.assert_allclose(strokes["draw_punch.way_in_operation"], [1.0, 2.0, nan, nan, nan])
    np.testing.assert_allclose(strokes["flange_punch.way_in_operation"], [nan, nan, nan, nan, 3.0])


def test_pauses_between_blows_are_idle() -> None:
    history = {
        "stage": np.array(["blow 1", "blow 1", "pause", "blow 2"]),
        "ram_speed": np.array([5.0, 0.0, 0.0, 4.0]),
    }
    assert _find_idle(history).tolist() == [2]
    assert _find_idle({**history, "ram_speed": np.zeros(4)}).tolist() == []
    assert _find_idle({"stage": history["stage"]}).tolist() == []


def test_charts_show_what_the_run_has() -> None:
    rows = np.ones(3)
    found = _choose_charts(
        {
            "time": rows, "process_time": rows, "temperature_max": rows, "die.temperature_max": rows, "ram_force": rows,
            "ram_speed": rows, "damage_cockcroft_latham_max": rows, "damage_oyane_max": 0 * rows, "iterations": rows,
        }
    )  # fmt: skip
    told = {chart["title"]: (chart["over"], chart["columns"]) for chart in found}
    assert told == {
        "Force on the ram": ("ram_stroke", ["ram_force"]),
        "Speed of the ram": ("process_time", ["ram_speed"]),
        "Temperature": ("process_time", ["temperature_max", "die.temperature_max"]),
        "Damage, largest": ("process_time", ["damage_cockcroft_latham_max"]),
        "Convergence: iterations an increment": ("time", ["iterations"]),
    }
    assert [chart["title"] for chart in _choose_charts({"time": rows})] == []


def test_force_on_the_ram_stands_beside_what_the_press_bears_over_the_stroke() -> None:
    rows = np.ones(3)
    crank = {"time": rows, "ram_force": rows, "ram_force_borne": 2 * rows, "ram_speed": rows}
    first = _choose_charts(crank)[0]
    assert (first["over"], first["columns"]) == ("ram_stroke", ["ram_force", "ram_force_borne"])
    assert describe_column("ram_force_borne") == ("force that the press bears", "kN", 1e-3)
