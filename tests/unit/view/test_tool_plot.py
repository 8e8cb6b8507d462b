# SPDX-License-Identifier: Apache-2.0
"""The hatched metal lies on the right of the profile."""

from __future__ import annotations

import numpy as np

from presswork.view.plots.tool_plot import offset_to_right


def test_line_moves_to_its_right() -> None:
    line = np.array([[14.0, 15.0], [-2.0, 15.0]])  # leftwards: its right is above
    np.testing.assert_allclose(offset_to_right(line, 0.5), line + np.array([0.0, 0.5]))


def test_square_corner_is_mitred() -> None:
    line = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    np.testing.assert_allclose(offset_to_right(line, 1.0), [[0, -1], [3, -1], [3, 2]])
