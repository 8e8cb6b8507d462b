# SPDX-License-Identifier: Apache-2.0
"""New meshes of deformed bodies of tetrahedra between rigid tools."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from presswork import _core
from presswork.geometry.pose import SpacePose
from presswork.geometry.tool_widths import Widths
from presswork.mesh.checks import MeshError
from presswork.model import Limits, Remeshing
from presswork.process.mesh_change.reasons_in_space import Left, find_breach, find_reason, measure_left
from presswork.remesh.space import fill
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.fill import FilledBody, expect_cells, mesh_to_size
from presswork.remesh.space.inside import improve_cells, spread_moves
from presswork.remesh.space.remesh import remesh_body
from presswork.remesh.space.size_field import EdgeSizes, measure_sizes, measure_thickness
from presswork.remesh.space.sliding import slide_on_tools
from presswork.remesh.space.surface import locate_on_skin, place_skin
from presswork.remesh.space.tetrahedra import area_vectors, find_skin, list_edges, measure_quality, measure_volumes
from presswork.remesh.space.triggers import (
    find_cut_edge,
    find_flat_cell,
    find_long_edge,
    measure_cut,
    measure_cut_face,
)
from tests.unit.remesh.space.bodies import (
    ball_on_block,
    indented_block,
    mesh_box,
    place_block,
    place_plane,
    upset_block,
)

BODIES = {upset_block: EdgeSizes(1.5, 0.6, 20_000), indented_block: EdgeSizes(0.6, 0.3, 40_000),
          ball_on_block: EdgeSizes(1.0, 0.4, 20_000)}  # fmt: skip


@pytest.fixture(scope="module", params=BODIES, ids=lambda make: make.__name__)
def pair(request):
    body = request.param()
    return body, remesh_body(body, BODIES[request.param])


def area_in_contact(points, faces, on_tool):
    return np.linalg.norm(area_vectors(points, faces)[on_tool[faces].all(axis=1)], axis=1).sum()


def test_the_volume_is_given_back(pair):
    body, new = pair
    assert measure_volumes(new.points, new.cells).sum() == pytest.approx(body.volume, rel=1e-12)


def test_what_old_meshes_have_lost_comes_back():
    body = replace(upset_block(), lost=4e-4)
    new = remesh_body(body, BODIES[upset_block])
    assert measure_volumes(new.points, new.cells).sum() == pytest.approx(1.0004 * body.volume, rel=1e-12)


@pytest.mark.parametrize("lost", [0.5, np.nan])
def test_a_volume_that_no_offset_gives_back_is_refused(lost):
    with pytest.raises(MeshError, match="of the free surface would be needed"):
        remesh_body(replace(upset_block(), lost=lost), BODIES[upset_block])


def test_cells_are_good(pair):
    _, new = pair
    quality = measure_quality(new.points, new.cells)
    assert quality.min() > 0.2
    assert np.median(quality) > 0.7


def test_nodes_in_contact_lie_on_the_tool_and_none_in_it(pair):
    body, new = pair
    for tool, on_tool in zip(body.tools, new.on_tool, strict=True):
        gap, _ = tool.touch(new.points[on_tool], 1.0)
        assert np.abs(gap).max() < 1e-12
        gap, _ = tool.touch(new.points[new.skin], 1.0)
        assert gap.min() > -1e-12


def test_contact_keeps_its_area(pair):
    """It reaches half an edge beyond its last node, on the old mesh and on the new one."""
    body, new = pair
    for held, on_tool in zip(body.on_tool, new.on_tool, strict=True):
        area = area_in_contact(body.points, body.faces, held)
        assert area_in_contact(new.points, new.faces, on_tool) == pytest.approx(area, rel=0.1)


def test_planes_stay_flat_to_the_bit_and_sets_are_their_nodes(pair):
    body, new = pair
    assert set(new.sets) == set(body.sets)
    for axis, level, own in body.planes:
        area = np.linalg.norm(area_vectors(body.points, body.faces[own]), axis=1).sum()
        flat = (new.points[new.faces, axis] == level).all(axis=1)
        assert np.linalg.norm(area_vectors(new.points, new.faces[flat]), axis=1).sum() == pytest.approx(area, rel=0.01)
    if body.sets:
        assert (new.points[new.sets["left"], 0] == 0.0).all()


def test_the_skin_is_that_of_the_cells_and_lies_on_the_old_one(pair):
    body, new = pair
    faces, _ = find_skin(new.cells)
    assert {tuple(sorted(face)) for face in faces.tolist()} == {tuple(sorted(face)) for face in new.faces.tolist()}
    before = np.einsum("ks,ksi->ki", new.share, body.points[new.corners])
    assert np.linalg.norm(before - new.points[new.skin], axis=1).max() < 0.25
    assert new.share.min() >= 0.0
    np.testing.assert_allclose(new.share.sum(axis=1), 1.0, atol=1e-12)


def test_sharp_edges_of_tools_become_edges_of_the_mesh():
    body = indented_block(edge=5.35)
    new = remesh_body(body, BODIES[indented_block])
    on_edge = np.flatnonzero(np.hypot(new.points[:, 0] - 5.35, new.points[:, 2] - 6.5) < 1e-9)
    edges = list_edges(new.faces)
    along = edges[np.isin(edges, on_edge).all(axis=1)]
    covered = np.abs(new.points[along[:, 1], 1] - new.points[along[:, 0], 1]).sum()
    assert covered > 0.75 * 4.0


def test_cells_are_small_at_narrow_ridges_and_slots_that_metal_is_near():
    body, sizes = upset_block(), EdgeSizes(1.5, 0.5, 20_000)
    place = np.array([[6.0, 6.0, 7.0]])
    narrow = Widths(place, np.array([1.2]), np.array([True]))
    low, high = body.tools
    beside = np.argmin(np.linalg.norm(body.points - place, axis=1))
    assert measure_sizes(body, sizes)[beside] > 1.2
    near = replace(body, tools=[low, replace(high, widths=narrow)])
    assert measure_sizes(near, sizes)[beside] == pytest.approx(0.6, rel=0.1)
    above = SpacePose(np.zeros(3), np.array([0.0, 0.0, 20.0]), np.zeros(3), None)
    far = replace(body, tools=[low, replace(high, widths=narrow.carry(above))])
    assert measure_sizes(far, sizes)[beside] > 1.2


@pytest.mark.parametrize("count", [0, 1, 7, 60])
def test_the_skin_has_the_faces_of_one_cell_and_edges_are_listed_once_in_order(count):
    _, cells = mesh_box((3, 2, 2), (3.0, 2.0, 2.0))
    cells = np.random.default_rng(5).permutation(cells)[:count].astype(np.int32)
    owners = {}
    for number, cell in enumerate(cells.tolist()):
        for triple in itertools.combinations(sorted(cell), 3):
            owners.setdefault(triple, []).append(number)
    faces, of_cell = find_skin(cells)
    found = {tuple(sorted(face)): [cell] for face, cell in zip(faces.tolist(), of_cell.tolist(), strict=True)}
    assert found == {triple: own for triple, own in owners.items() if len(own) == 1}
    assert (np.diff(of_cell) >= 0).all()
    pairs = {pair for cell in cells.tolist() for pair in itertools.combinations(sorted(cell), 2)}
    assert [tuple(edge) for edge in list_edges(cells).tolist()] == sorted(pairs)


def test_no_face_turns_over_beside_the_end_of_a_contact_at_a_sharp_edge_of_the_body():
    """Nodes just below that edge would pass it on their way to the tool."""
    (points, cells), (wanted, new_cells) = mesh_box((3, 3, 3), (6.0, 6.0, 6.0)), mesh_box((3, 6, 15), (6.0, 6.0, 6.0))
    for nodes in (points, wanted):
        nodes[:, 0] += 0.4 * (nodes[:, 2] - 6.0) * (nodes[:, 0] == 6.0)
    held = np.zeros(points.shape, dtype=bool)
    body = OldBody(points, cells, (points[:, 2] == 6.0)[None], held, {}, [place_plane((0.0, 0.0, -1.0), (0, 0, 6.0))])
    faces, _ = find_skin(new_cells)
    places = locate_on_skin(points, body.faces, wanted[np.unique(faces)])
    placed = place_skin(body, wanted, faces, np.zeros(wanted.shape, dtype=bool), places)
    before, after = area_vectors(wanted, faces), area_vectors(placed.points, faces)
    assert (np.einsum("ki,ki->k", before, after) > 0.0).all()
    np.testing.assert_array_equal(placed.on_tool[0], wanted[:, 2] == 6.0)


def test_points_are_located_on_the_nearest_face_of_all():
    """Against points spread densely over every face of a skin with large and small faces."""
    body = indented_block()
    corners = body.points[body.faces]
    share = np.random.default_rng(2).dirichlet(np.ones(3), 400)
    spread = np.einsum("ps,ksi->kpi", share, corners).reshape(-1, 3)
    wanted = spread[::997] + np.random.default_rng(3).uniform(-0.2, 0.2, (len(spread[::997]), 3))
    found = locate_on_skin(body.points, body.faces, wanted)
    away = np.linalg.norm(np.einsum("ns,nsi->ni", found.share, corners[found.face]) - wanted, axis=1)
    nearest, _ = cKDTree(spread).query(wanted)
    assert (away < nearest + 1e-12).all()
    assert (away > nearest - 0.06).all()


def test_the_same_mesh_comes_out_to_the_bit():
    first, second = (remesh_body(upset_block(), BODIES[upset_block]) for _ in range(2))
    assert first.points.tobytes() == second.points.tobytes()
    assert first.cells.tobytes() == second.cells.tobytes()


def test_a_budget_makes_cells_larger_and_one_that_is_too_small_is_refused():
    body = upset_block()
    sizes = EdgeSizes(0.8, 0.4, 6_000)
    assert expect_cells(body.points, body.cells, measure_sizes(body, sizes)) == pytest.approx(6_000, rel=1e-6)
    assert len(remesh_body(body, sizes).cells) == pytest.approx(6_000, rel=0.2)
    points, cells = mesh_box((6, 6, 2), (6.0, 6.0, 0.5))
    flash = replace(body, points=points, cells=cells, held=np.zeros(points.shape, dtype=bool), sets={}, tools=[],
                    on_tool=np.zeros((0, len(points)), dtype=bool))  # fmt: skip
    assert measure_thickness(flash, 2.0).min() == pytest.approx(0.5)
    assert measure_sizes(flash, EdgeSizes(1.0, 0.05, 200_000)).min() == pytest.approx(0.125, rel=0.15)
    with pytest.raises(MeshError, match=r"fewer than 1.5 lie across metal of 0.5 mm"):
        measure_sizes(flash, EdgeSizes(1.0, 0.05, 500))
    assert find_long_edge(flash, EdgeSizes(1.0, 0.05, 500)) is None  # there are no cells for shorter ones


def test_a_hundredth_of_the_skin_may_be_thin():
    """The sharp edge of a body, or a burr, has no cells across it, whatever the budget."""
    (points, cells), (burr, few) = mesh_box((8, 8, 8), (6.0, 6.0, 6.0)), mesh_box((2, 2, 1), (1.0, 1.0, 0.05))
    points, cells = np.concatenate([points, burr + 9.0]), np.concatenate([cells, few + len(points)])
    body = replace(upset_block(), points=points, cells=cells, held=np.zeros(points.shape, dtype=bool), sets={},
                   tools=[], on_tool=np.zeros((0, len(points)), dtype=bool))  # fmt: skip
    assert measure_thickness(body, 2.0).min() == pytest.approx(0.05)
    assert expect_cells(body.points, body.cells, measure_sizes(body, EdgeSizes(1.0, 0.5, 1_000))) == pytest.approx(
        1_000, rel=1e-6
    )


def test_thickness_of_faces_is_the_distance_of_the_nearest_one_that_looks_the_other_way():
    """By the definition, over all pairs; faces in all directions."""
    random = np.random.default_rng(2)
    middle, normal = random.uniform(0.0, 1.0, (300, 3)), random.normal(size=(300, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    radius = random.uniform(0.01, 0.1, 300)
    found = _core.measure_thickness(middle, normal, radius, reach=0.5, opposite=0.8)
    way = middle - middle[:, None]
    depth = -np.einsum("ijk,ik->ij", way, normal)
    square = (way**2).sum(axis=2)
    aside = np.sqrt(np.maximum(square - depth**2, 0.0))
    counts = (normal @ normal.T < -0.8) & (depth > 0.0) & (square <= 0.25) & (aside < radius + radius[:, None])
    expected = np.where(counts, depth, np.inf).min(axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert 10 < np.isfinite(expected).sum() < 290


def test_triggers_name_the_place():
    body = upset_block()
    still = np.zeros_like(body.points)
    assert find_flat_cell(body, still, 0.1) is None
    assert "a cell near (" in find_flat_cell(body, still, 0.5)
    squeezed = still.copy()
    squeezed[:, 2] = -0.95 * body.points[:, 2]
    assert find_flat_cell(body, squeezed, 0.1) is not None
    assert find_long_edge(body, EdgeSizes(3.0, 0.5, 20_000)) is None
    assert "times too long near (" in find_long_edge(body, EdgeSizes(0.6, 0.3, 80_000))
    assert find_cut_edge(body) is None
    assert find_cut_edge(indented_block(), deepest=0.01) is None  # beside a sharp edge every edge is cut
    assert find_cut_edge(indented_block(), deepest=0.09, sharp_counts=True) is None
    assert "deep in an edge near (" in find_cut_edge(indented_block(), deepest=0.05, sharp_counts=True)
    assert "deep in an edge near (" in find_cut_edge(ball_on_block(), deepest=0.9 * measure_cut(ball_on_block()))
    assert "deep in an edge near (" in find_cut_edge(ball_on_block(), deepest=1e-4)
    assert find_cut_edge(ball_on_block(), deepest=1e-4, smallest=8.0) is None  # no chord so long follows that radius


def test_a_mesh_gives_way_before_a_pin_between_its_edges_reaches_the_limit():
    points, cells = mesh_box((2, 2, 2), (4.0, 4.0, 4.0))
    held, on_tool = np.zeros(points.shape, dtype=bool), np.zeros((1, len(points)), dtype=bool)
    bare = OldBody(points, cells, on_tool, held, {}, [])
    top = bare.faces[(points[bare.faces, 2] == 4.0).all(axis=1)]
    x, y, _ = points[top[0]].mean(axis=0)
    body = replace(bare, tools=[place_block((x - 0.3, y - 0.3, 3.0), (x + 0.3, y + 0.3, 9.0))])
    assert find_cut_edge(body, deepest=1e-9, sharp_counts=True) is None  # it is in none of the edges
    share = 0.3 / np.sqrt(8.0)  # the nearest wall, over the longest side
    assert measure_cut_face(body) == pytest.approx(share)
    assert "deep in a face near (" in find_breach(body, Limits(penetration=1.6 * share), left=Left())
    assert find_breach(body, Limits(penetration=1.7 * share), left=Left()) is None
    assert (
        find_breach(body, Limits(penetration=1.6 * share), left=Left(face=share)) is None
    )  # no new mesh has mended it
    assert find_breach(body, Limits(penetration=1.2 * share), left=Left(face=share)) is not None


def test_a_mesh_gives_way_before_an_edge_that_has_been_stretched_reaches_the_limit():
    """limits.penetration counts an edge's length when the mesh was made."""
    points, cells = mesh_box((2, 2, 2), (4.0, 4.0, 4.0))
    held, on_tool = np.zeros(points.shape, dtype=bool), np.zeros((1, len(points)), dtype=bool)
    body = OldBody(points, cells, on_tool, held, {}, [place_block((2.8, -1.0, 3.5), (3.2, 5.0, 9.0))])
    share = measure_cut(body, sharp_counts=True)
    assert share > 0.0
    limits = Limits(penetration=1.8 * share)
    start = 0.8 * points
    assert find_breach(body, limits, left=Left(), start=points) is None
    assert ", 1.6 mm long at first" in find_breach(body, limits, left=Left(), start=start)
    assert find_breach(body, limits, left=Left(any_cut=share), start=start) is None  # no new mesh has mended it


