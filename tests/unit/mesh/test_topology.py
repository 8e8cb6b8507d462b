# SPDX-License-Identifier: Apache-2.0
"""Edges, parts and unused points."""

from __future__ import annotations

import numpy as np

from presswork.mesh.topology import drop_unused_points, find_boundary_edges, find_parts, list_cell_edges, select_edges

TWO_QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]], dtype=np.int32)


def test_edges_of_a_cell_run_round_it() -> None:
    np.testing.assert_array_equal(list_cell_edges(TWO_QUADS[:1]), [[0, 1], [1, 4], [4, 3], [3, 0]])
    six = np.arange(6, dtype=np.int32)[None, :]
    np.testing.assert_array_equal(list_cell_edges(six), [[0, 1, 3], [1, 2, 4], [2, 0, 5]])


def test_boundary_leaves_out_the_shared_edge() -> None:
    edges = find_boundary_edges([TWO_QUADS]).tolist()
    assert edges == [[0, 1], [4, 3], [3, 0], [1, 2], [2, 5], [5, 4]]


def test_boundary_of_mixed_cells_is_found_across_blocks() -> None:
    triangle = np.array([[2, 6, 5]], dtype=np.int32)
    edges = find_boundary_edges([TWO_QUADS, triangle]).tolist()
    assert [2, 5] not in edges
    assert [2, 6] in edges


def test_edges_are_selected_by_all_their_nodes() -> None:
    edges = find_boundary_edges([TWO_QUADS])
    np.testing.assert_array_equal(select_edges(edges, np.array([0, 1, 2], dtype=np.int32)), [[0, 1], [1, 2]])


def test_parts_share_no_node() -> None:
    n_parts, part = find_parts([np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)], 6)
    assert n_parts == 2
    np.testing.assert_array_equal(part, [0, 0, 0, 1, 1, 1])


def test_unused_points_are_dropped() -> None:
    points, number = drop_unused_points(np.arange(8.0).reshape(4, 2), [np.array([[0, 2, 3]], dtype=np.int32)])
    np.testing.assert_array_equal(points[:, 0], [0, 4, 6])
    np.testing.assert_array_equal(number, [0, -1, 1, 2])
