# SPDX-License-Identifier: Apache-2.0
"""Parts read for the one-step solver: what is mended and said, what is refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from presswork.mesh import MeshError
from presswork.mesh.files.part_file import MOST_TRIANGLES, count_refined, read_part, refine_edges


def hat(walls: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return a trough along y: bottom, two walls that lean out by `walls` [mm], flanges; quadrilaterals wound alike."""
    x = np.array([-40.0, -20.0 - walls, -20.0, 20.0, 20.0 + walls, 40.0])
    z = np.array([10.0, 10.0, 0.0, 0.0, 10.0, 10.0])
    y = np.linspace(0.0, 30.0, 4)
    points = np.array([[a, b, c] for a, c in zip(x, z, strict=True) for b in y])
    index = np.arange(24).reshape(6, 4)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    return points, quads


def write(path: Path, points: np.ndarray, *blocks: tuple[str, np.ndarray]) -> Path:
    meshio.Mesh(points, list(blocks)).write(path)
    return path


def halves(quads: np.ndarray) -> np.ndarray:
    return quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def test_stl_is_merged_and_faces_up(tmp_path):
    points, quads = hat()
    path = write(tmp_path / "hat.stl", points, ("triangle", halves(quads)[:, ::-1]))
    part, notes = read_part(path)
    assert part.points.shape == (24, 3)
    assert part.triangles.shape == (30, 3)
    assert len(part.rims) == 1
    a, b, c = (part.points[part.triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > -1e-9).all()
    assert notes == ()


def test_quadrilaterals_stay_and_turned_ones_are_said(tmp_path):
    points, quads = hat()
    quads[4] = quads[4][::-1]
    part, notes = read_part(write(tmp_path / "hat.vtk", points, ("quad", quads)))
    assert part.quadrilaterals.shape == (15, 4)
    assert part.points == pytest.approx(points)
    assert notes == ("1 of 15 cells are wound against their neighbours: turned over",)


def test_draw_direction_turns_the_part(tmp_path):
    points, quads = hat()
    turned = points[:, [2, 0, 1]] * [-1.0, 1.0, 1.0]  # the punch's way -z becomes +x
    path = write(tmp_path / "hat.vtk", turned, ("quad", quads))
    part, _ = read_part(path, draw_direction="x")
    assert np.ptp(part.points[:, 2]) == pytest.approx(10.0)
    a, b, c = (part.points[part.quadrilaterals[:, k]] for k in range(3))
    assert np.cross(b - a, c - a)[:, 2].sum() == pytest.approx(80.0 * 30.0)


def test_undercut_is_refused_where_it_is(tmp_path):
    points, quads = hat(walls=-5.0)
    with pytest.raises(MeshError, match=r"undercut.*leans 27 degrees") as caught:
        read_part(write(tmp_path / "hat.vtk", points, ("quad", quads)))
    assert "draw direction" in caught.value.remedy


def test_vertical_walls_are_no_undercut(tmp_path):
    points, quads = hat(walls=0.0)
    assert len(read_part(write(tmp_path / "hat.vtk", points, ("quad", quads)))[0].quadrilaterals) == 15


def test_two_parts_are_refused(tmp_path):
    points, quads = hat()
    both = np.concatenate([points, points + np.array([100.0, 0.0, 0.0])])
    with pytest.raises(MeshError, match=r"holds 2 parts.*x 60 to 140"):
        read_part(write(tmp_path / "two.vtk", both, ("quad", np.concatenate([quads, quads + 24]))))


def test_non_manifold_edges_are_refused(tmp_path):
    points, quads = hat()
    rib = np.concatenate([points, points[8:12] + np.array([0.0, 0.0, 8.0])])
    fins = np.stack([[8, 9, 25, 24], [9, 10, 26, 25]])
    with pytest.raises(MeshError, match="edges belong to more than two cells"):
        read_part(write(tmp_path / "rib.vtk", rib, ("quad", np.concatenate([quads, fins]))))


def test_closed_body_is_refused(tmp_path):
    box = np.array([[x, y, z] for x in (0.0, 20.0) for y in (0.0, 20.0) for z in (0.0, 20.0)])
    faces = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    with pytest.raises(MeshError, match=r"undercut|closed body"):
        read_part(write(tmp_path / "box.stl", box, ("triangle", halves(faces))))


def test_flat_triangles_are_dropped_and_said(tmp_path):
    points, quads = hat()
    extra = np.array([[0, 1, 1]])
    part, notes = read_part(write(tmp_path / "hat.vtk", points, ("triangle", np.concatenate([halves(quads), extra]))))
    assert len(part.triangles) == 30
    assert notes[0].startswith("1 triangles have no area, the first is number 31")


def test_wrong_unit_is_named(tmp_path):
    points, quads = hat()
    with pytest.raises(MeshError, match=r"0\.08\d+ mm across") as caught:
        read_part(write(tmp_path / "hat.vtk", points * 1e-3, ("quad", quads)))
    assert '"m"' in caught.value.remedy


@pytest.mark.parametrize("scale", [1e3, 1e-3])
def test_a_wrong_unit_names_that_of_the_files_own_numbers_first(tmp_path, scale):
    points, quads = hat()
    with pytest.raises(MeshError, match=r'give its unit: "mm" \(86.02 mm\)'):
        read_part(write(tmp_path / "hat.vtk", points, ("quad", quads)), scale=scale)


@pytest.mark.parametrize("size", [1e-300, 1e-7, 0.05])
def test_an_element_size_too_small_is_refused_before_anything_is_refined(tmp_path, size):
    points, quads = hat()
    path = write(tmp_path / "hat.vtk", points, ("triangle", halves(quads)))
    with pytest.raises(MeshError, match=f"about .* triangles, more than {MOST_TRIANGLES:,}; choose a larger element"):
        read_part(path, element_size=size)
    mixed = write(tmp_path / "mixed.vtk", points, ("triangle", halves(quads[:3])), ("quad", quads[3:]))
    with pytest.raises(MeshError, match="triangles and quadrilaterals cannot be refined"):
        read_part(mixed, element_size=size)


@pytest.mark.parametrize("size", [100.0, 8.0, 3.0, 1.0, 0.4])
def test_the_count_of_refined_triangles_is_told_before(size):
    """A halved edge is between half of size and size long, so up to four times as many come out."""
    points, quads = hat()
    triangles = halves(quads).astype(np.int32)
    count = len(refine_edges(points, triangles, size)[1])
    assert 0.2 * count <= count_refined(points, triangles, size) <= 1.0 * count


def test_refinement_halves_long_edges_and_keeps_the_surface():
    points, quads = hat()
    fine, triangles = refine_edges(points, halves(quads).astype(np.int32), 4.0)
    corners = fine[triangles]
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= 4.0
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(30.0 * (2 * 20.0 + 2 * 10.0 + 40.0))
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert count.max() == 2
    rim = fine[np.unique(np.unique(edges, axis=0)[count == 1])]
    on_rim = (np.abs(np.abs(rim[:, 0]) - 40.0) < 1e-9) | (rim[:, 1] < 1e-9) | (rim[:, 1] > 30.0 - 1e-9)
    assert on_rim.all()


def test_a_gap_in_the_model_is_told_and_a_pierced_hole_is_not(tmp_path):
    n = 13
    x, y = (each.ravel() for each in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    points = np.column_stack([x, y, np.zeros(n * n)]).astype(float)
    number = np.arange(n * n).reshape(n, n)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    row = (n - 1) * 4 + 4
    _, notes = read_part(
        write(tmp_path / "gap.stl", points, ("triangle", halves(np.delete(quads, [row, row + 1], axis=0))))
    )
    assert notes == ("a hole of 6 edges near (4.5, 5, 0) is kept: are triangles missing?",)
    block = [row + i * (n - 1) + j for i in range(2) for j in range(2)]
    assert (
        read_part(write(tmp_path / "hole.stl", points, ("triangle", halves(np.delete(quads, block, axis=0)))))[1] == ()
    )
