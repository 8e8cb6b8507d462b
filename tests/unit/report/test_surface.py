# SPDX-License-Identifier: Apache-2.0
"""The surface of a page is that of the mesh: its area, its lines once, the faces' own cells."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.report.surface import find_surface
from presswork.results import Result, ResultMesh
from presswork.results.reader import ResultBlock
from tests.unit.results.upset_output import write_upset_output


@pytest.mark.parametrize("elements", [("tri3",), ("quad4",), ("tri3", "quad4"), ("tri6_6pt", "quad8", "quad9")])
def test_triangles_of_a_section_cover_it_once(tmp_path: Path, elements: tuple[str, ...]) -> None:
    mesh = Result(write_upset_output(tmp_path, elements, n=6, steps=1)).mesh
    surface = find_surface(mesh)
    corners = surface.take_points(mesh.points)[surface.triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(150.0)
    cells = np.concatenate([mesh.points[b.connectivity].mean(axis=1) for b in mesh.blocks])
    middles = corners.mean(axis=1)
    nearest = np.linalg.norm(cells[surface.cells[surface.faces]] - middles, axis=1)
    assert (nearest < 2.0).all(), "a triangle lies in its own cell"


def test_lines_are_those_of_the_cells_each_once(tmp_path: Path) -> None:
    mesh = Result(write_upset_output(tmp_path, ("quad4",), n=4, steps=1)).mesh
    assert len(find_surface(mesh).lines) == 2 * 4 * 5
    with_middles = Result(write_upset_output(tmp_path / "8", ("quad8",), n=4, steps=1)).mesh
    assert len(find_surface(with_middles).lines) == 2 * 2 * 4 * 5


def test_boundary_goes_round_the_section(tmp_path: Path) -> None:
    mesh = Result(write_upset_output(tmp_path, ("quad9",), n=4, steps=1)).mesh
    surface = find_surface(mesh)
    ends = surface.take_points(mesh.points)[surface.boundary]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(50.0)
    x, y = ends[:, :, 0], ends[:, :, 1]
    assert 0.5 * (x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]).sum() == pytest.approx(150.0), "the body on the left"


def test_of_a_solid_in_space_only_its_skin_is_kept() -> None:
    n = 4
    grid = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    a, b = slice(0, n), slice(1, n + 1)
    order = [(a, a, a), (b, a, a), (b, b, a), (a, b, a), (a, a, b), (b, a, b), (b, b, b), (a, b, b)]
    cells = np.stack([grid[place].ravel() for place in order], axis=1)
    points = np.stack(np.meshgrid(*[np.arange(n + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    surface = find_surface(ResultMesh(points, (ResultBlock("hex8", 12, cells),), np.zeros((0, 2), dtype=np.int64)))
    assert len(surface.cells) == 6 * n * n
    assert len(surface.nodes) == (n + 1) ** 3 - (n - 1) ** 3
    corners = surface.take_points(points)[surface.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert 0.5 * np.linalg.norm(normal, axis=1).sum() == pytest.approx(6.0 * n * n)
    assert (corners[:, 0] * normal).sum() / 6 == pytest.approx(n**3), "normals point outwards"
    middle = points[cells].mean(axis=1)[surface.cells[surface.faces]]
    assert (np.abs(corners.mean(axis=1) - middle) < 0.51).all(), "a face lies at its own cell"


def test_with_the_inside_every_cell_of_a_solid_has_its_nodes_and_its_value() -> None:
    n = 3
    grid = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    a, b = slice(0, n), slice(1, n + 1)
    order = [(a, a, a), (b, a, a), (b, b, a), (a, b, a), (a, a, b), (b, a, b), (b, b, b), (a, b, b)]
    cells = np.stack([grid[place].ravel() for place in order], axis=1)
    points = np.stack(np.meshgrid(*[np.arange(n + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    mesh = ResultMesh(points, (ResultBlock("hex8", 12, cells),), np.zeros((0, 2), dtype=np.int64))
    outer, whole = find_surface(mesh), find_surface(mesh, has_inside=True)
    np.testing.assert_array_equal(whole.triangles, outer.triangles)
    np.testing.assert_array_equal(whole.cells[: len(outer.cells)], outer.cells)
    assert len(whole.cells) == len(outer.cells) + 1, "of 27 cells one has no face"
    np.testing.assert_array_equal(whole.take_cells(np.arange(27.0))[whole.owners], np.arange(27.0))
    np.testing.assert_array_equal(whole.take_points(points)[whole.hexahedra], points[cells])
