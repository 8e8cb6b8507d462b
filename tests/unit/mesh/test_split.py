# SPDX-License-Identifier: Apache-2.0
"""Shells split in four: balance, hanging nodes, sets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.mesh.make.blanks import mesh_circular_blank, mesh_rectangular_blank
from presswork.mesh.split import SplitMesh


def areas(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    x = points[cells]
    return np.asarray(0.5 * np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])[:, 2])


def halve(cells: np.ndarray) -> np.ndarray:
    """One quadrilateral in three becomes two triangles."""
    cut = np.arange(len(cells)) % 3 == 0
    return np.concatenate([cells[cut][:, [0, 1, 2, 2]], cells[cut][:, [0, 2, 3, 3]], cells[~cut]])


@pytest.mark.parametrize("with_triangles", [False, True])
def test_random_splits_stay_balanced_and_cover_the_blank(with_triangles: bool) -> None:
    """Children tile their parents; a hanging node lies in the middle of a side whose ends do not hang."""
    blank = mesh_circular_blank(120.0, 5.0, (True, True))
    cells = blank.blocks[0].connectivity
    points = blank.points
    mesh = SplitMesh.begin(halve(cells) if with_triangles else cells, len(points))
    whole, rng = areas(points, mesh.cells).sum(), np.random.default_rng(3)
    for _ in range(4):
        finest = np.flatnonzero(mesh.level == mesh.level.max())
        step = mesh.split(np.isin(np.arange(len(mesh.cells)), rng.choice(finest, 2)))
        sizes = np.bincount(step.parent, areas(step.interpolate(points), step.mesh.cells))
        np.testing.assert_allclose(sizes, areas(points, mesh.cells), rtol=1e-12)
        points, mesh = step.interpolate(points), step.mesh
        hanging = mesh.hanging()
        assert not np.isin(hanging[:, 1:3], hanging[:, 0]).any()
        assert len(np.unique(hanging[:, 0])) == len(hanging)
        np.testing.assert_allclose(points[hanging[:, 0]], points[hanging[:, 1:3]].mean(axis=1), atol=1e-12)
        assert len(mesh.unbalanced()) == 0
    assert mesh.level.max() == 4
    assert len(np.unique(mesh.level)) == 5  # balance splits others, but not all
    assert areas(points, mesh.cells).min() > 0
    assert areas(points, mesh.cells).sum() == pytest.approx(whole, rel=1e-12)
    assert mesh.n_nodes == len(points) == len(np.unique(mesh.cells))


def test_a_node_hangs_where_one_neighbour_is_whole_and_no_longer_when_it_is_split() -> None:
    blank = mesh_rectangular_blank((2.0, 1.0), 1.0, (False, False))
    one = SplitMesh.begin(blank.blocks[0].connectivity, 6).split(np.array([True, False])).mesh
    assert one.hanging()[:, :3].tolist() == [[one.middles(np.array([[1, 4, 1, 4]]))[0, 0], 4, 1]]
    assert len(one.split(one.level == 0).mesh.hanging()) == 0


def test_sets_and_boundary_follow_the_split() -> None:
    """New nodes join the sets of their side, a strip of one row of shells included; boundary edges become halves."""
    blank = mesh_rectangular_blank((8.0, 2.0), 2.0, (True, True))
    mesh = SplitMesh.begin(blank.blocks[0].connectivity, len(blank.points))
    for _ in range(2):
        step = mesh.split(np.arange(len(mesh.cells)) < 3)
        blank, mesh = step.apply(blank), step.mesh
    x, y = blank.points[:, 0], blank.points[:, 1]
    expected = {"symmetry_x": x == 0, "symmetry_y": y == 0, "left": x == 0, "right": x == 4, "bottom": y == 0,
                "top": y == 1, "all": x >= 0}  # fmt: skip
    for name, mask in expected.items():
        np.testing.assert_array_equal(np.sort(blank.node_sets[name]), np.flatnonzero(mask))
    np.testing.assert_array_equal(np.sort(blank.node_sets["edge"]), np.flatnonzero((x == 4) | (y == 1)))
    ends = blank.points[blank.boundary_edges]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(10.0)
    assert np.isin(np.flatnonzero((x == 0) | (y == 0) | (x == 4) | (y == 1)), blank.boundary_edges).all()
    loop = dict(blank.boundary_edges.tolist())
    assert len(loop) == len(blank.boundary_edges)


def test_blocks_of_triangles_and_quadrilaterals_stay_what_they_are() -> None:
    blank = mesh_rectangular_blank((8.0, 4.0), 2.0, (True, True))
    quads = blank.blocks[0].connectivity
    mixed = (replace(blank.blocks[0], connectivity=quads[:1]),
             replace(blank.blocks[0], connectivity=np.concatenate([quads[1:, :3], quads[1:, [0, 2, 3]]])))  # fmt: skip
    cells = np.concatenate([quads[:1], mixed[1].connectivity[:, [0, 1, 2, 2]]])
    step = SplitMesh.begin(cells, len(blank.points)).split(np.arange(len(cells)) < 2)
    first, second = step.apply(replace(blank, blocks=mixed)).blocks
    assert (first.connectivity.shape, second.connectivity.shape) == ((4, 4), (len(cells) - 2 + 4, 3))
