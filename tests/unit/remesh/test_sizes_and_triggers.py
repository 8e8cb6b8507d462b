# SPDX-License-Identifier: Apache-2.0
"""How large cells are to be, and when the mesh is no longer good enough."""

import numpy as np
import pytest

from presswork.geometry.polygon import list_sides
from presswork.mesh.checks import MeshError
from presswork.mesh.make.structured import mesh_rectangle
from presswork.mesh.topology import chain_edges
from presswork.model import Remeshing
from presswork.process.mesh_change.mesh_reasons import find_cause
from presswork.remesh.old_section import OldSection
from presswork.remesh.section import remesh_section
from presswork.remesh.section_sizes import measure_sizes
from presswork.remesh.size_field import GRADATION, GradedSize, SizeSources, grade, metal_thickness, tool_curvature
from presswork.remesh.triggers import (
    count_across,
    find_closing_gap,
    find_cut_edge,
    find_few_across,
    find_flat_cell,
    find_long_edge,
)

# a block 10 x 4 whose right half is a flash of thickness 0.8 above the plane y = 0
SECTION = np.array(
    [[0, 0], [2, 0], [5, 0], [7, 0], [10, 0], [10, 0.8], [7, 0.8], [5, 0.8], [5, 4], [0, 4]], dtype=float
)
ROUNDED = np.array([[8, 5, 6, 5, 0, 0, 0], [6, 5, 5, 6, 6, 6, -1], [5, 6, 5, 9, 0, 0, 0]], dtype=float)


def test_size_grows_from_its_sources_by_the_gradation_only():
    sources = SizeSources(np.array([[0.0, 0.0], [4.0, 0.0]]), np.array([0.2, 0.5]))
    at = np.array([[0, 0], [1, 0], [4, 0], [4, 1], [90, 0]], dtype=float)
    size = grade(at, sources, 1.0, 0.1)
    expected = np.minimum(
        1.0, np.min(sources.size + GRADATION * np.linalg.norm(at[:, None] - sources.place, axis=2), axis=1)
    )
    assert (size <= expected + 1e-12).all()
    np.testing.assert_allclose(size, expected, rtol=0.15)
    field = GradedSize(at[:4], sources, 1.0, 0.1)
    np.testing.assert_allclose(field(at[:4]), size[:4], atol=0.03)


def test_thickness_is_measured_inwards_and_doubled_at_a_symmetry_plane():
    in_plane = np.zeros(len(SECTION), dtype=bool)
    in_plane[:4] = True
    thickness = metal_thickness(list_sides(SECTION), in_plane)
    np.testing.assert_allclose(thickness[5:7], 1.6)
    assert thickness[8] == pytest.approx(8.0)
    assert np.isinf(thickness[:4]).all()


def test_tool_radius_counts_where_the_metal_comes_near_only():
    near = tool_curvature(list_sides(SECTION), ROUNDED, 1.5, 0.1)
    assert near.size.min() == pytest.approx(0.25, rel=1e-6)
    assert np.abs(np.hypot(near.place[:, 0] - 6, near.place[:, 1] - 6) - 1).max() < 1e-6
    assert len(tool_curvature(list_sides(SECTION - [0, 30]), ROUNDED, 1.5, 0.1).size) == 0


def test_triggers_name_the_cell_and_the_edge():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]], dtype=float)
    cells = np.array([[0, 1, 2, 3], [1, 4, 5, 2]])
    move = np.zeros_like(points)
    assert find_flat_cell(points, move, cells, 0.2) is None
    move[4:, 0] = -0.95
    assert "(1.5, 0.5)" in find_flat_cell(points, move, cells, 0.2)
    square = points[:4]
    assert find_long_edge(square, lambda p: np.full(len(p), 0.8)) is None
    assert "near (" in find_long_edge(square, lambda p: np.where(p[:, 1] > 0.9, 0.5, 0.8))
    pin = np.array([[0.5, 0.2, 0.5, -0.2, 0.5, 0.0, -1], [0.5, -0.2, 0.5, 0.2, 0.5, 0.0, -1]])
    flat = np.array([[0, 1.0], [-1, 1], [-1, 0], [0, 0], [1, 0], [1, 1]], dtype=float)
    assert "0.2 mm deep" in find_cut_edge(
        flat, [np.array([[0.3, 0, 0.7, 0, 0.5, 0, -1], [0.7, 0, 0.3, 0, 0.5, 0, -1]])]
    )
    assert find_cut_edge(flat, [pin - [0, 5, 0, 5, 0, 5, 0]]) is None


