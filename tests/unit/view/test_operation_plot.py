# SPDX-License-Identifier: Apache-2.0
"""What pictures of force against stroke are called, by operations of a line and by stages that place tools."""

from types import SimpleNamespace

import numpy as np
import pytest

from presswork.view.plots.operation_plot import list_operations


@pytest.mark.parametrize(
    ("operations", "names"), [("draw\nhem\nhem_two", ["draw", "hem_two"]), ("", ["draw_form", "hem_two_hold"])]
)
def test_an_operation_of_several_stages_has_the_name_of_the_operation(operations: str, names: list[str]) -> None:
    stages = ["draw_form", "draw_form", "hem_two_hold", "hem_two_press"]
    history = {
        "stage": np.array(stages),
        "time": np.arange(4.0),
        "draw_punch.stroke": np.array([1.0, 2.0, 0.0, 0.0]),
        "draw_punch.force": np.array([5.0, 6.0, 0.0, 0.0]),
        "hem_two_steel.stroke": np.array([0.0, 0.0, 0.1, 0.2]),
        "hem_two_steel.force": np.array([0.0, 0.0, 7.0, 9.0]),
    }
    result = SimpleNamespace(history=history, info={"operations": operations, "placing": "hem_two_hold"})
    assert [operation.name for operation in list_operations(result)] == names
