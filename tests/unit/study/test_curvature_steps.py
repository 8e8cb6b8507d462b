# SPDX-License-Identifier: Apache-2.0
"""Steps of a correction of a strip whose places answer unlike: elastic in the middle, plastic at its sides."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.study.curvature_steps import CurvatureSteps, expect_answers

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


def correct(answer: np.ndarray, loops: int, expected: np.ndarray | None = None) -> tuple[list[float], np.ndarray]:
    """Return the deviations of a part whose curvature answers so to that of its tools, and the answers found."""
    points, cells, s = strip()
    weight = np.ones(len(points))
    steps = CurvatureSteps(points, cells, weight, (True, True), 1.0, expected)
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


def test_the_first_step_knows_what_the_plastic_strain_tells() -> None:
    """An elastic bottom answers by 0.2, a plastic wall by one: the first step leaves a tenth of a blind one's."""
    s = strip()[2]
    answer = expect_answers(np.where(s < 0.5 * LENGTH, 0.0, 0.02))
    assert answer[[0, -1]] == pytest.approx([0.2, 1.0])
    blind, _ = correct(answer, 2)
    worst, _ = correct(answer, 2, np.tile(answer, ROWS))
    assert worst[1] < 0.1 * blind[1]


def test_the_step_by_the_first_secant_is_halved() -> None:
    """Answers of elastic places grow with the bend, so a secant of a small one asks for too much."""
    s = strip()[2]
    answer = np.full_like(s, 0.4)
    worst, _ = correct(answer, 4, np.full(len(s) * ROWS, 0.9))
    assert 0.4 < worst[2] / worst[1] < 0.6
    assert worst[3] < 0.2 * worst[2]


def test_after_a_loop_that_is_worse_the_next_step_starts_from_the_better_one() -> None:
    points, cells, s = strip()
    steps = CurvatureSteps(points, cells, np.ones(len(points)), (True, True), 1.0, np.ones(len(points)))
    sprung = integrate(np.full_like(s, 1e-3), s)
    first = steps.step(np.zeros_like(points), sprung)
    second = steps.step(first, 0.1 * sprung)
    third = steps.step(second + 5.0 * first, 3.0 * sprung)
    assert np.abs(third - first).max() < np.abs(first).max()


def test_after_a_deviation_that_was_turned_round_the_next_step_starts_between_the_loops() -> None:
    points, cells, s = strip()
    steps = CurvatureSteps(points, cells, np.ones(len(points)), (True, True), 1.0, np.ones(len(points)))
    sprung = integrate(np.full_like(s, 1e-3), s)
    steps.step(np.zeros_like(points), sprung)
    between = steps.step(-4.0 * sprung, -3.0 * sprung)
    assert np.abs(between + sprung).max() < 0.01 * np.abs(sprung).max()
