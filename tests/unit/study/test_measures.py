# SPDX-License-Identifier: Apache-2.0
"""What a sweep's table says of tools, of a press line at the end of their operation, and of faults."""

from __future__ import annotations

import numpy as np

from presswork.study.measures import _list_faults, _measure_tools

LINE = {
    "stage": np.array(["draw_form", "draw_form", "draw_springback", "draw_2_laid", "draw_2_form", "draw_2_trim"]),
    "draw_punch.stroke": np.array([1.0, 20.0, 20.0, 0.0, 0.0, 0.0]),
    "draw_punch.force": np.array([3e3, 2e3, 0.0, 0.0, 0.0, 0.0]),
    "draw_2_punch.stroke": np.array([0.0, 0.0, 0.0, 0.0, 7.0, 7.0]),
    "draw_2_punch.force": np.array([0.0, 0.0, 0.0, 0.0, 5e3, 0.0]),
}


def test_tools_of_a_press_line_have_the_stroke_and_force_of_their_operations_end() -> None:
    found = _measure_tools(LINE, ["draw", "draw_2"])
    assert found == {
        "draw_punch.stroke": 20.0,
        "draw_punch.force": 2e3,
        "draw_punch.max_force": 3e3,
        "draw_2_punch.stroke": 7.0,
        "draw_2_punch.force": 5e3,
        "draw_2_punch.max_force": 5e3,
    }


def test_tools_of_one_operation_have_those_of_the_last_row() -> None:
    found = _measure_tools(LINE)
    assert found["draw_punch.stroke"] == 0.0
    assert found["draw_2_punch.stroke"] == 7.0
    assert found["draw_2_punch.force"] == 0.0


def test_the_first_crack_is_the_earlier_of_damage_and_forming_limit_and_laps_are_counted() -> None:
    def crack(time: float, **strokes: float) -> dict[str, object]:
        return {"time_s": time, "strokes_mm": strokes}

    damage = {"damage_oyane": {"first_exceeded": crack(0.3, punch=-12.0, ejector=2.0)}, "damage_freudenthal": {}}
    summary = {"laps": [{}, {}], "damage": damage, "first_crack": crack(0.5, punch=20.0), "warnings": ["a", "b"]}
    found = _list_faults(summary)
    assert found == {"laps": 2, "first_crack_stroke": 12.0, "first_crack_time": 0.3, "warnings": "a | b"}
    assert _list_faults({"first_crack": crack(0.5)}) == {"first_crack_time": 0.5, "warnings": ""}
    assert _list_faults({}) == {"warnings": ""}
