# SPDX-License-Identifier: Apache-2.0
"""Outlines and triangles cover each cell."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.model import FloatArray
from presswork.results import Result
from presswork.view.cells import outline_cells, triangulate
from tests.unit.results.upset_output import write_upset_output

ELEMENTS = ["tri3", "tri6_7pt", "quad4", "quad8", "quad9"]


def polygon_area(polygon: FloatArray) -> float:
    """Signed area."""
    x, y = polygon.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


@pytest.mark.parametrize("element", ELEMENTS)
def test_outlines_and_triangles_fill_the_body(tmp_path: Path, element: str) -> None:
    mesh = Result(write_upset_output(tmp_path, (element,), steps=1)).mesh
    assert sum(polygon_area(outline) for outline in outline_cells(mesh, mesh.points)) == pytest.approx(150.0)
    areas = [polygon_area(mesh.points[triangle]) for triangle in triangulate(mesh)]
    assert min(areas) > 0
    assert sum(areas) == pytest.approx(150.0)


def test_edge_with_a_moved_mid_side_is_drawn_as_its_parabola(tmp_path: Path) -> None:
    mesh = Result(write_upset_output(tmp_path, ("quad8",), n=1, steps=1)).mesh
    points = mesh.points.copy()
    bottom_middle = mesh.blocks[0].connectivity[0, 4]
    points[bottom_middle, 1] = -3.0
    (outline,) = outline_cells(mesh, points)
    below = outline[outline[:, 1] < 0]
    np.testing.assert_allclose(below[:, 1], -12.0 * below[:, 0] / 10 * (1 - below[:, 0] / 10))
    assert polygon_area(outline) == pytest.approx(150.0 + 2 / 3 * 30.0, rel=0.01)
