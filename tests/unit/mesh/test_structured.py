# SPDX-License-Identifier: Apache-2.0
"""Structured meshes: node order, winding, area, sets, grading, numbering."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from presswork.mesh import fitting_patterns, grade_line, mesh_rectangle
from presswork.mesh.checks import corner_jacobians
from presswork.mesh.make.structured import Pattern
from presswork.model import ElementName, FloatArray, Mesh, SpaceElement, cell_of, take_corners

FLAT = [element for element in get_args(ElementName) if element not in get_args(SpaceElement)]
MESHES = [(element, pattern) for element in FLAT for pattern in fitting_patterns(element)]
X_LINES = grade_line(1.0, [(10.0, 3, 2.0)])
Y_LINES = grade_line(-2.0, [(15.0, 5, 0.5)])


def rectangle(element: ElementName, pattern: Pattern) -> Mesh:
    return mesh_rectangle(X_LINES, Y_LINES, element=element, pattern=pattern)


def corner_areas(points: FloatArray, mesh: Mesh) -> FloatArray:
    corners = points[take_corners(mesh.blocks[0].connectivity)]
    after = np.roll(corners, -1, axis=1)
    cross = corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]
    return 0.5 * np.sum(cross, axis=1)


@pytest.mark.parametrize(("element", "pattern"), MESHES)
def test_cells_are_counter_clockwise_and_fill_the_rectangle(element: ElementName, pattern: Pattern) -> None:
    mesh = rectangle(element, pattern)
    areas = corner_areas(mesh.points, mesh)
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(150.0)
    assert (corner_jacobians(mesh.points, mesh.blocks[0].connectivity) > 0).all()


@pytest.mark.parametrize(("element", "pattern"), MESHES)
def test_nodes_are_corners_then_mid_sides_then_the_centre(element: ElementName, pattern: Pattern) -> None:
    mesh = rectangle(element, pattern)
    cells = mesh.blocks[0].connectivity
    n_nodes = cells.shape[1]
    n_corners = cell_of(element).corners
    assert n_nodes == cell_of(element).nodes
    corners = mesh.points[cells[:, :n_corners]]
    if n_nodes > n_corners:
        middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
        np.testing.assert_allclose(mesh.points[cells[:, n_corners : 2 * n_corners]], middles, atol=1e-12)
    if n_nodes == 9:
        np.testing.assert_allclose(mesh.points[cells[:, 8]], corners.mean(axis=1), atol=1e-12)


@pytest.mark.parametrize(("element", "pattern"), MESHES)
def test_every_node_is_used_once_and_nodes_are_apart(element: ElementName, pattern: Pattern) -> None:
    mesh = rectangle(element, pattern)
    assert set(mesh.blocks[0].connectivity.ravel()) == set(range(len(mesh.points)))
    assert len(np.unique(mesh.points.round(9), axis=0)) == len(mesh.points)


@pytest.mark.parametrize(("element", "pattern"), MESHES)
def test_boundary_runs_counter_clockwise_round_the_body(element: ElementName, pattern: Pattern) -> None:
    mesh = rectangle(element, pattern)
    edges = mesh.boundary_edges
    start, end = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
    assert 0.5 * np.sum(start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]) == pytest.approx(150.0)
    assert len(edges) == 2 * (3 + 5)
    if edges.shape[1] == 3:
        np.testing.assert_allclose(mesh.points[edges[:, 2]], 0.5 * (start + end), atol=1e-12)


@pytest.mark.parametrize(("element", "pattern"), MESHES)
def test_sets_lie_on_their_sides(element: ElementName, pattern: Pattern) -> None:
    mesh = rectangle(element, pattern)
    sides = {"left": (0, 1.0, 5), "right": (0, 11.0, 5), "bottom": (1, -2.0, 3), "top": (1, 13.0, 3)}
    for name, (axis, position, n_edges) in sides.items():
        np.testing.assert_allclose(mesh.points[mesh.node_sets[name], axis], position)
        assert len(mesh.edge_sets[name]) == n_edges
        assert set(mesh.edge_sets[name].ravel()) == set(mesh.node_sets[name])
        assert (np.diff(mesh.node_sets[name]) > 0).all()
    np.testing.assert_allclose(mesh.points[mesh.node_sets["top_right"]], [[11.0, 13.0]])
    assert len(mesh.node_sets["all"]) == len(mesh.points)


def test_crossed_pattern_has_its_fourth_node_where_the_diagonals_meet() -> None:
    mesh = mesh_rectangle(np.array([0.0, 2.0]), np.array([0.0, 1.0]), element="tri3", pattern="crossed")
    assert mesh.blocks[0].connectivity.shape == (4, 3)
    shared = set.intersection(*(set(cell) for cell in mesh.blocks[0].connectivity))
    np.testing.assert_allclose(mesh.points[shared.pop()], [1.0, 0.5])


@pytest.mark.parametrize(("pattern", "slope"), [("right", 1.0), ("left", -1.0)])
def test_diagonals_lean_as_named(pattern: Pattern, slope: float) -> None:
    mesh = mesh_rectangle(np.array([0.0, 1.0]), np.array([0.0, 1.0]), element="tri3", pattern=pattern)
    shared = set.intersection(*(set(cell) for cell in mesh.blocks[0].connectivity))
    ends = mesh.points[sorted(shared)]
    assert (ends[1, 1] - ends[0, 1]) / (ends[1, 0] - ends[0, 0]) == slope


def test_pattern_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="quad does not make cells for tri3"):
        rectangle("tri3", "quad")


def test_grading_is_geometric_within_each_zone() -> None:
    lines = grade_line(2.0, [(7.0, 3, 4.0), (1.0, 2, 1.0)])
    np.testing.assert_allclose(np.diff(lines), [1.0, 2.0, 4.0, 0.5, 0.5])
    assert lines[3] == 9.0
    assert lines[-1] == 10.0


@pytest.mark.parametrize("shape", [(2, 40), (40, 2)])
def test_numbering_is_banded_along_the_shorter_side(shape: tuple[int, int]) -> None:
    mesh = mesh_rectangle(np.arange(shape[0] + 1.0), np.arange(shape[1] + 1.0), element="tri6_6pt", pattern="crossed")
    cells = mesh.blocks[0].connectivity
    assert (cells.max(axis=1) - cells.min(axis=1)).max() < 40
