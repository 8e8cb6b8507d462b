# SPDX-License-Identifier: Apache-2.0
"""A force-stroke curve names its largest force and the stroke of the first crack."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pyplot = pytest.importorskip("matplotlib.pyplot")

from presswork.view.history_marks import mark_history  # noqa: E402


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
