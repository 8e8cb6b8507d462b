# SPDX-License-Identifier: Apache-2.0
"""Tetrahedra inside closed surfaces, and surfaces that cannot be filled."""

import numpy as np
import pytest

from presswork.mesh.checks import MeshError
from presswork.mesh.make.box import corner_volumes
from presswork.mesh.space.closed_surface import mesh_closed_surface

QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def draw_block(low, high):
    """Corners of the twelve triangles of a block (12, 3, 3)."""
    corners = np.array([[(low, high)[(k >> a) & 1][a] for a in range(3)] for k in range(8)], dtype=float)
    return np.array([corners[list(t)] for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])


def write(folder, facets):
    text = ["solid a"]
    for facet in facets.tolist():
        text += ["facet normal 0 0 0", "outer loop"]
        text += [f"vertex {x} {y} {z}" for x, y, z in facet]
        text += ["endloop", "endfacet"]
    path = folder / "body.stl"
    path.write_text("\n".join([*text, "endsolid a", ""]))
    return path


def test_a_block_is_filled_with_cells_of_a_size_and_its_sides_are_flat(tmp_path):
    mesh, notes = mesh_closed_surface(write(tmp_path, draw_block((0, 0, 0), (6, 4, 5))), 1.0, element="tet4_mini")
    cells = mesh.blocks[0].connectivity
    assert corner_volumes(mesh.points, cells).sum() / 6.0 == pytest.approx(120.0, rel=1e-9)
    assert corner_volumes(mesh.points, cells).min() > 0.0
    edges = mesh.points[cells[:, 1]] - mesh.points[cells[:, 0]]
    assert 0.8 < np.linalg.norm(edges, axis=1).mean() < 1.15
    assert (mesh.points[mesh.node_sets["front"], 2] == 5.0).all()
    assert len(mesh.face_sets["left"]) > 10
    assert notes == ()
    again, _ = mesh_closed_surface(write(tmp_path, draw_block((0, 0, 0), (6, 4, 5))), 1.0, element="tet4_mini")
    assert again.points.tobytes() == mesh.points.tobytes()


def test_a_hole_is_refused_with_its_place(tmp_path):
    with pytest.raises(MeshError, match=r"open rim \(3 edges, .* near \(2, 2.667, 0\)"):
        mesh_closed_surface(write(tmp_path, draw_block((0, 0, 0), (6, 4, 5))[1:]), 1.0, element="tet4_mini")


def test_flipped_and_doubled_facets_are_mended_and_named(tmp_path):
    facets = draw_block((0, 0, 0), (6, 4, 5))
    facets[3] = facets[3][::-1]
    facets = np.concatenate([facets, facets[5:6]])
    mesh, notes = mesh_closed_surface(write(tmp_path, facets), 2.0, element="tet4_mini")
    assert corner_volumes(mesh.points, mesh.blocks[0].connectivity).sum() / 6.0 == pytest.approx(120.0, rel=1e-9)
    assert "1 facets lie on others with the same corners: left out" in notes
    assert any("1 of 12 facets are wound against their neighbours, the first near (" in note for note in notes)


def test_facets_that_pierce_others_are_refused_with_their_place(tmp_path):
    both = np.concatenate([draw_block((0, 0, 0), (6, 4, 5)), draw_block((3, 1, 1), (9, 3, 4))])
    with pytest.raises(MeshError, match=r"facets pierce others, the first near \("):
        mesh_closed_surface(write(tmp_path, both), 1.0, element="tet4_mini")
