# SPDX-License-Identifier: Apache-2.0
"""Meshes cut along lines: what is kept has the area of the line, and cells of good shape."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.polygon import list_sides, measure_distance, polygon_area
from presswork.mesh import MeshError
from presswork.mesh.cut import CutMesh, cut_mesh
from presswork.mesh.make.blanks import mesh_circular_blank, mesh_rectangular_blank
from presswork.model import FloatArray, Mesh

SIZE = (40.0, 30.0)
BLANKS = {
    "rectangle": mesh_rectangular_blank(SIZE, 2.0, [False, False]),
    "circle": mesh_circular_blank(38.0, 2.0, [False, False]),
}


def circle(radius: float, centre: tuple[float, float] = (1.1, -0.7)) -> FloatArray:
    angle = 2 * np.pi * np.arange(500) / 500
    return centre + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def rectangle(turn: float) -> FloatArray:
    corners = np.array([[-11.3, -7.7], [12.1, -7.7], [12.1, 8.2], [-11.3, 8.2]])
    return corners @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])


LINES = {
    **{f"turned {turn:.2f}": rectangle(turn) for turn in np.linspace(0.0, 0.8, 9)},
    "L": np.array([[-10.4, -8.3], [9.7, -8.3], [9.7, 1.3], [0.4, 1.3], [0.4, 9.2], [-10.4, 9.2]]),
    "pentagon": np.array([[-12.2, -9.1], [10.0, -10.3], [14.1, 2.2], [2.3, 10.4], [-9.9, 6.1]]),
    "on the grid": np.array([[-10.0, -9.0], [10.0, -9.0], [10.0, 9.0], [-10.0, 9.0]]),
}


def areas(points: FloatArray, cells: np.ndarray) -> FloatArray:
    corners = points[cells] - points[cells].mean(axis=1, keepdims=True)
    return 0.5 * np.cross(corners, np.roll(corners, -1, axis=1)).sum(axis=1)[:, 2]


def cut(mesh: Mesh, line: FloatArray, keep: str = "inside") -> tuple[CutMesh, FloatArray]:
    """Return what is left of a mesh, and where its nodes are."""
    found = cut_mesh(mesh.points, tuple(b.connectivity for b in mesh.blocks), line, keep)
    return found, found.weights @ mesh.points


def area_of(found: CutMesh, points: FloatArray) -> float:
    return sum(float(areas(points, cells.connectivity).sum()) for cells in found.cells)


@pytest.mark.parametrize("keep", ["inside", "outside"])
@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
@pytest.mark.parametrize("blank", BLANKS)
def test_what_is_kept_of_a_line_of_straight_sides_has_its_area(blank, line, keep) -> None:
    mesh = BLANKS[blank]
    found, points = cut(mesh, line, keep)
    whole = float(areas(mesh.points, mesh.blocks[0].connectivity).sum())
    expected = polygon_area(line) if keep == "inside" else whole - polygon_area(line)
    assert area_of(found, points) == pytest.approx(expected, rel=1e-9)
    assert found.off_line < 1e-9
    assert measure_distance(list_sides(line), points[found.cut_edges].reshape(-1, 3)[:, :2]).max() < 1e-9
    for cells in found.cells:
        assert areas(points, cells.connectivity).min() > 0.01 * 2.0**2
        corners = points[cells.connectivity]
        along, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
        lengths = np.linalg.norm(along, axis=2), np.linalg.norm(back, axis=2)
        assert (np.cross(along, back)[..., 2] / (lengths[0] * lengths[1])).min() > 0.12


@pytest.mark.parametrize("keep", ["inside", "outside"])
def test_the_outline_misses_a_circle_by_its_chords_with_the_square_of_the_element_size(keep) -> None:
    """A chord of length c is off by c^2/8R; none is longer than the diagonal of an element and a half."""
    radius, line, errors = 11.3, circle(11.3), []
    for size in (2.0, 1.0, 0.5):
        mesh = mesh_rectangular_blank(SIZE, size, [False, False])
        found, points = cut(mesh, line, keep)
        kept = np.pi * radius**2 if keep == "inside" else SIZE[0] * SIZE[1] - np.pi * radius**2
        errors.append(abs(area_of(found, points) - kept))
        chord = float(np.linalg.norm(np.diff(points[found.cut_edges], axis=1), axis=2).max())
        assert chord < 1.5 * np.sqrt(2) * size
        assert found.off_line < 1.02 * chord**2 / (8 * radius)
    assert errors[1] < 0.4 * errors[0]
    assert errors[2] < 0.4 * errors[1]
    assert errors[2] < 1e-3 * np.pi * radius**2


def test_a_tip_narrower_than_an_element_is_measured() -> None:
    """Of 53 degrees: edges that both of its sides cross are not cut."""
    line = np.array([[-12.2, -9.1], [11.0, -2.3], [-3.3, 8.4]])
    found, points = cut(BLANKS["circle"], line)
    assert 0.2 < found.off_line < 2.0
    assert area_of(found, points) == pytest.approx(polygon_area(line), abs=2.0 * found.off_line)


def test_every_new_cell_lies_in_its_parent() -> None:
    """By the place of its middle in the parent's natural coordinates."""
    mesh = BLANKS["rectangle"]
    found, points = cut(mesh, LINES["L"])
    offsets = []
    for cells in found.cells:
        x, y = cells.natural.mean(axis=1).T
        shape = 0.25 * np.stack([(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)], axis=1)
        old = mesh.points[mesh.blocks[cells.parent[0, 0]].connectivity[cells.parent[:, 1]]]
        middle = np.einsum("ca,cai->ci", shape, old)
        offsets.append(np.linalg.norm(points[cells.connectivity].mean(axis=1) - middle, axis=1))
    away = np.concatenate(offsets)
    assert away.max() < 0.5 * 2.0, "no farther than nodes were moved"
    assert np.median(away) < 1e-9


