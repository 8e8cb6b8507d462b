# SPDX-License-Identifier: Apache-2.0
"""Cells under a pressure, their area vectors and the volume that they sweep."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.interaction.cell_pressure import press_cells
from presswork.mesh.pressed_cells import find_area_vectors, find_pressed_cells, find_side, find_swept_volume
from presswork.model import PressedRegion, SheetPressure

POINTS = np.array([[0, 0, 0], [2, 0, 0], [4, 0, 0], [0, 2, 0], [2, 2, 0], [4, 2, 0]], dtype=float)
CELLS = np.array([[0, 1, 4, 3], [1, 2, 5, 5]], dtype=np.int32)
rng = np.random.default_rng(1)


@pytest.mark.parametrize("element", ["shell4_mitc", "shell3_mitc_plus"])
def test_area_vectors_are_what_a_pressure_of_one_gives(element: str) -> None:
    """By the quadrature of the elements, at nodes that lie in no plane."""
    points = rng.random((4, 3))
    n = 4 if element.startswith("shell4") else 3
    cells = np.arange(n, dtype=np.int32)[None]
    force = np.zeros((4, 3))
    press_cells(points, cells, _core.shell_shape(element), 1.0, force)
    corners = points[[0, 1, 2, n - 1]][None]
    np.testing.assert_allclose(find_area_vectors(corners)[0, :n], force[:n], atol=1e-15)


def test_forces_of_a_pressure_are_the_derivative_of_the_volume_times_it() -> None:
    now = POINTS + 0.3 * rng.random(POINTS.shape)
    forces = np.zeros_like(POINTS)
    np.add.at(forces, CELLS, find_area_vectors(now[CELLS]))
    rim = [0, 1, 2, 3, 4, 5]
    for node in rim:
        for axis in range(3):
            moved = [now.copy() for _ in range(2)]
            moved[0][node, axis] -= 1e-6
            moved[1][node, axis] += 1e-6
            volume = find_swept_volume(moved[0], moved[1], CELLS)
            assert volume / 2e-6 == pytest.approx(forces[node, axis], abs=1e-8)


def test_a_plate_that_rises_sweeps_its_area_times_its_way() -> None:
    assert find_swept_volume(POINTS, POINTS + np.array([0.0, 0.0, 3.0]), CELLS) == pytest.approx(3.0 * (4.0 + 2.0))


def test_faces_are_above_and_below_whichever_way_the_cells_run() -> None:
    assert find_side(POINTS, CELLS, "bottom") == 1.0
    assert find_side(POINTS, CELLS, "top") == -1.0
    assert find_side(POINTS, CELLS[:, [3, 2, 1, 0]][:1], "bottom") == -1.0


@pytest.mark.parametrize(("keep", "expected"), [("inside", [0]), ("outside", [1])])
def test_a_line_bounds_the_cells_by_their_middles(keep: str, expected: list[int]) -> None:
    line = np.array([[-1.0, -1.0], [2.5, -1.0], [2.5, 3.0], [-1.0, 3.0]])
    pressure = SheetPressure("oil", "top", PressedRegion(line, keep))  # type: ignore[arg-type]
    assert find_pressed_cells(POINTS, CELLS, pressure).tolist() == expected
    assert find_pressed_cells(POINTS, CELLS, SheetPressure("oil", "top")).tolist() == [0, 1]
