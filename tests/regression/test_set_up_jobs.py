# SPDX-License-Identifier: Apache-2.0
"""Jobs that an engineer sets up from an empty folder, with clicks and keys counted; each ends in a sound case."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import pytest

from presswork.results import Result
from presswork.server.http import Server
from presswork.server.processes import PROCESSES
from tests.problems.cup_surface import revolve, write_cup_tools, write_stl
from tests.regression.browser import Person, Tab, serve_folder, share_browser

browser, site = share_browser, serve_folder
DIE = [(0, 33), (10, 33), (12, 25), (20, 25), (22, 21), (27, 21), (30, 24), (80, 24)]
"""Half section of a die (radius, height) [mm]."""


class Job:
    """A person before the page of new cases, who chooses a process."""

    def __init__(self, browser: Any, site: Server, process: str) -> None:
        self.page = Tab(browser, f"{site.address}new")
        self.person = Person(self.page)
        self.person.press(PROCESSES[process].title)
        self.page.tab.wait_for_selector("dialog[open]")

    def open_editor(self) -> None:
        """Press Enter, and see the editor with a sound case."""
        self.person.key("Enter")
        self.page.tab.wait_for_url("**/edit?*")
        self.page.wait_until_drawn()
        self.person.wait()
        assert self.page.tab.locator("#problems li").count() == 0, self.page.tab.locator("#problems").inner_text()
        assert self.page.tab.get_by_role("button", name="Save and run").is_enabled()

    def end(self, path: Path, *, clicks: int, keys: int) -> dict[str, Any]:
        """Return the case's data; what the job took must be within limits."""
        self.page.close()
        assert self.person.clicks <= clicks
        assert self.person.typed <= keys
        return tomllib.loads(path.read_text(encoding="utf-8"))


def test_cup_of_own_dimensions_is_set_up_and_runs(browser: Any, site: Server, tmp_path: Path) -> None:
    job = Job(browser, site, "cylindrical_cup")
    job.person.key("80", "Tab", "0.8", "Tab", "dc05", "Tab", "40", "Tab", "5", "Tab", "6", "Tab", "8")
    job.open_editor()
    assert "0.8 mm of dc05" in job.page.tab.locator("#description").inner_text()
    job.page.tab.frame_locator("#drawing").locator("html[data-ready]").wait_for(timeout=60_000)
    assert job.page.tab.get_by_role("img", name="Flow stress of dc05").is_visible()
    assert job.page.tab.get_by_role("img", name="Forming limit of dc05, 0.8 mm thick").is_visible()
    job.person.press("Save and run")
    job.page.tab.wait_for_url("**/run?*", timeout=120_000)
    job.page.wait_until_drawn()
    job.page.tab.wait_for_function("() => presswork.runs[0].summary.status === 'completed'", timeout=180_000)
    data = job.end(tmp_path / "cylindrical_cup.toml", clicks=2, keys=21)
    assert data["tools"]["die"]["diameter"] == pytest.approx(40 + 2.4 * 0.8)
    assert Result(tmp_path / "cylindrical_cup").history["punch.stroke"][-1] == pytest.approx(6.0)


def test_hot_die_from_a_drawing_is_set_up(browser: Any, site: Server, tmp_path: Path) -> None:
    (tmp_path / "cad").mkdir()
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    drawing.modelspace().add_lwpolyline(DIE)
    drawing.saveas(tmp_path / "cad" / "upper.dxf")
    job = Job(browser, site, "closed_die_hot")
    job.person.key("30", "Tab", "34", "Tab", "aa6082_hot", "Tab", "480", "Tab")
    job.person.choose_file("Choose a file: Upper die", tmp_path / "cad" / "upper.dxf")
    job.page.tab.get_by_label("Stroke of the upper die").click()
    job.person.clicks += 1
    job.person.key("Control+a", "9")
    job.open_editor()
    data = job.end(tmp_path / "closed_die_hot.toml", clicks=4, keys=25)
    assert data["tools"]["upper_die"]["profile_file"] == "upper.dxf"
    assert data["heat"]["initial_temperature"] == 480
    assert data["workpiece"]["mesh"]["size"] == [15, 17]
    assert data["stages"][-1]["tools"]["upper_die"]["stroke"] == 9


@pytest.mark.validation
def test_forging_in_space_from_stl_is_set_up(browser: Any, site: Server, tmp_path: Path) -> None:
    (tmp_path / "cad").mkdir()
    write_stl(tmp_path / "cad" / "upper.stl", revolve(DIE))
    job = Job(browser, site, "closed_die_3d")
    job.person.key("30", "Tab", "34", "Tab", "c45", "Tab")
    job.person.choose_file("Choose a file: Upper die", tmp_path / "cad" / "upper.stl")
    job.page.tab.get_by_label("Stroke of the upper die").click()
    job.person.clicks += 1
    job.person.key("Control+a", "9")
    job.open_editor()
    data = job.end(tmp_path / "closed_die_3d.toml", clicks=4, keys=15)
    assert data["tools"]["upper_die"]["path"] == "upper.stl"
    assert data["workpiece"]["mesh"]["angle"] == 90


@pytest.mark.validation
def test_two_operations_are_set_up(browser: Any, site: Server, tmp_path: Path) -> None:
    job = Job(browser, site, "cup_line")
    job.person.key("120", "Tab", "1.2", "Tab", "Tab", "60", "Tab", "8", "Tab", "15", "Tab", "105", "Tab", "30")
    job.open_editor()
    data = job.end(tmp_path / "cup_line.toml", clicks=1, keys=24)
    assert [operation["name"] for operation in data["operations"]] == ["draw", "pierce"]
    assert data["operations"][1]["trim"]["hole"]["diameter"] == 30


@pytest.mark.validation
def test_panel_from_tools_of_cad_is_set_up(browser: Any, site: Server, tmp_path: Path) -> None:
    (tmp_path / "cad").mkdir()
    write_cup_tools(tmp_path / "cad")
    job = Job(browser, site, "tools_from_files")
    job.person.press("Open the editor")
    job.page.tab.wait_for_function("() => document.getElementById('fault').textContent === 'Punch: choose a file'")
    for name in ("Punch", "Die", "Blank holder"):
        job.person.choose_file(f"Choose a file: {name}", tmp_path / "cad" / f"{name.split()[-1].lower()}.stl")
    job.page.tab.get_by_label("Length along x").click()
    job.person.clicks += 1
    job.person.key("Control+a", "90", "Tab", "90", "Tab", "0.8")
    job.open_editor()
    data = job.end(tmp_path / "tools_from_files.toml", clicks=9, keys=13)
    assert data["tools"]["holder"]["path"] == "holder.stl"
