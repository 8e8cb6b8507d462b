# SPDX-License-Identifier: Apache-2.0
"""What lies beneath a place in the plan: cell, shape functions, normal; the walk there, and off the sheet."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.mesh.make.blanks import mesh_circular_blank


@pytest.fixture(scope="module")
def disc() -> tuple[np.ndarray, np.ndarray]:
    mesh = mesh_circular_blank(40.0, 3.0, [False, False])
    points = mesh.points.copy()
    points[:, 2] = 0.3 * points[:, 0] - 0.1 * points[:, 1]
    return points, np.ascontiguousarray(mesh.blocks[0].connectivity, dtype=np.int32)


def triangles(cells: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]]))


@pytest.mark.parametrize("kind", ["quadrilaterals", "triangles", "seen from below"])
def test_shape_functions_reproduce_the_place_from_wherever_the_walk_begins(disc, kind) -> None:
    points, cells = disc
    if kind == "triangles":
        cells = triangles(cells)
    if kind == "seen from below":
        cells = np.ascontiguousarray(cells[:, ::-1])
    sheet = _core.SheetUnder([cells])
    rng = np.random.default_rng(3)
    angle, radius = rng.uniform(0, 2 * np.pi, 200), 19.8 * np.sqrt(rng.uniform(0, 1, 200))
    places = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    for start in (np.full(200, -1), rng.integers(0, len(cells), 200)):
        cell, inside, nodes, weight, normal = sheet.find(places, points, start.astype(np.int32))
        assert inside.all()
        assert ((cell >= 0) & (cell < len(cells))).all()
        assert weight.min() > -1e-9
        found = np.einsum("na,nai->ni", weight, points[nodes])
        np.testing.assert_allclose(found[:, :2], places, atol=1e-9)
        np.testing.assert_allclose(found[:, 2], 0.3 * places[:, 0] - 0.1 * places[:, 1], atol=1e-9)
        up = normal * np.sign(normal[:, 2:]) / np.linalg.norm(normal, axis=1, keepdims=True)
        np.testing.assert_allclose(up, np.tile(np.array([-0.3, 0.1, 1]) / np.sqrt(1.1), (200, 1)), atol=1e-9)


def test_beside_the_sheet_nothing_is_found_until_it_comes(disc) -> None:
    points, cells = disc
    sheet = _core.SheetUnder([cells])
    place = np.array([[21.0, 3.0]])
    cell, inside, *_ = sheet.find(place, points, np.array([0], dtype=np.int32))
    assert not inside[0]
    cell, inside, nodes, weight, _ = sheet.find(place, points + np.array([2.0, 0, 0]), cell)
    assert inside[0]
    np.testing.assert_allclose(weight[0] @ points[nodes[0]][:, :2], [19.0, 3.0], atol=1e-9)


def test_cells_of_wrong_form_are_refused(disc) -> None:
    points, cells = disc
    with pytest.raises(ValueError, match="3 or 4"):
        _core.SheetUnder([np.zeros((2, 5), dtype=np.int32)])
    with pytest.raises(ValueError, match="no such cell"):
        _core.SheetUnder([cells]).find(np.zeros((1, 2)), points, np.array([len(cells)], dtype=np.int32))
    with pytest.raises(ValueError, match="names a node that is not there"):
        _core.SheetUnder([cells]).find(np.zeros((1, 2)), points[:-1], np.array([-1], dtype=np.int32))
    with pytest.raises(ValueError, match="names a node that is not there"):
        _core.SheetUnder([cells - 1])
