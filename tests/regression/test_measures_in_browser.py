# SPDX-License-Identifier: Apache-2.0
"""The page's verdict, its measures and what leaves it, in a real browser: figures are those of the results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.tri import LinearTriInterpolator, Triangulation

from presswork import Case, run
from presswork.report import write_report
from presswork.results import Result
from presswork.view.cells import triangulate
from tests.regression.browser import Page, open_report, share_browser, share_upset

browser, upset, page = share_browser, share_upset, open_report


def test_click_on_a_line_of_the_verdict_shows_its_field_and_place(page: Page, upset: Result) -> None:
    """The largest contact pressure: its field is shown, at its step, with the pin at the node where it is."""
    assert page.tab.get_by_role("tab").first.inner_text() == "Result"
    assert page.tab.locator(".verdict").inner_text() == "OK"
    page.tab.get_by_role("button", name="Contact pressure on tools").click()
    page.settle()
    largest = upset.summary["fields"]["contact_pressure"]["largest"]
    state = page.ask("() => presswork.store.state")
    assert (state["field"], state["step"]) == ("contact_pressure", largest["step"])
    value = upset.field("contact_pressure", largest["step"])[state["picked"]["node"]]
    assert value == pytest.approx(largest["value"], rel=1e-6)


def test_head_of_a_failed_run_says_reason_and_remedy(browser: Any, upset: Result, tmp_path: Path) -> None:
    changes = ["workpiece.mesh.cells=[6,6]", "limits.mean_pressure=0.3"]
    outcome = run(Case.from_toml(upset.folder / "case.toml", overrides=changes), tmp_path / "out")
    assert outcome.status == "gave_up"
    page = Page(browser, write_report(outcome.result))
    assert page.tab.locator("#reason").inner_text() == outcome.reason
    assert page.tab.locator(".verdict").inner_text() == "Fails"
    page.tab.get_by_text("End of the log").click()
    assert "gave_up" in page.tab.get_by_label("Log of out").inner_text()
    page.close()


def pick(page: Page, *nodes: int) -> str:
    """Pick nodes in the view and return what the tab Measure says."""
    script = "(node) => presswork.stage.viewer.project(presswork.stage.scenes[0].nodePlace(node))"
    for node in nodes:
        x, y = page.ask(script, node)
        page.tab.locator("#canvas").click(position={"x": x, "y": y})
        page.settle()
    page.tab.wait_for_timeout(50)
    return page.tab.locator(".measured").inner_text()


def test_distance_angle_radius_and_thickness_are_those_of_the_picked_nodes(page: Page, upset: Result) -> None:
    page.tab.get_by_role("tab", name="Measure").click()
    points = upset.points()
    first, corner, last = (int(np.linalg.norm(upset.mesh.points - place, axis=1).argmin()) for place in (
        [5.0, 7.5], [2.5, 7.5], [2.5, 3.75],
    ))  # fmt: skip
    a, b, c = points[[first, corner, last]]
    assert float(pick(page, first, corner).split()[1]) == pytest.approx(np.linalg.norm(b - a), rel=1e-3)
    page.choose("Quantity", "angle")
    cosine = (a - b) @ (c - b) / np.linalg.norm(a - b) / np.linalg.norm(c - b)
    words = pick(page, first, corner, last)
    assert float(words.split()[1].rstrip("°")) == pytest.approx(np.degrees(np.arccos(cosine)), rel=1e-3)
    page.choose("Quantity", "radius")
    sides = np.linalg.norm([b - c, a - c, a - b], axis=1)
    area = 0.5 * abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    assert float(pick(page, first, corner, last).split()[1]) == pytest.approx(sides.prod() / (4 * area), rel=2e-3)
    page.choose("Quantity", "thickness")
    top = int(np.linalg.norm(upset.mesh.points - [5.0, 15.0], axis=1).argmin())
    assert float(pick(page, top).split()[1]) == pytest.approx(6.0, rel=1e-3), "the height of the upset half"
    page.tab.locator("#time").focus()
    page.tab.keyboard.press("Home")
    page.settle()
    page.tab.wait_for_timeout(50)
    assert float(page.tab.locator(".measured").inner_text().split()[1]) == pytest.approx(15.0, rel=1e-3)


def test_section_is_set_in_mm_and_saved_with_the_field_there(page: Page, upset: Result, tmp_path: Path) -> None:
    page.choose("Field", "displacement_y")
    page.tab.get_by_role("tab", name="Measure").click()
    page.choose("Across", "y")
    place = page.tab.get_by_label("Position of the section [mm]")
    place.fill("3.5")
    place.press("Enter")
    page.settle()
    page.tab.wait_for_timeout(100)
    with page.tab.expect_download() as saved:
        page.tab.get_by_role("button", name="Save the section's curve as CSV").click()
    saved.value.save_as(tmp_path / "section.csv")
    rows = np.genfromtxt(tmp_path / "section.csv", delimiter=",", names=True)
    np.testing.assert_allclose(rows["y_mm"], 3.5, atol=1e-3)
    assert np.ptp(rows["length_mm"]) == pytest.approx(np.ptp(rows["x_mm"]))
    net = Triangulation(*upset.points().T, triangulate(upset.mesh))
    there = LinearTriInterpolator(net, upset.scalar("displacement_y"))(rows["x_mm"], rows["y_mm"]).filled(np.nan)
    assert np.isfinite(there).sum() > 8
    np.testing.assert_allclose(rows["displacement_y_mm"][np.isfinite(there)], there[np.isfinite(there)], atol=5e-3)
    hidden = page.ask("() => [...document.querySelectorAll('.mark')].filter((mark) => mark.hidden).length")
    assert hidden == 1, "the label of the smallest displacement, at the top, is cut off with the part"


def test_picture_and_all_tabs_leave_the_page(page: Page, tmp_path: Path) -> None:
    with page.tab.expect_download() as saved:
        page.tab.get_by_role("button", name="Save the view as a picture").click()
    saved.value.save_as(tmp_path / "view.png")
    image = np.asarray(pytest.importorskip("PIL.Image").open(tmp_path / "view.png").convert("RGB")).astype(int)
    assert (np.ptp(image, axis=2) > 60).mean() > 0.05, "the part in its colours"
    page.ask("""() => { window.print = () => {
      const paper = document.querySelector("#print"), isInked = (canvas) => canvas.getContext("2d")
        .getImageData(0, 0, canvas.width, canvas.height).data.some((value) => value > 0);
      window.charts = [...paper.querySelectorAll("canvas")].map(isInked);
      window.seen = paper.innerText; }; }""")
    page.tab.get_by_role("button", name="Print the view and all tabs").click()
    page.tab.wait_for_function("() => window.seen")
    printed = page.ask("() => window.seen").split("\n")
    for name in ("Result", "Curves", "Part", "Contact", "Case"):
        assert name in printed
    charts = page.ask("() => window.charts")
    assert len(charts) >= 2
    assert all(charts)
    assert page.tab.locator("#print").count() == 0


def test_what_the_press_bears_is_drawn_across_the_force(browser: Any, upset: Result, tmp_path: Path) -> None:
    """A dashed level inside the chart where the force comes near it; a press far beyond is named only."""
    for force, is_near in (("1100 kN", True), ("90 MN", False)):
        changes = ["workpiece.mesh.cells=[4,4]", f'limits.force="{force}"']
        outcome = run(Case.from_toml(upset.folder / "case.toml", overrides=changes), tmp_path / f"{is_near}")
        page = Page(browser, write_report(outcome.result))
        page.tab.get_by_role("tab", name="Curves").click()
        page.tab.wait_for_function("() => presswork.panel.chart?.plot")
        (level,) = page.ask("() => presswork.panel.chart.levels")
        assert level["isNear"] == is_near
        assert (page.ask("() => presswork.panel.chart.ranges.y[1]") > 1100.0) == is_near
        assert f"the press bears {level['y']:g} kN" in page.tab.locator("#panel .key").first.inner_text()
        page.close()


def test_film_of_all_steps_leaves_the_page(page: Page, tmp_path: Path) -> None:
    """A WebM whose pictures differ from its first to its last; the page is at its step again."""
    step = page.ask("() => presswork.store.state.step")
    with page.tab.expect_download(timeout=60_000) as saved:
        page.tab.get_by_role("button", name="Save a film of all steps (WebM)").click()
    assert saved.value.suggested_filename == "out_effective_stress.webm"
    saved.value.save_as(tmp_path / "film.webm")
    content = (tmp_path / "film.webm").read_bytes()
    assert content[:4] == b"\x1a\x45\xdf\xa3", "the head of EBML"
    assert len(content) > 20_000
    page.tab.wait_for_function("() => !document.querySelector('#timeline button:disabled')")
    assert page.ask("() => presswork.store.state.step") == step
