# SPDX-License-Identifier: Apache-2.0
"""Tools play through their strokes in the editor before anything is computed, with names, and clashes are marked."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from presswork.examples import copy_example
from presswork.server.http import Server
from tests.regression.browser import Person, Tab, serve_folder, share_browser

browser, site = share_browser, serve_folder
WHERE = "(i) => presswork.stage.scenes[0].tools[i].group.position.toArray()"


class Drawing:
    """The drawing in an editor."""

    def __init__(self, page: Tab) -> None:
        self.page = page
        page.tab.frame_locator("#drawing").locator("html[data-ready]").wait_for(timeout=60_000)
        self.frame = page.tab.frames[1]

    def go(self, part: float) -> None:
        """Move the slider to a part of its length."""
        script = "(e, part) => { e.value = Math.round(part * e.max); e.dispatchEvent(new Event('input')); }"
        self.frame.locator("#time").evaluate(script, part)
        self.frame.wait_for_function("() => !presswork.stage.isBusy")

    def place(self, tool: str) -> list[float]:
        """Return where a tool stands [mm]."""
        number = self.frame.evaluate("(name) => presswork.runs[0].tools.findIndex((one) => one.name === name)", tool)
        place: list[float] = self.frame.evaluate(WHERE, number)
        return place


def test_tools_play_through_their_stroke_with_names(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("square_cup", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml")
    drawing = Drawing(page)
    assert set(drawing.frame.locator(".mark.name").all_inner_texts()) == {"punch", "die", "holder"}
    start = drawing.place("punch")[2]
    drawing.go(0.5)
    assert drawing.place("punch")[2] - start == pytest.approx(-10.0)
    assert drawing.frame.locator("#time-label").inner_text() == "draw, punch 10 of 20 mm"
    drawing.go(0.0)
    drawing.frame.get_by_role("button", name="Play").click()
    drawing.frame.wait_for_function("() => presswork.store.state.step > 3")
    drawing.frame.locator("#timeline button", has_text="Pause").click()
    stopped = drawing.frame.evaluate("() => presswork.store.state.step")
    page.tab.wait_for_timeout(300)
    assert drawing.frame.evaluate("() => presswork.store.state.step") == stopped
    drawing.frame.locator("#canvas").focus()
    page.tab.keyboard.press("End")
    drawing.frame.wait_for_function("() => !presswork.stage.isBusy")
    assert drawing.place("punch")[2] - start == pytest.approx(-20.0)
    page.close()


def test_all_operations_of_a_line_are_drawn_each_with_its_tools(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("press_line", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=press_line.toml")
    drawing = Drawing(page)
    seen = {}
    for part in (0.0, 0.5, 1.0):
        drawing.go(part)
        label = drawing.frame.locator("#time-label").inner_text()
        seen[label.split(":")[0]] = set(drawing.frame.locator(".mark.name").all_inner_texts())
    assert seen["draw"] == {"draw punch", "draw die", "draw holder"}
    assert seen["flange"] == {"flange punch", "flange die", "flange pad"}
    page.close()


def test_section_is_mirrored_and_a_clash_is_marked_where_it_is(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("forging_flash", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=forging_flash.toml")
    person, drawing = Person(page), Drawing(page)
    low, high = drawing.frame.evaluate("() => Object.values(presswork.stage.scenes[0].bounds())")
    assert (low[:2], high[:2]) == ([-15.0, pytest.approx(-10.6)], [15.0, pytest.approx(10.6)])
    assert drawing.frame.evaluate("() => presswork.stage.scenes[0].tools.length") == 4, "the die and its images"
    assert drawing.frame.locator("button.clash").count() == 0
    person.type("stages.0.tools.die.stroke", "7.6")
    person.wait()
    assert "close on the workpiece" in page.tab.locator("#problems").inner_text()
    page.tab.frame_locator("#drawing").locator("button.clash").click(timeout=60_000)
    drawing = Drawing(page)
    drawing.frame.wait_for_selector(".mark.meets")
    assert "meets its mirror image" in drawing.frame.locator("#message").inner_text()
    colour = drawing.frame.evaluate(
        "() => presswork.stage.scenes[0].tools[0].surface.material.uniforms.plain.value.toArray()"
    )
    assert colour[0] > 2 * colour[1]
    page.close()


def test_a_cut_opens_the_cavity_of_tools_in_space(browser: Any, site: Server, tmp_path: Path) -> None:
    """The plane cuts tools with the blank, so that the inside of a die is seen; the views turn to it."""
    copy_example("square_cup", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml")
    drawing = Drawing(page)
    controls = drawing.frame.locator("#timeline")
    controls.get_by_label("Cut", exact=True).select_option("y")
    controls.get_by_role("button", name="Look at the part from the front").click()
    drawing.frame.wait_for_function("() => !presswork.stage.isBusy")
    script = """() => { const { uniforms } = presswork.stage.scenes[0].tools[0].surface.material;
      return [uniforms.isClipped.value, uniforms.clip.value.toArray()]; }"""
    is_cut, plane = drawing.frame.evaluate(script)
    assert is_cut
    assert plane[:3] == [0, 1, 0]
    assert plane[3] == pytest.approx(0.0, abs=1e-3), "through the middle of the blank"
    page.close()


@pytest.mark.parametrize("width", [1280, pytest.param(390, marks=pytest.mark.validation)])
def test_drawing_has_no_serious_finding(browser: Any, site: Server, tmp_path: Path, width: int) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason='pip install "presswork[test]"')
    copy_example("square_cup", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml", width, 844)
    page.tab.goto(f"{site.address}drawing?of=1")
    page.wait_until_drawn()
    found = axe.Axe().run(page.tab).response["violations"]
    assert not [one["help"] for one in found if one["impact"] in ("serious", "critical")]
    assert page.ask("() => document.documentElement.scrollWidth") <= width
    page.close()


CREASES = """
  const points = Float32Array.from({ length: 24 }, (_, i) => (Math.floor(i / 3) >> i % 3) & 1);
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const triangles = Uint32Array.from(sides.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
  const apart = new Float32Array(108);
  triangles.forEach((node, i) => apart.set(points.subarray(3 * node, 3 * node + 3), 3 * i));
  return [triangles, triangles.slice(6)].map((these) => findCreases(points, these, 20).length / 6)
    .concat(findCreases(apart, Uint32Array.from(triangles.keys()), 20));
"""


def test_edges_of_a_tool_are_drawn_where_it_bends_or_ends(browser: Any) -> None:
    """A cube has 12 edges, and without its lid, too; triangles that share no points are left to another function."""
    module = (
        (files("presswork.report") / "page" / "creases.js").read_text("utf-8").replace("export function", "function")
    )
    page = browser.new_page()
    assert page.evaluate(f"() => {{ {module}\n{CREASES} }}") == [12, 12, None]
    page.close()
