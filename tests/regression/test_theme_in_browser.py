# SPDX-License-Identifier: Apache-2.0
"""Dark pages in a real browser: by the system's wish or by the switch, readable, remembered, printed on white."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from presswork.examples import copy_example
from presswork.report import write_report
from presswork.results import Result
from presswork.server.http import Server
from tests.regression.browser import Page, Tab, serve_folder, share_browser, share_upset

browser, upset, site = share_browser, share_upset, serve_folder
SERIOUS = ("serious", "critical")
PAPER = "() => getComputedStyle(document.querySelector('header')).backgroundColor"
DARK, LIGHT = "rgb(30, 36, 44)", "rgb(255, 255, 255)"


def list_findings(page: Tab) -> list[str]:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason='pip install "presswork[test]"')
    found = axe.Axe().run(page.tab).response["violations"]
    return [f"{one['help']}: {one['nodes'][0]['html'][:160]}" for one in found if one["impact"] in SERIOUS]


def test_report_is_dark_where_the_system_is_and_light_by_the_switch(browser: Any, upset: Result) -> None:
    page = Page(browser, write_report(upset))
    assert page.ask(PAPER) == LIGHT
    page.tab.emulate_media(color_scheme="dark")
    assert page.ask(PAPER) == DARK
    for tab in ("Result", "Curves", "Part", "Contact", "Measure", "Case"):
        page.tab.get_by_role("tab", name=tab).click()
        page.tab.wait_for_timeout(100)
        assert list_findings(page) == [], tab
    page.tab.get_by_role("button", name="Light", exact=True).click()
    assert page.ask(PAPER) == LIGHT
    page.close()


def test_print_of_a_dark_page_is_on_white_paper(browser: Any, upset: Result) -> None:
    page = Page(browser, write_report(upset))
    page.tab.emulate_media(color_scheme="dark")
    page.ask("""() => { window.print = () => {
      window.paper = getComputedStyle(document.querySelector("#print")).backgroundColor; }; }""")
    page.tab.get_by_role("button", name="Print the view and all tabs").click()
    page.tab.wait_for_function("() => window.paper")
    assert page.ask("() => window.paper") == LIGHT
    page.tab.wait_for_function("() => !document.querySelector('#print')")
    assert page.ask(PAPER) == DARK
    page.close()


def test_switch_is_remembered_from_page_to_page(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("upsetting_q4", tmp_path)
    page = Tab(browser, site.address)
    page.tab.get_by_role("button", name="Dark", exact=True).click()
    for name in ("", "new", "edit?case=upsetting_q4.toml"):
        page.tab.goto(f"{site.address}{name}")
        page.wait_until_drawn()
        assert page.ask(PAPER) == DARK, name
        assert list_findings(page) == [], name
    page.close()