def test_a_quarter_is_cut_as_the_whole_is() -> None:
    """The line crosses the symmetry planes; nodes on them stay there."""
    quarter = mesh_rectangular_blank(SIZE, 2.0, [True, True])
    found, points = cut(quarter, circle(11.3, (0.0, 0.0)))
    assert area_of(found, points) == pytest.approx(np.pi * 11.3**2 / 4, rel=1e-2)
    share = found.weights.toarray()
    for axis, name in enumerate(("symmetry_x", "symmetry_y")):
        own = np.isin(np.arange(len(quarter.points)), quarter.node_sets[name])
        on_plane = np.abs(points[:, axis]) < 1e-12
        assert on_plane.sum() == 7
        assert (share[on_plane][:, ~own] == 0).all()


def test_triangles_and_quadrilaterals_are_cut_alike() -> None:
    mesh = BLANKS["rectangle"]
    quads = mesh.blocks[0].connectivity
    line = LINES["turned 0.30"]
    halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    odd = np.concatenate([quads[1::2][:, [0, 1, 2]], quads[1::2][:, [0, 2, 3]]])
    for blocks in ((halves,), (quads[::2], odd)):
        found = cut_mesh(mesh.points, blocks, line, "inside")
        assert area_of(found, found.weights @ mesh.points) == pytest.approx(polygon_area(line), rel=1e-9)


@pytest.mark.parametrize(("line", "keep", "message"), [
    (circle(40), "inside", "cuts nothing off, for it runs round all of the sheet"),
    (circle(40), "outside", "nothing is left outside"),
    (circle(5, (90, 0)), "inside", "nothing is left inside of the line, for it runs beside the sheet"),
    (circle(5, (90, 0)), "outside", "cuts nothing off"),
    (np.array([[-50, -4.2], [50, -4.2], [50, 4.2], [-50, 4.2]]), "outside", "leaves 2 parts"),
    (np.array([[-9, -8], [9, -8], [9, 8], [0.3, 8], [0.3, -7], [-0.3, -7], [-0.3, 8], [-9, 8.0]]), "inside",
     "narrower than an element, at"),
])  # fmt: skip
def test_lines_that_cannot_be_followed_are_refused(line, keep, message) -> None:
    with pytest.raises(MeshError, match=message):
        cut(BLANKS["rectangle"], line, keep)
