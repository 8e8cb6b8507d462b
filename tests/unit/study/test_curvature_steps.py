# SPDX-License-Identifier: Apache-2.0
"""Steps of a correction of a strip whose places answer unlike: elastic in the middle, plastic at its sides."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.study.curvature_steps import CurvatureSteps

LENGTH, ROWS = 60.0, 3


def strip() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points along x of a strip of squares of 1 mm, its triangles, and its stations."""
    s = np.linspace(0.0, LENGTH, int(LENGTH) + 1)
    points = np.concatenate([np.stack([s, np.full_like(s, y), np.zeros_like(s)], axis=1) for y in range(ROWS)])
    n = len(s)
    a = (np.arange(ROWS - 1)[:, None] * n + np.arange(n - 1)).ravel()
    cells = np.concatenate([np.stack([a, a + 1, a + n + 1], axis=1), np.stack([a, a + n + 1, a + n], axis=1)])
    return points, cells.astype(np.int32), s


def integrate(curvature: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return the displacement (n, 3) of all rows by a curvature along the strip, level at x = 0."""
    slope = np.concatenate([[0.0], np.cumsum(0.5 * (curvature[1:] + curvature[:-1]) * np.diff(s))])
    z = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(s))])
    return np.tile(np.stack([np.zeros_like(z), np.zeros_like(z), z], axis=1), (ROWS, 1))


def correct(answer: np.ndarray, loops: int) -> tuple[list[float], np.ndarray]:
    """Return the deviations of a part whose curvature answers so to that of its tools, and the answers found."""
    points, cells, s = strip()
    weight = np.ones(len(points))
    steps = CurvatureSteps(points, cells, weight, (True, True), 1.0)
    sprung = integrate(np.full_like(s, 1e-3), s)
    correction, worst = np.zeros_like(points), []
    for _ in range(loops):
        z = correction[: len(s), 2]
        bent = np.gradient(np.gradient(z, s), s)
        bent[:2] = bent[2]
        off = sprung + integrate(answer * bent, s)
        off[:, 2] -= off[:, 2].mean()
        worst.append(float(np.abs(off).max()))
        correction = steps.step(correction, off)
    return worst, steps.find_answers()[: len(s)]


def test_places_that_answer_unlike_are_each_corrected() -> None:
    """Answers of 0.3 and 2: the whole deviation taken off each time leaves 0.7 and grows; steps by place find both."""
    s = strip()[2]
    worst, found = correct(np.where(s < 0.5 * LENGTH, 0.3, 2.0), 4)
    assert worst[2] < 0.2 * worst[0]
    assert worst[3] < 0.01 * worst[0]
    assert found[s < 20.0] == pytest.approx(0.3, abs=0.1)
    assert (found[s > 40.0] > 1.0).all()


def test_a_place_that_answers_with_the_wrong_sign_does_not_run_away() -> None:
    """The outer half bends the other way: each whole deviation taken off there would be a fifth more than the last."""
    s = strip()[2]
    worst, found = correct(np.where(s < 0.5 * LENGTH, 1.0, -0.2), 8)
    assert min(worst) < 0.5 * worst[0]
    assert max(worst) < 2.0 * worst[0]
    assert (found[(s > 40.0) & (s < 55.0)] == 0.0).all()
