# SPDX-License-Identifier: Apache-2.0
"""Smooth profiles through points: circles, ellipses, corners, straight pieces; biarcs near the spline."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from presswork import _core
from presswork.geometry.biarc import max_deviation
from presswork.geometry.smooth import BulgeError, fit_smooth
from presswork.model import FloatArray

RADIUS = 50.0


def on_circle(angles: FloatArray, radius: float = RADIUS) -> FloatArray:
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def largest_kink(segments: FloatArray) -> float:
    """Largest turn [rad] between a segment and the next."""
    kinks = []
    for before, after in pairwise(segments):
        normals = []
        for segment in (before, after):
            if segment[6] == 0.0:
                along = segment[2:4] - segment[0:2]
                normals.append(np.array([-along[1], along[0]]) / np.linalg.norm(along))
            else:
                radial = before[2:4] - segment[4:6]
                normals.append(-segment[6] * radial / np.linalg.norm(radial))
        kinks.append(np.linalg.norm(normals[0] - normals[1]))
    return float(max(kinks))


@pytest.mark.parametrize("closed", [True, False])
def test_circle_or_half_circle_of_24_points_is_smooth_and_round(closed: bool) -> None:
    """At a free end (not-a-knot) the spline is less accurate: 1.3e-4 R at 15 degrees, 1.1e-5 R at 8 degrees."""
    angles = np.linspace(0.0, 2 * np.pi, 25)[:-1] if closed else np.linspace(0.0, np.pi, 24)
    segments = fit_smooth(on_circle(angles), closed, 30.0, 1e-5 * RADIUS).segments
    fine = np.linspace(angles[0] + 0.001, angles[-1] - 0.001, 3000)
    gap, normal, second, *_ = _core.touch_profile(segments, on_circle(fine, RADIUS - 1.0))
    assert np.abs(gap - 1.0).max() < 1e-4 * RADIUS
    assert np.isinf(second).all(), "no inner corner anywhere"
    assert np.linalg.norm(normal + on_circle(fine, 1.0), axis=1).max() < 2e-3
    assert largest_kink(segments) < 1e-9


def test_biarcs_follow_the_spline_within_the_tolerance() -> None:
    x = np.linspace(0.0, 40.0, 15)
    points = np.column_stack([x, 5.0 * np.sin(x / 5.0)])
    knots = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    spline = CubicSpline(knots, points)(np.linspace(0.0, knots[-1], 4000))
    counts = []
    for tolerance in (1e-1, 1e-2, 1e-3, 1e-4):
        segments = fit_smooth(points, False, 45.0, tolerance).segments
        assert max_deviation(spline, list(segments)) <= 1.05 * tolerance, "5 %: it is held at 16 points a biarc"
        assert largest_kink(segments) < 1e-9
        counts.append(len(segments))
    assert counts[0] < counts[2] < counts[3]
    assert counts[3] < 4 * counts[2], "biarcs are of third order: ten times closer takes about twice as many"


def test_ellipse_is_met_to_the_order_of_the_spline() -> None:
    errors = []
    for n_points in (24, 48):
        angles = np.linspace(0.0, 2 * np.pi, n_points + 1)[:-1]
        ellipse = on_circle(angles, 1.0) * np.array([40.0, 25.0])
        segments = fit_smooth(ellipse, True, 30.0, 1e-6).segments
        fine = on_circle(np.linspace(0.0, 2 * np.pi, 2000), 1.0) * np.array([40.0, 25.0])
        errors.append(float(np.abs(_core.touch_profile(segments, fine)[0]).max()))
        assert largest_kink(segments) < 1e-8
    assert errors[0] / errors[1] > 12.0, "fourth order in the spacing"
    assert errors[1] < 1e-5 * 40.0


def test_sharp_turns_stay_corners_and_shallow_ones_are_smoothed() -> None:
    square = np.array([[0.0, 0], [4, 0], [4, 3], [0, 3]])
    segments = fit_smooth(square, True, 30.0, 1e-3).segments
    assert len(segments) == 4
    assert not segments[:, 6].any()
    roof = np.array([[0.0, 0], [2, 0], [4, 1], [6, 1]])  # two turns of 26.6 degrees
    assert not fit_smooth(roof, False, 20.0, 1e-3).segments[:, 6].any()
    assert fit_smooth(roof, False, 30.0, 1e-3).segments[:, 6].any()


@pytest.mark.parametrize("seam", range(0, 22, 3))
def test_three_points_on_a_line_keep_it_straight(seam: int) -> None:
    half = np.linspace(-np.pi / 2, np.pi / 2, 9)
    x = np.linspace(-20.0, 20.0, 4)
    slot = np.concatenate(
        [
            np.column_stack([x, 0 * x - 10])[:-1],
            on_circle(half, 10.0) + np.array([20, 0]),
            np.column_stack([-x, 0 * x + 10])[1:-1],
            on_circle(half + np.pi, 10.0) - np.array([20, 0]),
        ]
    )[:-1]
    smooth = fit_smooth(np.roll(slot, seam, axis=0), True, 30.0, 1e-3)
    lines = smooth.segments[smooth.segments[:, 6] == 0.0]
    np.testing.assert_allclose(np.abs(lines[:, [1, 3]]), 10.0)
    assert len(lines) == 6
    assert largest_kink(np.concatenate([smooth.segments, smooth.segments[:1]])) < 1e-8
    assert set(smooth.owner.tolist()) == set(range(len(slot)))


def test_a_long_span_beside_short_ones_is_refused() -> None:
    points = np.array([[0, 0], [30, 0], [31, 0.1], [32, 0.3], [33, 0.6]])
    with pytest.raises(BulgeError, match=r"swings out by 5.38 mm in the 30 mm before it") as caught:
        fit_smooth(points, False, 30.0, 1e-3)
    assert caught.value.point == 1
    mended = np.insert(points, 1, [15.0, 0.0], axis=0)
    assert fit_smooth(mended, False, 30.0, 1e-3).segments[1, 6] == 0.0
