# SPDX-License-Identifier: Apache-2.0
"""Directors: one where the sheet is smooth, several that turn together at folds and junctions."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.mesh import MeshError
from presswork.mesh.directors import find_directors
from presswork.model import CellBlock

SLOPES = _core.shell_shape("shell4_mitc")[3]


def find(points, cells, normals=None):
    block = CellBlock("shell4_mitc", np.array(cells, dtype=np.int32), 0)
    return find_directors(np.array(points, dtype=float), [block], [SLOPES], normals)


def panels(*directions: tuple[float, float]):
    """Unit squares that share the edge x = z = 0, each leaving it along a direction (x, z)."""
    points = [[0, 0, 0], [0, 1, 0]]
    cells = []
    for x, z in directions:
        first = len(points)
        points += [[x, 0, z], [x, 1, z]]
        cells.append([0, first, first + 1, 1])
    return points, cells


def test_a_flat_sheet_has_one_director_a_node() -> None:
    found = find(*panels((1, 0), (-1, 0)))
    assert found.smooth.all()
    np.testing.assert_allclose(np.abs(found.vectors[:, 2]), 1.0)


@pytest.mark.parametrize(("degrees", "smooth"), [(30, True), (50, False), (90, False), (150, False)])
def test_a_fold_has_a_director_for_each_side(degrees, smooth) -> None:
    angle = np.radians(degrees)
    found = find(*panels((-1, 0), (np.cos(angle), np.sin(angle))))
    assert found.smooth[0] == smooth
    assert found.smooth[2:].all()
    on_fold = found.vectors[found.node == 0]
    assert len(np.unique(np.round(np.abs(on_fold @ on_fold.T), 9))) == (1 if smooth else 2)
    for cell, normal in zip(found.of_cell[0], ([0, 0, 1], [-np.sin(angle), 0, np.cos(angle)]), strict=True):
        if not smooth:
            assert abs(found.vectors[cell[0]] @ normal) == pytest.approx(1.0)


def test_a_junction_of_three_has_a_director_each() -> None:
    found = find(*panels((1, 0), (-0.5, 0.9), (-0.5, -0.9)))
    assert not found.smooth[0]
    lines = np.abs(found.vectors[found.node == 0] @ found.vectors[found.node == 0].T)
    assert np.linalg.matrix_rank(lines > 0.99) == 3


def test_the_web_of_a_tee_folds_and_its_flange_runs_through() -> None:
    found = find(*panels((1, 0), (-1, 0), (0, 1)))
    flange = found.vectors[found.of_cell[0][:2, 0]]
    assert abs(flange[0] @ flange[1]) == pytest.approx(1.0)
    assert abs(found.vectors[found.of_cell[0][2, 0]] @ flange[0]) == pytest.approx(0.0, abs=1e-12)


def test_cells_wound_the_other_way_have_the_opposite_director() -> None:
    points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    found = find(points, [[0, 1, 4, 3], [1, 4, 5, 2]])
    assert found.smooth.all()
    one, other = found.vectors[found.of_cell[0][0, 1]], found.vectors[found.of_cell[0][1, 0]]
    np.testing.assert_allclose(one, -other)
    np.testing.assert_allclose(one, [0, 0, 1])


def test_directors_of_points_on_a_sphere_are_radial() -> None:
    a = 0.3 * np.array([-1, 0, 1])
    x, y = np.meshgrid(np.tan(a), np.tan(1.3 * a))
    points = np.column_stack([x.ravel(), y.ravel(), np.ones(9)])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    found = find(points, [[i, i + 1, i + 4, i + 3] for i in (0, 1, 3, 4)])
    middle = found.vectors[found.node == 4][0]
    np.testing.assert_allclose(middle, points[4], atol=1e-12)


def test_known_normals_replace_the_means_but_at_folds() -> None:
    points, cells = panels((-1, 0), (0, 1))
    exact = np.tile([0.6, 0.0, 0.8], (len(points), 1))
    found = find(points, cells, exact)
    plain = found.smooth[found.node]
    np.testing.assert_allclose(np.abs(found.vectors[plain] @ [0.6, 0, 0.8]), 1.0)
    assert not np.isclose(np.abs(found.vectors[~plain] @ [0.6, 0, 0.8]), 1.0).any()


def test_a_cell_without_a_normal_is_refused() -> None:
    with pytest.raises(MeshError, match="no area at a corner"):
        find([[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2, 3]])


@pytest.mark.parametrize(("height", "refused"), [(1.0, False), (4.0, True)])
def test_the_tip_of_a_spike_has_no_director(height, refused) -> None:
    """Twelve cells round a cone whose flanks stand at 45 or 76 degrees: each is within 40 degrees of the next."""
    angle = np.arange(24) * np.pi / 12
    radius = np.where(np.arange(24) % 2, 1.4, 1.0)
    points = [[0, 0, 0], *np.column_stack([radius * np.cos(angle), radius * np.sin(angle), -height * radius])]
    cells = [[0, 2 * i + 1, 2 * i + 2, (2 * i + 2) % 24 + 1] for i in range(12)]
    if refused:
        with pytest.raises(MeshError, match=r"no director can be defined at 1 nodes, the first at \(0, 0, 0\)"):
            find(points, cells)
        return
    found = find(points, cells)
    np.testing.assert_allclose(found.vectors[found.node == 0], [[0, 0, 1]], atol=1e-12)
