# SPDX-License-Identifier: Apache-2.0
"""Several bodies in one mesh, and the order of their boundaries."""

import numpy as np
import pytest

from presswork.mesh import mesh_rectangle
from presswork.mesh.joined import join_meshes
from presswork.mesh.topology import chain_edges

LINES = np.linspace(0.0, 2.0, 3)


def test_joined_meshes_keep_their_cells_sets_and_edges() -> None:
    parts = {
        "workpiece": mesh_rectangle(LINES, LINES, element="tri3", material=1),
        "die": mesh_rectangle(LINES, LINES + 2.0, element="quad4", material=0),
    }
    mesh, bodies = join_meshes(parts)
    for (name, part), body, block in zip(parts.items(), bodies, mesh.blocks, strict=True):
        own = mesh.points[body.points.start : body.points.stop]
        np.testing.assert_array_equal(own, part.points)
        np.testing.assert_array_equal(mesh.points[block.connectivity], part.points[part.blocks[0].connectivity])
        assert (block.element, block.material) == (part.blocks[0].element, part.blocks[0].material)
        prefix = "" if name == "workpiece" else "die."
        for key, nodes in part.node_sets.items():
            np.testing.assert_array_equal(mesh.points[mesh.node_sets[prefix + key]], part.points[nodes])
        for key, edges in part.edge_sets.items():
            np.testing.assert_array_equal(mesh.points[mesh.edge_sets[prefix + key]], part.points[edges])
        np.testing.assert_array_equal(
            mesh.points[mesh.boundary_edges[body.owns(mesh.boundary_edges)]], part.points[part.boundary_edges]
        )


def test_linear_and_quadratic_bodies_do_not_join() -> None:
    parts = {name: mesh_rectangle(LINES, LINES, element=name) for name in ("quad4", "quad8")}
    with pytest.raises(ValueError, match="do not go together"):
        join_meshes(parts)


def test_chained_edges_follow_each_other_from_the_farthest_corner() -> None:
    mesh = mesh_rectangle(np.linspace(0.0, 3.0, 4), LINES, element="quad4")
    mixed = np.random.default_rng(1).permutation(mesh.boundary_edges)
    chained = chain_edges(mixed, mesh.points)
    np.testing.assert_array_equal(chained[:-1, 1], chained[1:, 0])
    assert chained[-1, 1] == chained[0, 0]
    corners = {tuple(x) for x in mesh.points[[0, -1]]} | {(0.0, 2.0), (3.0, 0.0)}
    assert tuple(mesh.points[chained[0, 0]]) in corners


def test_open_chain_starts_at_its_beginning_and_loops_come_one_after_another() -> None:
    points = np.random.default_rng(2).uniform(size=(9, 2))
    edges = np.array([[2, 3], [1, 2], [6, 7], [3, 4], [7, 5], [5, 6]], dtype=np.int32)
    chained = chain_edges(edges, points)
    np.testing.assert_array_equal(chained[:3], [[1, 2], [2, 3], [3, 4]])
    assert sorted(map(tuple, chained[3:].tolist())) == [(5, 6), (6, 7), (7, 5)]
