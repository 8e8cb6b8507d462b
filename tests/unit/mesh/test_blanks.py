# SPDX-License-Identifier: Apache-2.0
"""Meshes of blanks: sets, area, quality of the quadrilaterals, symmetry."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.mesh.make.blanks import mesh_circular_blank, mesh_rectangular_blank
from presswork.model import Mesh


def corner_angles(mesh: Mesh) -> np.ndarray:
    corners = mesh.points[mesh.blocks[0].connectivity]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cosine = (ahead * behind).sum(axis=2) / np.linalg.norm(ahead, axis=2) / np.linalg.norm(behind, axis=2)
    return np.degrees(np.arccos(cosine))


def signed_area(mesh: Mesh) -> float:
    a, b, c, d = (mesh.points[mesh.blocks[0].connectivity[:, i], :2] for i in range(4))
    p, q = c - a, d - b
    return 0.5 * float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())


@pytest.mark.parametrize("symmetry", [(True, True), (True, False), (False, True), (False, False)])
@pytest.mark.parametrize("size", [1.0, 5.0, 11.0])
def test_a_circle_is_covered_once_by_good_quadrilaterals(symmetry, size) -> None:
    mesh = mesh_circular_blank(100.0, size, symmetry)
    angles = corner_angles(mesh)
    assert angles.min() > 45
    assert angles.max() < 140
    corners = mesh.points[mesh.blocks[0].connectivity]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert sides.max() < 1.4 * size
    assert sides.min() > 0.5 * size
    outline = mesh.edge_sets["edge"]
    chords = np.linalg.norm(mesh.points[outline[:, 1]] - mesh.points[outline[:, 0]], axis=1)
    part = 2.0 ** -sum(symmetry)
    exact = part * np.pi * 50.0**2 - (chords**3).sum() / 12 / 50.0  # a chord cuts off c^3/(12 R)
    assert signed_area(mesh) == pytest.approx(exact, rel=1e-4)
    np.testing.assert_allclose(np.linalg.norm(mesh.points[mesh.node_sets["edge"]], axis=1), 50.0)
    assert ("symmetry_x" in mesh.node_sets) == symmetry[0]
    if symmetry[1]:
        assert np.abs(mesh.points[mesh.node_sets["symmetry_y"], 1]).max() < 1e-12
    assert len(np.unique(mesh.blocks[0].connectivity)) == len(mesh.points), "no node is left over"


def test_a_rectangle_has_its_sets() -> None:
    mesh = mesh_rectangular_blank((30.0, 20.0), 2.5, (True, False))
    assert len(mesh.blocks[0].connectivity) == 6 * 8
    assert signed_area(mesh) == pytest.approx(300.0)
    assert set(mesh.node_sets["symmetry_x"]) == set(mesh.node_sets["left"])
    assert len(mesh.edge_sets["edge"]) == 6 + 6 + 8
    assert mesh.points[mesh.node_sets["edge"], 0].max() == 15.0


def test_a_rectangle_has_the_sides_asked_for_along_each_direction() -> None:
    mesh = mesh_rectangular_blank((30.0, 20.0), (2.5, 4.5), (True, True))
    corners = mesh.points[mesh.blocks[0].connectivity]
    assert len(corners) == 6 * 3
    np.testing.assert_allclose(np.ptp(corners, axis=1), np.tile([2.5, 10 / 3, 0.0], (18, 1)))


@pytest.mark.parametrize("symmetry", [[False, False], [True, True]])
@pytest.mark.parametrize("mesh_blank", [lambda **k: mesh_rectangular_blank((30.0, 20.0), **k),
                                        lambda **k: mesh_circular_blank(30.0, **k)])  # fmt: skip
def test_triangles_cover_what_quadrilaterals_cover(mesh_blank, symmetry) -> None:
    """Four for each, wound alike; sets hold the same nodes, but for the centres in `all`."""
    quads, triangles = (mesh_blank(element_size=3.0, symmetry=symmetry, triangles=t) for t in (False, True))
    assert triangles.blocks[0].element == "shell3_1pt"
    corners = triangles.points[triangles.blocks[0].connectivity]
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    assert len(area) == 4 * len(quads.blocks[0].connectivity)
    assert area.min() > 0
    x, y = np.moveaxis(quads.points[quads.blocks[0].connectivity][..., :2], -1, 0)
    whole = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum()
    assert area.sum() == pytest.approx(whole)
    for name, nodes in quads.node_sets.items():
        if name != "all":
            np.testing.assert_array_equal(triangles.node_sets[name], nodes)
