# SPDX-License-Identifier: Apache-2.0
"""The search for edges that may touch, against looking at every pair."""

import numpy as np
import pytest

from presswork import _core


def polyline(n: int, y: np.ndarray, first: int, *, leftwards: bool) -> tuple[np.ndarray, np.ndarray]:
    x = np.linspace(0.0, 10.0, n + 1)
    points = np.column_stack([x[::-1] if leftwards else x, y])
    edges = first + np.column_stack([np.arange(n), np.arange(1, n + 1)])
    return points, edges.astype(np.int32)


@pytest.mark.parametrize("margin", [0.0, 0.5, 2.0])
def test_pairs_within_the_margin_are_found(margin) -> None:
    rng = np.random.default_rng(4)
    lower, slave = polyline(23, rng.uniform(0.0, 0.5, 24), 0, leftwards=True)
    upper, master = polyline(17, rng.uniform(0.6, 2.0, 18), len(lower), leftwards=False)
    x = np.concatenate([lower, upper])
    found = {tuple(pair) for pair in _core.find_edge_pairs(slave, master, x, margin, False).tolist()}
    wanted = set()
    for s, a in enumerate(slave):
        for m, b in enumerate(master):
            apart = np.maximum(x[b].min(axis=0) - x[a].max(axis=0), x[a].min(axis=0) - x[b].max(axis=0)).max()
            along = (x[a[1]] - x[a[0]], x[b[1]] - x[b[0]])
            cosine = along[0] @ along[1] / np.linalg.norm(along[0]) / np.linalg.norm(along[1])
            if apart <= margin and cosine < 0.3:
                wanted.add((s, m))
    assert found == wanted
    assert (len(found) > 0) == (margin > 0)


def test_edges_of_one_body_pair_once_and_not_with_their_neighbours() -> None:
    lower, first = polyline(5, np.full(6, 1.0), 0, leftwards=True)
    upper, second = polyline(5, np.full(6, 1.2), 6, leftwards=False)
    tip = np.array([[5, 6]], dtype=np.int32)  # closes the slot at its left end
    edges = np.concatenate([first, tip, second])
    pairs = _core.find_edge_pairs(edges, edges, np.concatenate([lower, upper]), 0.5, True)
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert len({tuple(pair) for pair in pairs.tolist()}) == len(pairs) > 5
    for s, m in pairs:
        assert not set(edges[s]) & set(edges[m])


def test_halves_of_quadratic_edges_pair_on_their_own() -> None:
    x = np.array([[2.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 0.1], [2.0, 0.1], [1.0, 0.1]])
    slave, master = np.array([[0, 1, 2]], dtype=np.int32), np.array([[3, 4, 5]], dtype=np.int32)
    assert len(_core.find_edge_pairs(slave, master, x, 0.5, False)) == 4
    shifted = x + np.array([[0.0, 0.0]] * 3 + [[1.6, 0.0]] * 3)
    np.testing.assert_array_equal(_core.find_edge_pairs(slave, master, shifted, 0.2, False), [[0, 0]])
