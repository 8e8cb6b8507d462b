# SPDX-License-Identifier: Apache-2.0
"""Meshes of tubes: size, sense of the cells, sets, and how planes cut them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from presswork.mesh.make.tubes import mesh_tube
from presswork.mesh.pressed_cells import find_area_vectors, measure_bulge, measure_rise


@pytest.mark.parametrize(("cut_x", "cut_y", "triangles"), list(product([False, True], repeat=3)))
def test_a_tube_has_its_area_and_its_normals_point_out(cut_x: bool, cut_y: bool, triangles: bool) -> None:
    mesh = mesh_tube(20.0, 60.0, 2.0, (cut_x, cut_y), triangles=triangles)
    area = find_area_vectors(mesh.points[mesh.corners])
    whole = 2.0 * np.pi * 20.0 * 60.0 / 2 ** (cut_x + cut_y)
    assert np.linalg.norm(area.sum(axis=1), axis=1).sum() == pytest.approx(whole, rel=2e-3)
    assert measure_bulge(mesh.points, mesh.corners) > 0.2
    assert abs(measure_rise(mesh.points, mesh.corners)) < 1e-12
    np.testing.assert_allclose(np.hypot(mesh.points[:, 1], mesh.points[:, 2]), 20.0)


@pytest.mark.parametrize("cut_y", [False, True])
def test_sets_of_a_tube_lie_where_their_names_say(cut_y: bool) -> None:
    mesh = mesh_tube(20.0, 60.0, 4.0, (True, cut_y))
    points = mesh.points
    assert set(mesh.node_sets) - {"symmetry_y"} == {
        "all",
        "edge",
        "left",
        "right",
        "top",
        "bottom",
        "sides",
        "symmetry_x",
    }
    for name, axis, value in (("right", 0, 30.0), ("left", 0, 0.0), ("top", 2, 20.0), ("sides", 2, 0.0)):
        np.testing.assert_allclose(points[mesh.node_sets[name], axis], value, atol=1e-12)
    np.testing.assert_array_equal(mesh.node_sets["edge"], mesh.node_sets["right"])
    assert ("symmetry_y" in mesh.node_sets) == cut_y
    around = len(mesh.node_sets["right"])
    assert len(mesh.node_sets["all"]) == len(points) == around * (len(points) // around)
