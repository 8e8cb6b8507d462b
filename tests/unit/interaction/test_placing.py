# SPDX-License-Identifier: Apache-2.0
"""Tools that forces place: the travel of the bordered system, and a workpiece that nothing holds."""

import numpy as np
import pytest

from presswork.interaction.placing import Border, LostWorkpieceError


def make_border(held: float) -> Border:
    """One node on a spring of 1 - held to the tool, held to the ground by a spring of `held` [N/mm]."""
    between = 1.0 - held
    response = between / (between + held)  # the node's motion for each mm of travel
    return Border([np.array([[-between]])], np.array([between]), [np.array([[response]])])


def test_the_travel_of_a_tool_on_two_springs_in_a_row_is_that_of_both():
    stiffness = 0.5 * 0.5 / (0.5 + 0.5)
    travel = make_border(0.5).find_travel(np.array([3.0]), np.zeros((1, 1)))
    assert travel[0] == pytest.approx(3.0 / stiffness)


def test_a_workpiece_that_moves_along_with_a_pushed_tool_is_named():
    with pytest.raises(LostWorkpieceError, match="nothing holds it"):
        make_border(0.0).find_travel(np.array([3.0]), np.zeros((1, 1)))
