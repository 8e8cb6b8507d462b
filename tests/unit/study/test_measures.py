# SPDX-License-Identifier: Apache-2.0
"""What a sweep's table says of tools: of a press line each one at the end of its own operation."""

from __future__ import annotations

import numpy as np

from presswork.study.measures import _measure_tools

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
