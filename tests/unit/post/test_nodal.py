# SPDX-License-Identifier: Apache-2.0
"""Nodal averages of cell values."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.post import average_to_nodes, cell_areas
from tests.unit.results.upset_output import make_mesh

ELEMENTS = ["tri3", "tri6_6pt", "quad4", "quad8", "quad9"]


@pytest.mark.parametrize("element", ELEMENTS)
def test_areas_of_the_cells_sum_to_that_of_the_mesh(element: str) -> None:
    mesh = make_mesh((element,), 4)
    assert cell_areas(mesh.points, mesh.blocks[0].connectivity).sum() == pytest.approx(150.0)


@pytest.mark.parametrize("element", ELEMENTS)
def test_constant_stays_constant(element: str) -> None:
    mesh = make_mesh((element, "quad4"), 4)
    cells = [block.connectivity for block in mesh.blocks]
    values = np.full((sum(map(len, cells)), 2), [3.0, -1.0])
    np.testing.assert_allclose(
        average_to_nodes(mesh.points, cells, values), np.full((len(mesh.points), 2), [3.0, -1.0])
    )


def test_shared_node_weighs_its_cells_by_area() -> None:
    points = np.array([[0, 0], [3, 0], [4, 0], [0, 1], [3, 1], [4, 1], [9, 9]], dtype=float)
    cells = [np.array([[0, 1, 4, 3], [1, 2, 5, 4]])]
    mean = average_to_nodes(points, cells, np.array([10.0, 20.0]))
    np.testing.assert_allclose(mean, [10, 12.5, 20, 10, 12.5, 20, np.nan])


def test_mid_side_and_centre_take_the_mean_of_their_corners() -> None:
    mesh = make_mesh(("quad9",), 2)
    cells = mesh.blocks[0].connectivity
    mean = average_to_nodes(mesh.points, [cells], np.array([1.0, 2.0, 3.0, 4.0]))
    assert mean[cells[0, 4]] == pytest.approx((mean[cells[0, 0]] + mean[cells[0, 1]]) / 2)
    assert mean[cells[0, 8]] == pytest.approx(mean[cells[0, :4]].mean())
