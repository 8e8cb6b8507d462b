# SPDX-License-Identifier: Apache-2.0
"""Lines of the grain flow between nodes."""

import numpy as np
import pytest
from matplotlib.tri import LinearTriInterpolator, Triangulation

from presswork.view.plots.flow_lines_plot import _refine


def net(sign):
    """A shaken grid over the unit square, mirrored in x or not."""
    shake = np.random.default_rng(0).uniform(-0.02, 0.02, (2, 12, 12))
    shake[:, [0, -1]] = shake[:, :, [0, -1]] = 0.0
    x, y = (shake + np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12))).reshape(2, -1)
    return Triangulation(sign * x, y)


@pytest.mark.parametrize("sign", [1, -1])
def test_places_between_nodes_follow_lines_exactly_and_curves_closer_than_straight_sides(sign):
    coarse = net(sign)
    linear = np.stack([2 + 3 * coarse.x - coarse.y, coarse.y], axis=1)
    finer, found = _refine(coarse, linear)
    np.testing.assert_allclose(found, np.stack([2 + 3 * finer.x - finer.y, finer.y], axis=1), atol=1e-13)
    curved = np.sin(3 * coarse.y) + coarse.x * coarse.y
    _, found = _refine(coarse, curved[:, None])
    exact = np.sin(3 * finer.y) + finer.x * finer.y
    straight = np.asarray(LinearTriInterpolator(coarse, curved)(finer.x, finer.y))
    assert np.linalg.norm(found[:, 0] - exact) < 0.5 * np.linalg.norm(straight - exact)
