# SPDX-License-Identifier: Apache-2.0
"""Contact of a sheet with itself by increments: the tangent is the derivative of the forces, which are in balance."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from tests.problems.explicit_shells import grid, triangles

THICKNESS = 0.8
FOLD = 15.0
"""Where the strip of 40 mm is bent over [mm]: what lies beyond 25 mm lies on what lies before 15 mm."""


def fold(deep: float, *, three: bool = False) -> tuple[_core.SheetOnItself, np.ndarray, np.ndarray, np.ndarray]:
    """Return a strip folded over, its layers overlapping by `deep` thicknesses and warped, its places before a small
    increment, and half its thickness at nodes.
    """
    flat, cells = grid(40, 3, 40.0, 3.0, distort=0.2)
    cells = triangles(cells) if three else cells
    sheet = _core.SheetOnItself([np.ascontiguousarray(cells, dtype=np.int32)], flat, thickness=THICKNESS)
    x = flat.copy()
    upper = x[:, 0] > 25.0
    between = (x[:, 0] > FOLD) & ~upper
    angle = (x[between, 0] - FOLD) / 10.0 * np.pi
    height = (1.0 - deep) * THICKNESS
    x[between, 0], x[between, 2] = FOLD + 3.0 * np.sin(angle), 0.5 * height * (1.0 - np.cos(angle))
    x[upper, 0], x[upper, 2] = 40.3 - x[upper, 0], height
    rng = np.random.default_rng(2)
    x += 1e-3 * rng.normal(size=x.shape)
    x_n = x - 2e-3 * rng.normal(size=x.shape)
    sheet.search(x, np.full(len(x), 0.5 * THICKNESS), np.full(len(cells), 0.5 * THICKNESS), THICKNESS)
    return sheet, x, x_n, np.full(len(cells), 0.5 * THICKNESS)


def touch(
    sheet: _core.SheetOnItself, x: np.ndarray, x_n: np.ndarray, half_cell: np.ndarray, mu: float, stiffness: float
) -> tuple[np.ndarray, ...]:
    """Return what the sheet does to itself by a law of push = -stiffness gap [N/mm]."""
    half = np.full(len(x), 0.5 * THICKNESS)
    cell, gap, _, gone = sheet.look(x, x_n, half, half_cell, 0.0)
    assert gone < 0
    slots = np.flatnonzero(cell >= 0).astype(np.int32)
    before = 0.2 * np.random.default_rng(4).normal(size=(2 * len(x), 3))[slots]
    push, slope = -stiffness * gap[slots], np.full(len(slots), -stiffness)
    hanging = np.full(len(slots), 0.1 * stiffness)
    return slots, *sheet.touch(
        x, x_n, half, half_cell, slots, cell[slots], push=push, slope=slope, hanging=hanging, shear_n=before, mu=mu
    )


@pytest.mark.parametrize("mu", [0.0, 0.05, 10.0], ids=["frictionless", "slides", "sticks"])
@pytest.mark.parametrize("three", [False, True], ids=["quadrilaterals", "triangles"])
def test_tangent_is_the_derivative_of_the_forces(mu: float, three: bool) -> None:
    sheet, x, x_n, half_cell = fold(0.03, three=three)
    slots, _, pairs, blocks, _, slip = touch(sheet, x, x_n, half_cell, mu, 1e3)
    assert len(slots) > 60, "nodes of both layers"
    assert np.abs(slip).max() > 1e-3
    n = 3 * len(x)
    tangent = np.zeros((n, n))
    for (a, b), block in zip(pairs, blocks, strict=True):
        tangent[3 * a : 3 * a + 3, 3 * b : 3 * b + 3] += block
    scale = np.abs(tangent).max()
    rng, h, wrong = np.random.default_rng(6), 1e-7, []
    for _ in range(12):
        way = rng.normal(size=x.shape)
        ahead, after = (touch(sheet, x + s * h * way, x_n, half_cell, mu, 1e3)[1] for s in (1, -1))
        finite = -(ahead - after) / (2.0 * h)
        wrong.append(np.abs(finite.ravel() - tangent @ way.ravel()) / scale)
    # where the difference reaches over a border of facets at which the normal jumps it means nothing
    assert (np.max(wrong, axis=0) < 1e-5).mean() > 0.98


@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_forces_are_in_balance_and_friction_obeys_coulomb(mu: float) -> None:
    sheet, x, x_n, half_cell = fold(0.03)
    slots, force, _, _, shear, _ = touch(sheet, x, x_n, half_cell, mu, 1e3)
    half = np.full(len(x), 0.5 * THICKNESS)
    _, gap, normal, _ = sheet.look(x, x_n, half, half_cell, 0.0)
    push = -1e3 * gap[slots]
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-9 * np.abs(force).max())
    moment = np.cross(x, force).sum(axis=0)
    if mu == 0.0:  # friction on a node acts at the mid-surface of the shell, half a thickness off
        np.testing.assert_allclose(moment, 0.0, atol=1e-8 * np.abs(np.cross(x, force)).max())
        np.testing.assert_array_equal(shear, 0.0)
    assert np.all(np.linalg.norm(shear, axis=1) <= mu * push * (1.0 + 1e-12))
    np.testing.assert_allclose((shear * normal[slots]).sum(axis=1), 0.0, atol=1e-10)
    assert np.abs(push).min() > 0.0


def test_layers_push_each_other_apart_and_no_shell_touches_its_neighbours() -> None:
    sheet, x, x_n, half_cell = fold(0.03)
    slots, force, *_ = touch(sheet, x, x_n, half_cell, 0.0, 1e3)
    upper = x[:, 2] > 0.5 * THICKNESS
    assert force[upper, 2].sum() > 0.0 > force[~upper, 2].sum()
    faces = slots % 2
    assert set(faces[upper[slots // 2]]) == {1}, "the layer that is turned over touches with the same face"
    assert set(faces) == {1}
    flat, cells = grid(40, 3, 40.0, 3.0)
    half = np.full(len(flat), 0.5 * THICKNESS)
    alone = _core.SheetOnItself([np.ascontiguousarray(cells, dtype=np.int32)], flat, thickness=THICKNESS)
    pairs = alone.search(flat, half, half_cell, 0.2 * THICKNESS)
    assert len(pairs) == 0


def test_a_node_that_has_come_through_is_told() -> None:
    sheet, x, _, half_cell = fold(0.03)
    half = np.full(len(x), 0.5 * THICKNESS)
    upper = x[:, 2] > 0.5 * THICKNESS
    through = x.copy()
    through[upper, 2] -= 2.0 * THICKNESS
    sheet.search(through, half, half_cell, THICKNESS)
    assert sheet.look(x, x, half, half_cell, 0.0)[3] < 0
    assert sheet.look(through, x, half, half_cell, 0.0)[3] >= 0