def test_a_skin_that_is_kept_stays_where_it_is_and_the_inside_gets_the_size():
    points, cells = mesh_box((4, 4, 4), (4.0, 4.0, 4.0))
    faces, _ = find_skin(cells)
    body = FilledBody(points, cells, faces, np.zeros(len(faces), dtype=np.intp))
    made = mesh_to_size(body, np.full(len(points), 0.6), smallest=0.3, largest=0.7, away=0.1, keeps_skin=True)
    places = {tuple(p) for p in np.round(made.points[np.unique(made.faces)], 9).tolist()}
    assert places == {tuple(p) for p in np.round(points[np.unique(faces)], 9).tolist()}
    assert len(made.cells) > 1.5 * len(cells)
    assert (np.unique(made.cells) == np.arange(len(made.points))).all()  # no node without a cell


def test_the_memory_that_mmg_may_take_does_not_change_a_mesh(monkeypatch):
    """Nor does it end where a mesh has ninety times the cells of the one before."""
    points, cells = mesh_box((3, 3, 3), (4.0, 4.0, 4.0))
    faces, _ = find_skin(cells)
    body = FilledBody(points, cells, faces, np.zeros(len(faces), dtype=np.intp))
    made = []
    for memory in (fill.MEMORY, 4_000.0):
        monkeypatch.setattr(fill, "MEMORY", memory)
        made.append(mesh_to_size(body, np.full(len(points), 0.35), smallest=0.3, largest=0.4, away=0.1))
    assert len(made[0].cells) > 90 * len(cells)
    assert made[0].points.tobytes() == made[1].points.tobytes()
    assert made[0].cells.tobytes() == made[1].cells.tobytes()