def test_an_edge_round_a_sharp_corner_of_a_tool_is_cut_by_nothing_but_its_length():
    """The last node beneath a punch and the first one beside it; a blunt punch cuts the same edge."""
    sharp = np.array([[1.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.0], [1.0, 0.0, -5.0, 0.0, 0.0, 0.0, 0.0]])
    line = np.array([[0.0, -2.0], [3.0, -2.0], [3.0, 2.0], [1.0, 0.2], [0.8, 0.0], [0.0, 0.0]])
    assert find_cut_edge(line, [sharp]) is None
    assert find_cut_edge(line, [sharp - np.array([0, 0.05, 0, 0.05, 0, 0, 0])]) is None
    assert "deep" in find_cut_edge(line, [sharp - np.array([0, 0.4, 0, 0.4, 0, 0, 0])])


def test_a_finer_mesh_keeps_to_the_budget():
    mesh = mesh_rectangle(np.linspace(0, 10, 21), np.linspace(0, 10, 21), element="quad4_fbar")
    nothing = np.zeros((1, len(mesh.points)), dtype=bool)
    old = OldSection(mesh, mesh.points, nothing, np.zeros((len(mesh.points), 2), bool), (), False, range(441))
    free, bound = Remeshing(1.0, 0.5), Remeshing(1.0, 0.5, max_cells=120)
    middle = np.array([[5.0, 5.0]])
    assert measure_sizes(old, free, part=0.5)(middle)[0] == pytest.approx(0.5)
    assert measure_sizes(old, bound, part=0.5)(middle)[0] == pytest.approx(np.sqrt(100 / 120), rel=0.02)


@pytest.mark.parametrize("height", [1e-200, 1e-12])
def test_a_body_that_has_been_pressed_flat_gets_no_mesh_and_says_so(height):
    mesh = mesh_rectangle(np.linspace(0, 10, 3), np.linspace(0, height, 3), element="quad4_fbar")
    nothing = np.zeros((1, len(mesh.points)), dtype=bool)
    old = OldSection(mesh, mesh.points, nothing, np.zeros((len(mesh.points), 2), bool), (), True, range(9))
    with pytest.raises(MeshError, match="the body has no volume left: its outline of 10 mm encloses"):
        remesh_section(old, Remeshing(1.0, 0.5))


def test_metal_too_thin_for_its_cells_is_told_where_smaller_ones_are_asked_for():
    """A strip of 20 x 2 mm in two rows; a third row is asked for, or is not."""
    mesh = mesh_rectangle(np.linspace(0, 20, 11), np.linspace(0, 2, 3), element="quad4_fbar")
    edges = chain_edges(mesh.boundary_edges, mesh.points)
    sides = mesh.points[edges]
    thickness = metal_thickness(sides, np.zeros(len(sides), dtype=bool))
    across = count_across(sides, mesh.blocks[0].connectivity, edges, mesh.points, thickness)
    flat = np.abs(sides[:, 0, 1] - sides[:, 1, 1]) < 1e-12
    assert across[flat] == pytest.approx(2.0)
    assert across[~flat] == pytest.approx(10.0)
    found = find_few_across(sides, across, np.full(len(sides), 4.0))
    assert found is not None
    assert "2 cells across the metal near (" in found
    assert find_few_across(sides, across, np.full(len(sides), 2.2)) is None
    assert find_few_across(sides, 1.5 * across, np.full(len(sides), 4.0)) is None
    assert find_few_across(sides, across, np.full(len(sides), 4.0), wait=1.5) is None


def test_a_gap_that_closes_is_found_and_one_that_stays_is_not():
    """Two walls of a slot 0.6 mm wide with edges of 1 mm: they come nearer, move together, or part."""
    line = np.array([[0, 0], [3, 0], [3, 3], [1.8, 3], [1.8, 2], [1.8, 1], [1.2, 1], [1.2, 2], [1.2, 3], [0, 3.0]])
    sides = list_sides(line)
    for speed, closes in ((-0.2, True), (0.2, False), (-0.02, False)):
        moves = np.zeros_like(line)
        moves[2:6, 0] = speed
        found = find_closing_gap(sides, list_sides(moves))
        assert (found is not None) == closes
    assert find_closing_gap(sides, np.full_like(sides, 0.3)) is None


def test_every_reason_has_its_number_in_the_history():
    reasons = (
        "due", "the next increment fails", "a cell near (1, 2) of quality 0.1 after the next increment",
        "a tool 0.2 mm deep in an edge near (1, 2)", "an edge 1.6 times too long near (1, 2)",
        "2 cells across the metal near (1, 2)", "the stable step is below 0.3 of that of the mesh at first",
        "a gap of 0.1 mm to another body, narrow for an edge of 1 mm near (1, 2)", "asked for",
    )  # fmt: skip
    assert [find_cause(reason) for reason in reasons] == list(range(1, 10))
