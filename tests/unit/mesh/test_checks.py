# SPDX-License-Identifier: Apache-2.0
"""Meshes from outside that cannot be computed with are refused with the place and the remedy."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.mesh import MeshError, mesh_rectangle
from presswork.mesh.checks import (
    check_connected,
    check_coordinates,
    corner_jacobians,
    reverse_cells,
    wind_counter_clockwise,
)
from presswork.model import ElementName

LINES = np.arange(4.0)
ELEMENTS: list[ElementName] = ["tri3", "tri6_6pt", "quad4", "quad8", "quad9"]


@pytest.mark.parametrize("element", ELEMENTS)
def test_cells_all_clockwise_are_turned_over(element: ElementName) -> None:
    mesh = mesh_rectangle(LINES, LINES, element=element)
    cells = mesh.blocks[0].connectivity
    clockwise = reverse_cells(cells)
    assert (corner_jacobians(mesh.points, clockwise) < 0).all()
    turned, was_turned = wind_counter_clockwise(mesh.points, clockwise)
    assert was_turned
    np.testing.assert_array_equal(turned, cells)


def test_counter_clockwise_cells_are_left_alone() -> None:
    mesh = mesh_rectangle(LINES, LINES, element="quad4")
    assert not wind_counter_clockwise(mesh.points, mesh.blocks[0].connectivity)[1]


@pytest.mark.parametrize("element", ELEMENTS)
def test_some_inverted_cells_are_named(element: ElementName) -> None:
    mesh = mesh_rectangle(LINES, LINES, element=element)
    cells = mesh.blocks[0].connectivity.copy()
    cells[[2, 5]] = reverse_cells(cells[[2, 5]])
    with pytest.raises(MeshError, match=rf"2 of {len(cells)} cells are inverted.*cell 3, 6, the first near \(.*mesher"):
        wind_counter_clockwise(mesh.points, cells)


def test_mid_side_node_that_folds_a_cell_is_found() -> None:
    mesh = mesh_rectangle(np.array([0.0, 1.0]), np.array([0.0, 1.0]), element="quad8")
    points = mesh.points.copy()
    points[mesh.blocks[0].connectivity[0, 4], 0] = 0.1
    with pytest.raises(MeshError, match="folded"):
        wind_counter_clockwise(points, mesh.blocks[0].connectivity)


def test_unconnected_parts_are_counted_and_placed() -> None:
    mesh = mesh_rectangle(LINES, LINES, element="quad4")
    points = np.concatenate([mesh.points, mesh.points + np.array([3.0, 0.0])])
    cells = np.concatenate([mesh.blocks[0].connectivity, mesh.blocks[0].connectivity + len(mesh.points)])
    with pytest.raises(MeshError) as caught:
        check_connected(points, cells)
    for fragment in ("2 parts", "9 cells in x 3 to 6", "4 pairs of coincident nodes", "merge the coincident nodes"):
        assert fragment in str(caught.value)


def test_overlapping_cells_are_found() -> None:
    mesh = mesh_rectangle(LINES, LINES, element="quad4")
    cells = np.concatenate([mesh.blocks[0].connectivity, mesh.blocks[0].connectivity[:1]])
    with pytest.raises(MeshError, match="more than two cells"):
        check_connected(mesh.points, cells)


def test_nodes_that_no_workpiece_has_are_refused() -> None:
    for bad, says in ((np.inf, "not finite numbers"), (-1e308, "1e+308 mm from the origin")):
        with pytest.raises(MeshError) as error:
            check_coordinates(np.array([[0.0, 1.0], [2.0, bad]]))
        assert says in str(error.value)
    check_coordinates(np.array([[0.0, 1e5]]))
