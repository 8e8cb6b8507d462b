# SPDX-License-Identifier: Apache-2.0
"""Axes around bodies in space: labels stand clear of the numbers, and inside the picture."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from presswork.view.plots.shell_plot import frame_axes


@pytest.mark.parametrize("size", [(60.0, 12.0, 7.0), (80.0, 80.0, 25.0), (10.0, 10.0, 40.0)])
def test_labels_of_axes_lie_beside_the_numbers_and_inside_the_picture(size: tuple[float, float, float]) -> None:
    figure = Figure((7.0, 5.2), layout="constrained")
    ax = figure.add_subplot(projection="3d")
    ax.set_proj_type("ortho")
    ax.view_init(25, -60)
    frame_axes(ax, np.zeros(3), np.array(size))
    FigureCanvasAgg(figure).draw()
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        label = axis.label.get_window_extent()
        low, high = axis.get_view_interval()
        numbers = [tick.label1.get_window_extent() for tick in axis.majorTicks if low <= tick.get_loc() <= high]
        assert len(numbers) >= 2
        assert not any(label.overlaps(number) for number in numbers)
        assert label.x0 >= 0.0
        assert label.y0 >= 0.0
