# SPDX-License-Identifier: Apache-2.0
"""Sheets laid flat: what can be unrolled is, holes stay, nothing folds."""

import numpy as np
import pytest

from presswork.mesh.triangles import find_rims
from presswork.onestep import flatten as module
from presswork.onestep.flatten import flatten
from tests.problems.one_step import cup_profile, fan, revolve


def sheet(n: int, m: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a unit square of n x m cells, and its triangles."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, m + 1), indexing="ij")
    index = np.arange((n + 1) * (m + 1)).reshape(n + 1, m + 1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.stack([x.ravel(), y.ravel()], axis=1), quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3).astype(np.int32)


def areas(flat: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b = (flat[triangles[:, k]] - flat[triangles[:, 0]] for k in (1, 2))
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def test_a_half_cylinder_is_unrolled():
    plane, triangles = sheet(24, 6)
    angle = np.pi * plane[:, 0]
    points = np.stack([-20.0 * np.cos(angle), 30.0 * plane[:, 1], 20.0 * np.sin(angle)], axis=1)
    flat = flatten(points, triangles, find_rims(points, triangles)[0])
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    in_space, in_plane = (np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1) for x in (points, flat))
    assert in_plane == pytest.approx(in_space, rel=1e-6)


@pytest.mark.parametrize("conformal_fails", [False, True])
def test_a_deep_cup_with_a_hole_does_not_fold(monkeypatch, conformal_fails):
    points, quads = revolve(cup_profile(25.0, 5.0, 40.0, 36.0, 4.0), 32)
    triangles = np.concatenate([fan(32), quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)])
    triangles = triangles[(triangles > 32).all(axis=1)] - 33  # a hole in the bottom
    points = points[33:]
    rims = sorted(find_rims(points, triangles), key=lambda rim: -np.ptp(points[rim, 0]))
    assert len(rims) == 2
    if conformal_fails:
        nothing = np.full((len(points), 2), np.nan)
        monkeypatch.setattr(module._Sheet, "map_conformally", lambda *_: nothing)
    flat = flatten(points, triangles, rims[0])
    assert areas(flat, triangles).min() > 0.0
    radius = np.linalg.norm(flat - flat[rims[0]].mean(axis=0), axis=1)
    assert np.ptp(radius[rims[0]]) < 0.05 * radius[rims[0]].mean()
    assert radius[rims[1]].max() < 0.5 * radius[rims[0]].min()


def test_the_energy_has_the_gradient_that_is_said():
    points, triangles = sheet(3, 3)
    surface = np.column_stack([10.0 * points, points[:, 0] ** 2])
    measured = module._Sheet(surface, triangles, 1)
    flat = 10.0 * points + 0.4 * np.random.default_rng(3).random(points.shape)
    force, _ = measured._expand(flat)
    step = np.zeros_like(flat)
    for place in ((5, 0), (5, 1), (0, 0), (15, 1)):
        step[:] = 0.0
        step[place] = 1e-5
        difference = (measured._energy(flat + step) - measured._energy(flat - step)) / 2e-5
        assert force[place] == pytest.approx(difference, rel=1e-6, abs=1e-9)
