# SPDX-License-Identifier: Apache-2.0
"""The table of cells: what each row says must fit the places of the cell's nodes, and meshio's names."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest
from meshio._vtk_common import vtk_to_meshio_type

from presswork.model import CELLS, ELEMENTS, Cell, FloatArray, cell_of, find_cell

EVERY = pytest.mark.parametrize("cell", CELLS.values(), ids=lambda cell: cell.name)
PLANE = pytest.mark.parametrize("cell", [c for c in CELLS.values() if c.dimension == 2], ids=lambda cell: cell.name)
SPACE = pytest.mark.parametrize("cell", [c for c in CELLS.values() if c.dimension == 3], ids=lambda cell: cell.name)


def measure(simplices: FloatArray) -> FloatArray:
    """Return the signed length, area or volume of simplices (n, d + 1, d)."""
    d = simplices.shape[2]
    return np.linalg.det(simplices[:, 1:] - simplices[:, :1]) / factorial(d)


def size_of(cell: Cell) -> float:
    return 1.0 / factorial(cell.dimension) if cell.is_simplex and cell.dimension > 1 else 2.0**cell.dimension


def test_dimension_and_nodes_name_a_cell() -> None:
    for cell in CELLS.values():
        assert find_cell(cell.dimension, np.zeros((0, cell.nodes), dtype=np.int32)) is cell


def test_every_element_lives_on_a_cell_of_the_table() -> None:
    for element in ELEMENTS.values():
        assert cell_of(element.name).nodes == element.nodes
        assert not element.in_implicit or element.points in cell_of(element.name).rules


@EVERY
def test_edges_have_their_middle_between_their_ends(cell: Cell) -> None:
    first, last, *middle = np.moveaxis(cell.places[cell.edges], 1, 0)
    for place in middle:
        np.testing.assert_array_equal(place, 0.5 * (first + last))
    corners = range(cell.corners)
    assert set(cell.edges[:, :2].ravel()) == set(corners)
    assert sorted({*corners, *cell.edges.ravel(), *cell.inner}) == list(range(cell.nodes))


@EVERY
def test_simplices_fill_the_cell(cell: Cell) -> None:
    sizes = measure(cell.places[cell.simplices])
    assert (sizes > 0.0).all()
    assert sizes.sum() == pytest.approx(size_of(cell))


@EVERY
def test_a_reversed_cell_is_inside_out_and_keeps_its_edges(cell: Cell) -> None:
    turned = cell.places[cell.reversed]
    assert (measure(turned[cell.simplices]) < 0.0).all()
    ends = {frozenset(edge[:2]): list(edge[2:]) for edge in cell.edges.tolist()}
    assert {frozenset(e[:2]): list(e[2:]) for e in cell.reversed[cell.edges].tolist()} == ends
    assert cell.reversed[cell.reversed].tolist() == list(range(cell.nodes))


@pytest.mark.parametrize("cell", [c for c in CELLS.values() if c.dimension < 3], ids=lambda cell: cell.name)
def test_pieces_cover_a_line_or_plane_cell_with_all_its_nodes(cell: Cell) -> None:
    sizes = measure(cell.places[cell.pieces])
    assert (sizes > 0.0).all()
    assert sizes.sum() == pytest.approx(size_of(cell))
    assert set(cell.pieces.ravel()) == set(range(cell.nodes))
    assert cell.ring[:: 1 + cell.is_quadratic].tolist() == list(range(cell.corners))


@PLANE
def test_spans_give_twice_the_area(cell: Cell) -> None:
    one, other = (cell.places[last] - cell.places[first] for first, last in cell.spans)
    assert one[0] * other[1] - one[1] * other[0] == pytest.approx(2.0 * size_of(cell))


@SPACE
def test_faces_close_the_cell_and_are_wound_outwards(cell: Cell) -> None:
    face = find_cell(2, cell.faces)
    assert face.is_quadratic == cell.is_quadratic
    for nodes in cell.faces:
        one, other = (cell.places[nodes[last]] - cell.places[nodes[first]] for first, last in face.spans)
        away = cell.places[nodes].mean(axis=0) - cell.places.mean(axis=0)
        assert np.cross(one, other) @ away > 0.0
    edges = [tuple(edge) for edge in cell.faces[:, face.edges].reshape(-1, face.edges.shape[1]).tolist()]
    assert len(set(edges)) == len(edges) == 2 * len(cell.edges)  # each edge twice, once each way
    assert {(last, first, *middle) for first, last, *middle in edges} == set(edges)
    assert {frozenset(edge) for edge in edges} == {frozenset(edge) for edge in cell.edges.tolist()}


@EVERY
def test_rules_integrate_a_constant_and_shapes_interpolate(cell: Cell) -> None:
    for points, rule in cell.rules.items():
        assert len(rule.weights) == points
        assert rule.weights.sum() == pytest.approx(size_of(cell))
        np.testing.assert_allclose(rule.shapes.sum(axis=1), 1.0)
        places = rule.shapes @ cell.places
        np.testing.assert_allclose(
            np.einsum("qai,aj->qji", rule.slopes, cell.places), [np.eye(cell.dimension)] * points, atol=1e-14
        )
        np.testing.assert_allclose(
            rule.weights @ places, cell.places[: cell.corners].mean(axis=0) * size_of(cell), atol=1e-14
        )


@PLANE
def test_mass_shares_follow_the_squares_of_the_shape_functions(cell: Cell) -> None:
    """Hinton, Rock & Zienkiewicz (1976)."""
    rule = cell.rules[max(cell.rules)]
    squares = rule.weights @ rule.shapes**2
    np.testing.assert_allclose(cell.mass_shares, squares / squares.sum())


def test_ten_node_tetrahedra_have_the_shares_of_the_integrals_in_closed_form() -> None:
    """Over the volume int L1^a L2^b = 6 a! b! / (a + b + 3)!; corners have L (2 L - 1), middles 4 L1 L2."""

    def integrate(a: int, b: int = 0) -> float:
        return 6.0 * factorial(a) * factorial(b) / factorial(a + b + 3)

    corner, middle = 4.0 * integrate(4) - 4.0 * integrate(3) + integrate(2), 16.0 * integrate(2, 2)
    shares = np.array([corner] * 4 + [middle] * 6)
    np.testing.assert_allclose(CELLS["tet10"].mass_shares, shares / shares.sum())


@EVERY
def test_names_in_files_are_those_of_vtk_and_meshio(cell: Cell) -> None:
    assert vtk_to_meshio_type[cell.files.vtk] == cell.files.meshio
