# SPDX-License-Identifier: Apache-2.0
"""Every page, wide and narrow, without serious findings of axe-core, the rules of WCAG as a program."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.report import write_report
from presswork.server.http import Server
from presswork.server.site import Site
from presswork.study.sweep import run_sweep
from tests.regression.browser import Tab, share_browser

browser = share_browser

PAGES = ["", "new", "edit?case=upsetting_q4.toml", "edit?case=cup.toml", "run?run=out", "sweep?sweep=sweep", "report"]
SERIOUS = ("serious", "critical")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("opened")
    path = copy_example("upsetting_q4", root)
    small = ["workpiece.mesh.cells=[4,4]", "output.steps=2"]
    write_report(run(Case.from_toml(path, overrides=small), root / "out").result)
    run_sweep(path, {"stages.0.tools.punch.stroke": [1.0, 2.0]}, root / "sweep", settings=small, jobs=1)
    return root


@pytest.fixture(scope="module")
def site(folder: Path) -> Iterator[Server]:
    site = Site(folder)
    site.drafts.create("cylindrical_cup", "cup")
    with Server(site.answer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()
    site.close()


def list_findings(axe: Any, tab: Tab) -> list[str]:
    """Return the serious findings of axe-core on an open page."""
    found = axe.Axe().run(tab.tab).response["violations"]
    return [f"{one['id']}: {one['help']}: {one['nodes'][0]['html'][:200]}" for one in found if one["impact"] in SERIOUS]


@pytest.mark.parametrize("process", ["Closed die, hot", "Panel from CAD", "Blank of a part"])
def test_questions_of_a_process_have_no_serious_finding(browser: Any, site: Server, process: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason='pip install "presswork[test]"')
    tab = Tab(browser, f"{site.address}new")
    tab.tab.get_by_role("button", name=process).click()
    assert not list_findings(axe, tab)
    tab.tab.set_viewport_size({"width": 390, "height": 844})
    assert tab.ask("() => document.querySelector('dialog').scrollWidth <= 390")
    tab.close()


@pytest.mark.parametrize("page", PAGES)
def test_page_has_no_serious_finding(browser: Any, site: Server, folder: Path, page: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason='pip install "presswork[test]"')
    address = (folder / "out" / "report.html").as_uri() if page == "report" else site.address + page
    tab = Tab(browser, address, 1280, 844)
    tabs = tab.tab.get_by_role("tab").all()
    for each in tabs or [None]:
        if each:
            each.click()
            tab.tab.wait_for_timeout(200)
        for folded in tab.tab.locator("details").all():
            folded.evaluate("(element) => { element.open = true; }")
        assert not list_findings(axe, tab)
    tab.tab.set_viewport_size({"width": 390, "height": 844})
    tab.tab.wait_for_function("() => document.documentElement.scrollWidth <= 390", timeout=5_000)
    tab.close()
