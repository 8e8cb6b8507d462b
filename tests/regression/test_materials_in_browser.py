# SPDX-License-Identifier: Apache-2.0
"""Materials are chosen by their curves at the states of the job, or fitted to a machine's file and saved."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.examples import copy_example
from presswork.server.http import Server
from tests.regression.browser import Person, Tab, serve_folder, share_browser

browser, site = share_browser, serve_folder
DATA = Path(__file__).parents[1] / "data"
K, E0, N = 530.0, 0.004, 0.21
"""Swift's law of the tensile test that is written."""


def write_test(path: Path) -> None:
    """Write engineering strain and stress of a steel as a German machine does."""
    plastic = np.linspace(0.0, 0.25, 120)
    true = K * (E0 + plastic) ** N
    strain = np.expm1(plastic + true / 206e3)
    rows = [f"{100 * e:.5f};{s:.4f}".replace(".", ",") for e, s in zip(strain, true / (1 + strain), strict=True)]
    path.write_text("\n".join(["Dehnung [%];Spannung [MPa]", *rows, ""]), encoding="utf-8")


def open_chooser(person: Person, place: str) -> None:
    person.press(f"Choose a material for {place}")
    person.page.tab.wait_for_selector("#chooser[open] canvas")


@pytest.mark.validation
def test_hot_material_is_chosen_by_its_curves_and_completed(browser: Any, site: Server, tmp_path: Path) -> None:
    site_case = copy_example("hot_disc", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=hot_disc.toml")
    person = Person(page)
    open_chooser(person, "workpiece material")
    page.tab.get_by_label("Find").fill("c45 hot")
    assert page.tab.locator("#chooser-list li:visible").count() == 2, "C45, and C45 hot"
    person.press("C45, hot")
    page.tab.get_by_role("img", name="Flow stress of c45_hot at the temperatures and rates of the job").wait_for()
    labels = page.tab.locator("#chooser-shown .key").inner_text()
    assert "1200 °C" in labels
    assert "1000 °C" in labels
    person.press("Use this material")
    person.wait()
    page.tab.wait_for_timeout(500)
    person.wait()
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    person.press("Save")
    page.tab.wait_for_function("() => document.getElementById('saved').textContent === 'saved'")
    page.close()
    data = tomllib.loads(site_case.read_text("utf-8"))
    assert data["workpiece"]["material"] == "c45_hot"
    assert list(data["materials"]) == ["c45_hot"], "the steel that nothing names any more is gone"
    assert data["materials"]["c45_hot"]["thermal"]["specific_heat"][0] == [20, "440 J/(kg*K)"]


def test_a_tensile_test_becomes_the_material_within_eight_clicks(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("square_cup", tmp_path)
    (tmp_path / "lab").mkdir()
    write_test(tmp_path / "lab" / "zug.csv")
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml")
    person = Person(page)
    open_chooser(person, "blank material")
    person.choose_file("From a test (CSV)", tmp_path / "lab" / "zug.csv")
    page.tab.get_by_role("img", name="swift fitted to zug.csv").wait_for(timeout=60_000)
    assert "tensile test" in page.tab.locator("#chooser-shown h3").inner_text()
    person.press("Save and use")
    page.tab.wait_for_selector("#chooser", state="hidden")
    person.wait()
    assert page.tab.locator('[data-key="blank.material"]').input_value() == "zug.toml"
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    page.close()
    assert person.clicks <= 8
    assert person.typed == 0
    hardening = tomllib.loads((tmp_path / "zug.toml").read_text("utf-8"))["material"]["hardening"]
    assert hardening["law"] == "swift"
    assert hardening["K"] == pytest.approx(K, rel=0.01)
    assert hardening["n"] == pytest.approx(N, rel=0.01)


@pytest.mark.validation
def test_hot_compression_tests_become_a_hot_material(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("hot_disc", tmp_path)
    (tmp_path / "lab").mkdir()
    shutil.copy(DATA / "hot_compression_medium_carbon_steel.csv", tmp_path / "lab" / "gleeble.csv")
    page = Tab(browser, f"{site.address}edit?case=hot_disc.toml")
    person = Person(page)
    open_chooser(person, "workpiece material")
    person.choose_file("From a test (CSV)", tmp_path / "lab" / "gleeble.csv")
    page.tab.get_by_role("img", name="hensel_spittel fitted to gleeble.csv").wait_for(timeout=60_000)
    page.tab.get_by_label("Name of the material").fill("mould steel")
    person.press("Save and use")
    page.tab.wait_for_selector("#chooser", state="hidden")
    person.wait()
    assert page.tab.locator('[data-key="workpiece.material"]').input_value() == "mould steel"
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    page.close()
    assert person.clicks <= 8
    assert (tmp_path / "mould steel.toml").is_file()


@pytest.mark.validation
def test_a_file_that_is_no_test_is_refused_with_its_fault(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("square_cup", tmp_path)
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab" / "notes.csv").write_text("day;weather\nMonday;rain\n", "utf-8")
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml")
    person = Person(page)
    open_chooser(person, "blank material")
    person.choose_file("From a test (CSV)", tmp_path / "lab" / "notes.csv")
    page.tab.wait_for_selector("#chooser-shown .bad")
    assert "notes.csv" in page.tab.locator("#chooser-shown .bad").inner_text()
    assert page.tab.get_by_role("button", name="Save and use").is_disabled()
    person.press("Cancel")
    page.close()


@pytest.mark.parametrize("width", [1280, pytest.param(390, marks=pytest.mark.validation)])
def test_chooser_has_no_serious_finding(browser: Any, site: Server, tmp_path: Path, width: int) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason='pip install "presswork[test]"')
    copy_example("square_cup", tmp_path)
    write_test(tmp_path / "zug.csv")
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml", width, 844)
    open_chooser(Person(page), "blank material")
    for _ in range(2):
        found = axe.Axe().run(page.tab).response["violations"]
        assert not [one["help"] for one in found if one["impact"] in ("serious", "critical")]
        page.tab.locator("#chooser-file").set_input_files(tmp_path / "zug.csv")
        page.tab.get_by_role("img", name="swift fitted to zug.csv").wait_for(timeout=60_000)
    assert page.ask("() => document.querySelector('dialog[open]').scrollWidth") <= width
    page.close()
