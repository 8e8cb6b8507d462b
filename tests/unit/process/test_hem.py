# SPDX-License-Identifier: Apache-2.0
"""Measures of a hem on folded strips whose edge, thickness and opening are known."""

import numpy as np
import pytest

from presswork.model import Hem
from presswork.process.line.hem import find_hemmed, measure_hem, summarise_hem

HALF, RADIUS, FOLD = 0.4, 0.8, 25.0


def fold(angle: float, turn: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A strip of 36 x 6 mm, folded at x = 25 round the radius of its mid-surface by an angle; turned about z."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 36, 481), np.linspace(-3, 3, 5), indexing="ij"))
    along = np.clip((x - FOLD) / RADIUS, 0.0, angle)
    rest = np.maximum(x - FOLD - angle * RADIUS, 0.0)
    now = np.where(x < FOLD, x, FOLD + RADIUS * np.sin(along) + rest * np.cos(angle))
    z = RADIUS * (1.0 - np.cos(along)) + rest * np.sin(angle)
    c, s = np.cos(turn), np.sin(turn)
    about = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return np.stack([x, y, 0 * x], axis=1) @ about, np.stack([now, y, z], axis=1) @ about


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_flat_hem_is_two_sheets_and_what_lies_between(turn: float) -> None:
    flat, folded = fold(np.pi, turn)
    shape = measure_hem(Hem((np.cos(turn), np.sin(turn))), flat, folded, np.full(len(flat), HALF))
    assert shape.edge == pytest.approx(FOLD + RADIUS + HALF, abs=0.002)
    assert shape.opening == pytest.approx(0.0, abs=1e-6)
    assert shape.thickest == pytest.approx(2 * RADIUS + 2 * HALF)
    assert shape.thinnest == pytest.approx(2 * RADIUS + 2 * HALF)


def test_a_flange_has_a_wall_for_its_edge_and_rolls_in_as_it_is_hemmed() -> None:
    """90 degrees: the edge is the wall; folded, it is the bend. No thickness before the flange covers the panel."""
    flat, flanged = fold(np.pi / 2)
    half = np.full(len(flat), HALF)
    before = measure_hem(Hem((2.0, 0.0)), flat, flanged, half)
    assert before.edge == pytest.approx(FOLD + RADIUS + HALF, abs=0.002)
    assert before.opening == pytest.approx(90.0, abs=1e-6)
    assert np.isnan(before.thickest).all()
    after = measure_hem(Hem((2.0, 0.0)), flat, fold(np.pi)[1] - [0.5, 0, 0], half)
    told = summarise_hem(after, before, None)
    assert told["roll_in_mm"]["mean"] == pytest.approx(0.5, abs=0.002)
    assert "thickness_mm" not in before.to_summary()


@pytest.mark.parametrize("degrees", [30.0, 45.0, -3.0])
def test_opening_is_the_angle_between_panel_and_flange(degrees: float) -> None:
    flat, folded = fold(np.pi - np.radians(degrees))
    shape = measure_hem(Hem((1.0, 0.0)), flat, folded, np.full(len(flat), HALF))
    assert shape.opening == pytest.approx(degrees, abs=1e-6)


def test_an_open_fold_is_as_thick_as_where_it_stands_up() -> None:
    """A flange whose tip dips: thickest at the top of the fold, thinnest at the tip."""
    dip = np.radians(5.0)
    flat, folded = fold(np.pi + dip)
    shape = measure_hem(Hem((1.0, 0.0)), flat, folded, np.full(len(flat), HALF))
    rest = flat[:, 0].max() - FOLD - RADIUS * (np.pi + dip)
    assert shape.thickest == pytest.approx(2 * RADIUS + 2 * HALF, abs=1e-3)
    assert shape.thinnest == pytest.approx(RADIUS * (1 + np.cos(dip)) - rest * np.sin(dip) + 2 * HALF, abs=1e-3)


def test_a_round_hem_is_measured_radially() -> None:
    flat, folded = fold(np.pi)
    angle = flat[:, 1] / 60.0

    def swing(points: np.ndarray) -> np.ndarray:
        r = points[:, 0] + 40.0
        return np.column_stack([r * np.cos(angle), r * np.sin(angle), points[:, 2]])

    shape = measure_hem(Hem(), swing(flat), swing(folded), np.full(len(flat), HALF))
    assert shape.edge == pytest.approx(40.0 + FOLD + RADIUS + HALF, abs=0.002)
    assert shape.opening == pytest.approx(0.0, abs=1e-6)


def test_the_hem_is_that_of_the_sheet_that_reaches_farthest_out() -> None:
    points = np.array([[0.0, 0, 0], [20, 0, 0], [0, 0, 1], [30, 0, 1]])
    assert find_hemmed(Hem((1.0, 0.0)), points, np.array([0, 0, 1, 1], dtype=np.int32)).tolist() == [2, 3]
