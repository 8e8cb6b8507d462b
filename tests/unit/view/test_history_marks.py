# SPDX-License-Identifier: Apache-2.0
"""A force-stroke curve names its largest force and the stroke of the first crack."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pyplot = pytest.importorskip("matplotlib.pyplot")

from presswork.view.history_marks import mark_history, mark_peak  # noqa: E402


def texts(summary: dict[str, object]) -> list[str]:
    """What is written on a curve with its peak of 8 kN at 4 mm."""
    columns = {"punch.stroke": np.array([0.0, 2.0, 4.0, 6.0]), "punch.force": np.array([0.0, 5e3, 8e3, 7e3])}
    figure, ax = pyplot.subplots()
    mark_history(ax, SimpleNamespace(history=columns, summary=summary), [("punch.stroke", "punch.force")])
    pyplot.close(figure)
    return [text.get_text() for text in ax.texts]


def test_the_largest_force_is_named_with_its_stroke() -> None:
    assert texts({}) == ["8 kN at 4 mm"]


def test_the_first_crack_is_named_with_its_stroke() -> None:
    assert texts({"first_crack": {"strokes_mm": {"punch": 5.25}}}) == ["8 kN at 4 mm", "first crack, 5.25 mm"]


@pytest.mark.parametrize(("stroke", "side"), [(0.5, "left"), (15.0, "right")])
def test_the_words_of_a_peak_stay_in_the_picture(stroke: float, side: str) -> None:
    figure, ax = pyplot.subplots()
    ax.plot([0.0, stroke, 20.0], [0.0, 8.0, 1.0])
    mark_peak(ax, stroke, 8.0)
    figure.canvas.draw()
    (words,) = ax.texts
    assert words.get_ha() == side
    inside = ax.get_window_extent()
    assert inside.x0 <= words.get_window_extent().x0
    assert words.get_window_extent().x1 <= inside.x1
    pyplot.close(figure)
