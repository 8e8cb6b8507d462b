# SPDX-License-Identifier: Apache-2.0
"""The page of a sheet in a real browser: outlines with the trim line, draw-in, sections, zones, against the results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.formability import ZONES
from presswork.post import cut_sheet, measure_draw_in, measure_draw_in_around
from presswork.recorder import run_model
from presswork.report import write_report
from tests.regression.browser import Page, share_browser

browser = share_browser


@pytest.fixture(scope="module")
def cup(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """A quarter of a coarse cup, drawn 10 mm deep and trimmed to 46 mm."""
    tool = {"shape": "round", "mu": 0.05}
    case = StampingCase.model_validate({
        "title": "coarse cup", "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 60, "thickness": 1, "element_size": 3, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": {
            "young": "206 GPa", "poisson": 0.3,
            "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589},
            "forming_limit": {"law": "keeler", "thickness": 1, "n": 0.2589},
        }},
        "tools": {
            "punch": {**tool, "kind": "punch", "diameter": 30, "edge_radius": 5},
            "die": {**tool, "kind": "die", "diameter": 33, "edge_radius": 5},
            "holder": {**tool, "kind": "holder", "diameter": 34, "edge_radius": 1},
        },
        "stages": [{"name": "draw", "velocity": "5 m/s",
                    "tools": {"punch": {"stroke": 10}, "holder": {"force": 8e3}}}],
        "trim": {"flange": {"shape": "circle", "diameter": 46}},
        "output": {"rows": 20, "steps": 3},
    })  # fmt: skip
    return run_model(build_model(case), tmp_path_factory.mktemp("sheet") / "cup", threads=1).result


@pytest.fixture
def page(browser: Any, cup: Result) -> Any:
    opened = Page(browser, write_report(cup))
    yield opened
    opened.close()


READ = """(label) => { const panel = presswork.panel, find = (one) => one.options.label.startsWith(label);
  return panel.charts.find(find).series.map(({ label, x, y }) => [label, [...x], [...y]]); }"""


def read(page: Page, label: str) -> dict[str, np.ndarray]:
    """Return the curves of a chart of the open tab by their names, rows of x and y."""
    return {name: np.array([x, y], dtype=float).T for name, x, y in page.ask(READ, label)}


def open_sheet(page: Page) -> None:
    page.tab.get_by_role("tab", name="Sheet").click()
    page.tab.wait_for_function("() => presswork.panel.along?.series.length")


def test_outlines_show_blank_trim_line_and_part(page: Page, cup: Result) -> None:
    open_sheet(page)
    found = read(page, "Outline")
    assert set(found) == {"blank", "trim line on the blank", "before trimming", "now"}
    outermost = {name: np.nanmax(np.hypot(*places.T)) for name, places in found.items()}
    assert outermost["blank"] == pytest.approx(30.0, rel=1e-3)
    assert outermost["now"] == pytest.approx(23.0, abs=0.4), "the trim line of 46 mm, by chords of cells"
    formed = max(step for step in range(len(cup.times)) if cup.mesh_at(step) is cup.mesh)
    assert outermost["before trimming"] == pytest.approx(np.hypot(*cup.points(formed)[:, :2].T).max(), rel=1e-3)
    assert outermost["trim line on the blank"] == pytest.approx(
        np.hypot(*cup.mesh_at(-1).points[:, :2].T).max(), rel=1e-3
    )
    page.tab.locator("#time").focus()
    page.tab.keyboard.press("Home")
    page.settle()
    page.tab.wait_for_timeout(100)
    assert set(read(page, "Outline")) == {"blank", "now"}


def test_draw_in_is_that_of_the_results(page: Page, cup: Result) -> None:
    open_sheet(page)
    formed = max(step for step in range(len(cup.times)) if cup.mesh_at(step) is cup.mesh)
    ((_, around),) = read(page, "Draw-in of the blank's edge over the angle").items()
    np.testing.assert_allclose(around, measure_draw_in_around(cup, formed), rtol=1e-5, atol=1e-6)
    over = read(page, "Draw-in of the blank's edge over the stroke of punch")
    curve = next(rows for name, rows in over.items() if name.startswith("at 0"))
    assert curve[-1] == pytest.approx([10.0, measure_draw_in(cup, 0.0, formed)], rel=1e-3)


@pytest.mark.parametrize("angle", [0, 45])
def test_section_has_shape_and_thickness_of_the_part(page: Page, cup: Result, tmp_path: Path, angle: int) -> None:
    """Beside cut_sheet, which walks over the cells: the same line; thickness as means at nodes, so nearly the same."""
    open_sheet(page)
    page.choose("Value", "thickness")
    page.tab.get_by_label("Angle of the section from x [degrees]").fill(str(angle))
    page.tab.keyboard.press("Tab")
    page.tab.wait_for_timeout(200)
    cut = cut_sheet(cup, np.radians(angle), whole=True)
    middles, thickness = cut.line.mean(axis=1), cup.field("thickness")[cut.cell]
    places = read(page, "The sheet along the section")["sheet"]
    places = places[np.isfinite(places[:, 0])]
    places = places[np.argsort(places[:, 0])]
    flat = middles[:, 0] < 8.0  # under the punch's flat, and on the flange: no steep wall, where heights differ much
    np.testing.assert_allclose(np.interp(middles[flat, 0], *places.T), middles[flat, 1], atol=0.05)
    with page.tab.expect_download() as saved:
        page.tab.get_by_role("button", name="Save the section as CSV").click()
    saved.value.save_as(tmp_path / "section.csv")
    rows = np.genfromtxt(tmp_path / "section.csv", delimiter=",", names=True)
    assert np.ptp(rows["length_mm"]) == pytest.approx(
        np.linalg.norm(np.diff(cut.line, axis=1)[:, 0], axis=1).sum(), rel=0.01
    )
    order = np.argsort(rows["distance_mm"])
    shown = np.interp(middles[:, 0], rows["distance_mm"][order], rows["thickness_mm"][order])
    assert np.abs(shown - thickness).max() < 0.25 * np.ptp(cup.field("thickness"))
    assert np.corrcoef(shown, thickness)[0, 1] > 0.95


def test_every_zone_of_the_forming_limit_is_explained(page: Page) -> None:
    page.tab.get_by_role("tab", name="Forming limit").click()
    page.tab.wait_for_selector("#panel .lines li")
    lines = page.tab.locator("#panel .lines li").all_inner_texts()
    assert [line.split(":")[0] for line in lines] == list(ZONES)
    assert all(len(line.split(":")[1]) > 10 for line in lines)


def test_margin_to_the_forming_limit_is_red_at_zero_and_green_far_from_it(page: Page, cup: Result) -> None:
    page.choose("Field", "forming_limit_margin_polar")
    low, high = page.ask("() => presswork.stage.legend.range")
    assert (low, high) == (-0.1, 1.0)
    script = """(part) => { const { data } = presswork.stage.scenes[0].body.material.uniforms.colours.value.image;
      return [...data.slice(4 * Math.round(255 * part)).slice(0, 3)]; }"""
    red, green = (page.ask(script, (value - low) / (high - low)) for value in (0.0, 0.9))
    assert red[0] > 180 > 100 > red[1]
    assert green[1] > 120 > 60 > green[0]