def test_a_mesh_that_could_not_be_made_is_asked_for_again_once_the_present_one_is_worse():
    body, settings = upset_block(), Remeshing(size=0.6, smallest_size=0.3, max_cells=1_000_000)
    still = np.zeros_like(body.points)
    assert "times too long" in find_reason(body, still, settings, 1.0)
    left = Left().worsen(measure_left(body, settings, still))
    assert left.edge > 2.2
    assert find_reason(body, still, settings, 1.0, left=left) is None
    assert find_reason(body, still, replace(settings, size=0.4), 1.0, left=left) is not None


def test_an_inner_node_that_a_tool_has_passed_comes_back_into_the_body():
    points, cells = mesh_box((4, 4, 4), (4.0, 4.0, 4.0))
    faces, _ = find_skin(cells)
    skin, placed = np.unique(faces), points.copy()
    placed[np.flatnonzero((points == [2.0, 2.0, 4.0]).all(axis=1)), 2] = 2.3  # the node beneath it is at 3
    spread = spread_moves(points, cells, skin, placed)
    better = improve_cells(spread, cells, skin, 0.25)
    assert measure_quality(spread, cells).min() < 0.0
    assert measure_quality(better, cells).min() > 0.1
    np.testing.assert_array_equal(better[skin], placed[skin])
    good = improve_cells(points, cells, skin, 0.25)
    assert good.tobytes() == points.tobytes()


