# SPDX-License-Identifier: Apache-2.0
"""Profiles are edited as a table of x, y, radius beside their drawing, or taken from a file by one button."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from presswork.case import build_model, read_case
from presswork.case.motion.gaps import walk_profile
from presswork.examples import copy_example
from presswork.server.http import Server
from tests.problems.cup_surface import revolve, write_stl
from tests.regression.browser import Person, Tab, serve_folder, share_browser

browser, site = share_browser, serve_folder
KEY = "tools.die.profile"
TRACE = """async (rows) => (await import("./files/profile_drawing.js")).traceProfile(rows.map((row) => {
  const { to, radius = "", centre = ["", ""], turn = "" } = Array.isArray(row) ? { to: row } : row;
  return { x: to[0], y: to[1], radius, "centre x": centre[0], "centre y": centre[1], turn };
})).line"""


@pytest.mark.parametrize("name", ["forging_flash", "strip_rolling", "gear_blank"])
def test_drawing_is_the_tool_that_the_program_builds(browser: Any, site: Server, tmp_path: Path, name: str) -> None:
    """Corners of the drawn line lie on the profile with its arcs, and reach from one end to the other."""
    path = copy_example(name, tmp_path)
    tools = {tool.name: tool for tool in build_model(read_case(path)).plane_tools}
    page = Tab(browser, f"{site.address}new")
    for key, tool in tomllib.loads(path.read_text("utf-8"))["tools"].items():
        line = np.array(page.ask(TRACE, tool["profile"]))
        own = walk_profile(tools[key])
        at = np.array(tools[key].position[:2])
        apart = np.linalg.norm(line[:, None] + at - own[None], axis=2).min(axis=1)
        assert apart.max() < 0.02 * np.ptp(own, axis=0).max()
        ends = [np.linalg.norm(each[0] - each[-1]) for each in (line, own)]
        assert ends[0] == pytest.approx(ends[1], abs=1e-6)
    page.close()


def test_rows_are_typed_inserted_and_pasted(browser: Any, site: Server, tmp_path: Path) -> None:
    path = copy_example("forging_flash", tmp_path)
    before = tomllib.loads(path.read_text("utf-8"))["tools"]["die"]["profile"]
    page = Tab(browser, f"{site.address}edit?case=forging_flash.toml")
    person = Person(page)
    person.type(f"{KEY}.1.radius", "2.5")
    assert page.tab.locator(".drawn text").text_content() == "2", "the row that is edited is marked in the drawing"
    person.wait()
    person.type(f"{KEY}.3.radius", "40")
    person.wait()
    assert "too large" in page.tab.locator(f'tr:has([data-key="{KEY}.3.radius"]) + tr .fault').inner_text()
    person.type(f"{KEY}.3.radius", "2")
    person.press("Insert a row after row 7 of profile")
    person.type(f"{KEY}.7.0", "30")
    person.type(f"{KEY}.7.1", "8.6")
    person.press("Columns for arcs and friction in profile")
    person.type(f"{KEY}.8.m", "0.2")
    person.wait()
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    person.press("Save")
    page.tab.wait_for_function("() => document.getElementById('saved').textContent === 'saved'")
    page.close()
    after = tomllib.loads(path.read_text("utf-8"))["tools"]["die"]["profile"]
    assert after[1] == {"to": [6, 13.6], "radius": 2.5}
    assert after[:1] + after[2:7] == before[:1] + before[2:7]
    assert after[7:] == [[30, 8.6], {"to": [60, 8.6], "m": 0.2}]


def test_one_button_takes_a_profile_from_a_drawing(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("upsetting_q4", tmp_path)
    (tmp_path / "cad").mkdir()
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    drawing.modelspace().add_lwpolyline([(0, 15), (12, 15), (14, 17), (40, 17)])
    drawing.saveas(tmp_path / "cad" / "punch.dxf")
    page = Tab(browser, f"{site.address}edit?case=upsetting_q4.toml")
    person = Person(page)
    person.choose_file("Shape of punch from a file", tmp_path / "cad" / "punch.dxf")
    page.tab.wait_for_selector('[data-key="tools.punch.profile_file"]')
    person.wait()
    assert page.tab.locator('[data-key="tools.punch.profile_file"]').input_value() == "punch.dxf"
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    assert person.clicks == 2
    page.close()


@pytest.mark.validation
def test_one_button_takes_a_tool_from_stl(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("hot_square_flange", tmp_path)
    (tmp_path / "cad").mkdir()
    write_stl(tmp_path / "cad" / "upper.stl", revolve([(80, 44), (18, 44), (12, 40), (0, 40)]))
    page = Tab(browser, f"{site.address}edit?case=hot_square_flange.toml")
    person = Person(page)
    person.choose_file("Shape of die from a file", tmp_path / "cad" / "upper.stl")
    page.tab.wait_for_selector('[data-key="tools.die.path"]')
    person.wait()
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    assert page.tab.locator('[data-key="tools.die.m"]').input_value() == "0.3", "what both shapes have stays"
    page.close()


@pytest.mark.validation
def test_operations_and_stages_have_their_names(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("press_line", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=press_line.toml")
    legends = page.tab.locator("legend").all_inner_texts()
    assert {"1: draw", "2: pierce", "3: flange", "1: form"} <= set(legends)
    page.close()
