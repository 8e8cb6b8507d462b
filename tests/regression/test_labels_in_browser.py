# SPDX-License-Identifier: Apache-2.0
"""Labels and colours of the page's view, in a real browser: none covers another, and the legend is what is drawn."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.examples import copy_example
from presswork.results import Result
from presswork.server.http import Server
from tests.regression.browser import Page, Tab, open_report, serve_folder, share_browser, share_upset

browser, upset, page, site = share_browser, share_upset, open_report, serve_folder
BOXES = """() => [...document.querySelectorAll(".mark:not([hidden])")].map((mark) => {
  const { left, right, top, bottom } = mark.getBoundingClientRect(); return [left, right, top, bottom]; })"""


def count_covered(boxes: list[list[float]]) -> int:
    """Return how many pairs of boxes (left, right, top, bottom) cover one another."""
    pairs = [(a, b) for i, a in enumerate(boxes) for b in boxes[:i]]
    return sum(a[0] < b[1] and b[0] < a[1] and a[2] < b[3] and b[2] < a[3] for a, b in pairs)


def test_labels_of_places_that_lie_together_do_not_cover_one_another(page: Page) -> None:
    page.ask("() => presswork.store.set({ picked: { run: 0, face: 5, node: 3 } })")
    page.settle()
    page.ask(
        "() => { const { viewer } = presswork.stage; viewer.camera.zoom = 0.02; viewer.resize(); viewer.drawNow(); }"
    )
    boxes = page.ask(BOXES)
    assert len(boxes) == 3
    assert count_covered(boxes) == 0
    dots, heights = page.ask("""() => [presswork.stage.marks.map(({ at }) => at),
      [...document.querySelectorAll(".mark")].map((mark) => mark.getBoundingClientRect().top
        + parseFloat(getComputedStyle(mark, "::before").top) + parseFloat(getComputedStyle(mark, "::before").marginTop)
        - document.querySelector("#stage").getBoundingClientRect().top)]""")
    assert np.ptp(dots, axis=0).max() < 12.0, "the places themselves lie together"
    np.testing.assert_allclose(np.array(heights) + 5.0, np.array(dots)[:, 1], atol=1.5, err_msg="dots stay at places")


@pytest.mark.parametrize("width", [1280, 390])
def test_names_of_tools_are_apart_and_the_drawing_is_at_the_top(
    browser: Any, site: Server, tmp_path: Path, width: int
) -> None:
    copy_example("square_cup", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml", width, 844)
    drawing = page.tab.frame_locator("#drawing")
    drawing.locator("html[data-ready]").wait_for(timeout=60_000)
    page.tab.wait_for_timeout(200)
    boxes = page.tab.frames[1].evaluate(BOXES)
    assert len(boxes) == 3
    assert count_covered(boxes) == 0
    assert page.ask("() => document.querySelector('#drawing').getBoundingClientRect().top") < 200
    page.close()


def test_zero_of_a_field_with_sign_has_the_middle_colour_in_legend_and_part(page: Page) -> None:
    """Blue to red: zero is white in the part, and at the middle of the legend, whatever the extremes are."""
    page.choose("Field", "displacement_y")
    page.choose("Colours", "signed")
    low, high = page.ask("() => presswork.stage.legend.range")
    assert low == pytest.approx(-9.0, rel=1e-3)
    assert high == -low
    uniforms = page.ask("() => { const { low, high } = presswork.stage.scenes[0].body.material.uniforms; "
                        "return [low.value, high.value]; }")  # fmt: skip
    assert uniforms == [low, high]
    bar = page.tab.locator("#legend .bar").screenshot()
    image = np.asarray(pytest.importorskip("PIL.Image").open(io.BytesIO(bar)).convert("RGB")).astype(int)
    middle = image[len(image) // 2, image.shape[1] // 2]
    assert middle.min() > 235, "white at zero"


def test_extremes_of_the_page_are_explained_beside_those_of_the_summary(page: Page, upset: Result) -> None:
    """Cells show means over their points; the summary has the points themselves, which reach farther."""
    shown = page.ask("() => presswork.stage.legend.full[1]")
    assert shown < upset.summary["fields"]["effective_stress"]["largest"]["value"] * (1 + 1e-6)
    page.tab.get_by_role("tab", name="Part").click()
    page.tab.wait_for_timeout(200)
    assert "extremes in the summary are those of the points" in page.tab.locator("#panel").inner_text()
