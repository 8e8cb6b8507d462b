# SPDX-License-Identifier: Apache-2.0
"""Inches and degrees Fahrenheit in the page, in a real browser, and notes that stand in the view and on pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.model import CellBlock, Mesh
from presswork.report import write_report
from presswork.results import Result, append_step
from tests.regression.browser import Page, open_report, share_browser, share_upset

browser, upset, page = share_browser, share_upset, open_report


def test_lengths_are_shown_in_inches_everywhere(page: Page, upset: Result) -> None:
    page.choose("Field", "displacement_y")
    page.tab.get_by_role("tab", name="Curves").click()
    page.choose("Units", "in °C")
    low, _ = page.ask("() => presswork.stage.legend.full")
    assert low == pytest.approx(-9.0 / 25.4, rel=1e-3)
    assert "[in]" in page.tab.locator(".legend-title").inner_text()
    page.tab.wait_for_function("() => presswork.panel.chart?.plot")
    stroke = page.ask("() => presswork.panel.chart.series[0].x.at(-1)")
    assert stroke == pytest.approx(9.0 / 25.4, rel=1e-5)
    page.tab.get_by_role("tab", name="Measure").click()
    first, last = (int(np.linalg.norm(upset.mesh.points - place, axis=1).argmin()) for place in ([5, 7.5], [2.5, 3.75]))
    for node in (first, last):
        x, y = page.ask("(node) => presswork.stage.viewer.project(presswork.stage.scenes[0].nodePlace(node))", node)
        page.tab.locator("#canvas").click(position={"x": x, "y": y})
        page.settle()
    page.tab.wait_for_timeout(100)
    word, value, unit = page.tab.locator(".measured").inner_text().split()[:3]
    length = np.linalg.norm(upset.points()[first] - upset.points()[last]) / 25.4
    assert (word, unit) == ("Distance", "in")
    assert float(value) == pytest.approx(length, rel=2e-3)
    page.choose("Units", "mm °C")
    assert page.ask("() => presswork.stage.legend.full[0]") == pytest.approx(-9.0, rel=1e-3)


def test_temperatures_are_shown_in_fahrenheit(browser: Any, tmp_path: Path) -> None:
    x, y = (axis.ravel() for axis in np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0]))
    cells = np.array([[0, 1, 4, 3], [1, 2, 5, 4]], dtype=np.int32)
    mesh = Mesh(np.stack([x, y], axis=1), (CellBlock("quad4_fbar", cells, 0),), {}, {}, np.zeros((0, 2), np.int32))
    point_data, cell_data = {"displacement": np.zeros((6, 2))}, {"temperature": np.array([20.0, 1000.0])}
    info = {"title": "hot", "analysis": "plane_strain"}
    append_step(tmp_path / "results.vtkhdf", mesh, 0.0, point_data, cell_data, info=info)
    page = Page(browser, write_report(Result(tmp_path)))
    page.choose("Field", "temperature")
    page.choose("Units", "mm °F")
    assert page.ask("() => presswork.stage.legend.full") == pytest.approx([68.0, 1832.0], rel=1e-4)
    assert page.tab.locator(".legend-title").inner_text().endswith("[°F]")
    assert "max 1832" in page.tab.locator("#marks").inner_text()
    page.close()


def test_a_note_stands_at_its_place_and_goes_again(page: Page) -> None:
    page.tab.get_by_role("tab", name="Part").click()
    page.ask("() => presswork.store.set({ picked: { run: 0, face: 5, node: 3 } })")
    page.settle()
    page.tab.get_by_label("Note at the pin").fill("radius too small")
    page.tab.get_by_role("button", name="Add note").click()
    page.settle()
    note = page.tab.locator(".mark.note")
    assert note.inner_text() == "radius too small"
    place = page.ask("() => presswork.stage.viewer.project(presswork.stage.scenes[0].facePlace(5))")
    shown = page.ask("() => presswork.stage.marks.find(({ element }) => element.classList.contains('note')).at")
    assert shown == pytest.approx(place, abs=0.5)
    page.tab.get_by_role("button", name="Remove the note radius too small").click()
    page.settle()
    assert note.count() == 0
