# SPDX-License-Identifier: Apache-2.0
"""What holds of all pictures, whatever they show."""

import pytest

pytest.importorskip("matplotlib")

from presswork.view.style import bare_figure, draw_pixels

TITLE = "Oval cover: drawn, trimmed by a drawing, pierced twice, one edge flanged, restruck"


@pytest.mark.parametrize("beside", [False, True])
def test_a_long_title_is_broken_between_the_sides_of_the_picture(beside: bool) -> None:
    figure = bare_figure()
    ax = figure.subplots()
    ax.plot([0, 1], label="a long name of a tool")
    if beside:
        ax.legend(loc="upper left", bbox_to_anchor=(1, 1))
    ax.set_title(f"{TITLE}\nsprung back")
    draw_pixels(figure)
    lines = ax.get_title().split("\n")
    assert len(lines) > 2
    assert lines[-1] == "sprung back"
    assert " ".join(lines[:-1]) == TITLE
    figure.draw_without_rendering()
    box = ax.title.get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.width


def test_a_short_title_stays_in_one_line() -> None:
    figure = bare_figure()
    ax = figure.subplots()
    ax.set_title(TITLE[:45])
    draw_pixels(figure)
    assert ax.get_title() == TITLE[:45]
