# SPDX-License-Identifier: Apache-2.0
"""Folds of one cell: the void between two faces that have nearly closed on each other is filled on a new mesh."""

import numpy as np
import pytest

from presswork.model import CellBlock, Mesh, Remeshing
from presswork.process.mesh_change.laps import find_laps, mark_laps
from presswork.process.mesh_change.reasons_in_space import find_reason, measure_left
from presswork.process.mesh_change.seams import Seams
from presswork.remesh.space import fill as fill_module
from presswork.remesh.space import remesh
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.fill import FilledBody
from presswork.remesh.space.notches import FILLED, fill_notches, find_notches, list_planes, measure_notch
from presswork.remesh.space.remesh import remesh_body
from presswork.remesh.space.size_field import EdgeSizes
from presswork.remesh.space.tetrahedra import find_skin, measure_quality, measure_volumes
from presswork.remesh.space.triggers import find_notch
from tests.unit.remesh.space.bodies import mesh_box, place_block

ROOT, WIDTH, TOP = 3.0, 4.0, 6.0


def notched_block(angle, tools=()):
    """A block of 8 x 4 x 6 mm, half of one with a plane y = 0 of symmetry, cut open above z = 3 by an angle."""
    points, cells = mesh_box((8, 4, 6), (8.0, WIDTH, TOP))
    cut = np.flatnonzero((points[:, 0] == 4.0) & (points[:, 2] > ROOT))
    twin = np.arange(len(points), len(points) + len(cut))
    right = points[cells].mean(axis=1)[:, 0] > 4.0
    place = np.arange(len(points))
    place[cut] = twin
    cells = np.where(right[:, None], place[cells], cells)
    half = (points[cut, 2] - ROOT) * np.tan(np.radians(angle / 2))
    points = np.concatenate([points, points[cut] + np.outer(half, [1.0, 0.0, 0.0])])
    points[cut, 0] -= half
    held = np.zeros(points.shape, dtype=bool)
    held[points[:, 1] == 0.0, 1] = True
    faces, _ = find_skin(cells)
    sets = {"bottom": faces[(points[faces, 1] == 0.0).all(axis=1)]}
    return OldBody(points, cells, np.zeros((len(tools), len(points)), dtype=bool), held, sets, list(tools))


def fill(body):
    present = FilledBody(body.points, body.cells, body.faces, body.references[0])
    return fill_notches(present, list_planes(body), body.obstacles)


def test_an_edge_between_faces_that_look_at_each_other_has_the_angle_of_the_void():
    body = notched_block(25.0)
    notches = find_notches(body.points, body.faces, 89.0)
    assert len(notches.angle) == 4, "one edge for each row of cells along the root"
    assert notches.angle == pytest.approx(25.0)
    assert body.points[notches.corners[:, :2], 2] == pytest.approx(ROOT)
    angle, middle = measure_notch(body)
    assert angle == pytest.approx(25.0)
    assert middle[[0, 2]] == pytest.approx([4.0, ROOT])


@pytest.mark.parametrize("angle", [5.0, 25.0])
def test_a_body_whose_notch_is_filled_is_whole(angle):
    body = notched_block(angle)
    filling = fill(body)
    skin, _ = find_skin(filling.body.cells)
    assert {tuple(sorted(f)) for f in skin.tolist()} == {tuple(sorted(f)) for f in filling.body.faces.tolist()}
    assert measure_volumes(body.points, filling.body.cells).min() > 0.0
    assert not len(find_notches(body.points, filling.body.faces, FILLED).angle)
    in_plane = (body.points[filling.body.faces, 1] == 0.0).all(axis=1)
    (number,) = np.unique(filling.body.number[in_plane])
    assert number not in filling.body.number[~in_plane], "what closes the notch in a plane lies in that plane"


def test_a_new_mesh_has_no_notch_keeps_the_volume_and_tells_the_seam():
    body = notched_block(20.0)
    new = remesh_body(body, EdgeSizes(1.0, 0.8, 20_000))
    assert not len(find_notches(new.points, new.faces, FILLED).angle)
    assert measure_volumes(new.points, new.cells).sum() == pytest.approx(body.volume, rel=1e-12)
    assert measure_quality(new.points, new.cells).min() > 0.05
    assert np.abs(new.seam[:, 0] - 4.0).max() < 0.2
    assert new.seam[:, 2].min() == pytest.approx(ROOT)


def test_a_wide_void_stays_and_so_does_one_that_a_tool_fills():
    assert fill(notched_block(70.0)).added == 0
    ridge = place_block((3.85, -1.0, ROOT + 0.2), (4.15, WIDTH + 1.0, 9.0))
    body = notched_block(25.0, [ridge])
    assert fill(body).added == 0
    assert measure_notch(body)[0] == 180.0


def test_a_notch_asks_for_a_new_mesh_unless_this_one_was_made_with_it():
    body, settings = notched_block(20.0), Remeshing(size=1.0, smallest_size=0.8)
    still = np.zeros_like(body.points)
    reason = find_reason(body, still, settings, 1.0)
    assert reason is not None
    assert reason.startswith("a notch of 20 degrees near (4, ")
    assert find_reason(body, still, settings, 1.0, left=measure_left(body, settings)) is None
    assert find_notch(notched_block(35.0)) is None


def test_a_seam_in_space_moves_with_the_metal_and_is_a_lap_with_the_area_of_one_side():
    points, cells = mesh_box((4, 4, 4), (4.0, 4.0, 4.0))
    faces, _ = find_skin(cells)
    block = CellBlock("tet4_mini", cells.astype(np.int32), 0)
    mesh = Mesh(points, (block,), {}, {}, np.zeros((0, 2), np.int32), boundary_faces=faces.astype(np.int32))
    side = np.array([[2.0, 1.0, 1.0], [2.0, 2.0, 1.0], [2.0, 1.0, 2.0]])
    seams = Seams()
    both = np.concatenate([side, side[::-1]])
    seams.go_on(mesh, seams.places(points), [both], 0.5)
    seams.go_on(mesh, seams.places(points), [both + np.array([0.0, 0.5, 0.0])], 0.6)
    assert len(seams.groups()) == 1, "one lap that has grown"
    assert seams.extents(points) == pytest.approx([1.0])
    assert seams.extents(2.0 * points) == pytest.approx([4.0])
    none = np.zeros(len(points))
    (lap,) = find_laps(mesh, points, none, seams)
    assert lap.extent == pytest.approx(1.0)
    assert mark_laps(none, seams).sum() > 0.0
    again = Seams()
    again.load_arrays(seams.to_arrays())
    assert again.extents(points) == seams.extents(points)
    assert again.begun == 0.5


def test_a_mesh_that_comes_out_with_a_notch_is_made_again(monkeypatch):
    """MMG leaves new ones where the old skin overlaps itself."""
    body = notched_block(5.0)
    made = []

    def mesh_to_size(present, size, **keys):
        made.append(len(present.cells))
        if len(made) == 1:
            return FilledBody(body.points, body.cells, body.faces, body.references[0])
        return fill_module.mesh_to_size(present, size, **keys)

    monkeypatch.setattr(remesh, "mesh_to_size", mesh_to_size)
    new = remesh_body(body, EdgeSizes(1.0, 0.8, 20_000))
    assert made[0] == made[1] > len(body.cells)
    assert not len(find_notches(new.points, new.faces, FILLED).angle)