def test_nodes_of_a_flat_lap_slide_apart_along_the_tool():
    """A node has slid past its neighbour along the tool on which both lie; no inner node can open the cells there."""
    points, cells = mesh_box((4, 4, 4), (4.0, 4.0, 4.0))
    faces, _ = find_skin(cells)
    skin, place = np.unique(faces), [2.0, 2.0, 4.0]
    lapped = points.copy()
    lapped[(points == place).all(axis=1), 0] = 3.2
    on_tool = (points[:, 2] == 4.0)[None]
    held = (points == 0.0) | (points == 4.0)
    held[:, 2] = False
    tool = place_plane((0, 0, -1), (0, 0, 4.0))
    better = slide_on_tools(lapped, cells, skin, on_tool, held, [tool], 0.05)
    assert measure_quality(improve_cells(lapped, cells, skin, 0.25), cells).min() < 0.0
    assert measure_quality(better, cells).min() > 0.05
    others = np.setdiff1d(skin, np.flatnonzero(on_tool[0] & ~held.any(axis=1)))
    np.testing.assert_array_equal(better[others], lapped[others])
    np.testing.assert_allclose(better[on_tool[0], 2], 4.0, atol=1e-12)
    good = slide_on_tools(points, cells, skin, on_tool, held, [tool], 0.05)
    assert good.tobytes() == points.tobytes()
