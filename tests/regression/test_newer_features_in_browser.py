# SPDX-License-Identifier: Apache-2.0
"""Wear, welded blanks, separation and ends of runs in pages: the editor offers their keys, Result has their lines."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from presswork.examples import copy_example
from presswork.report import write_report
from presswork.results import Result
from presswork.server.http import Server
from tests.regression.browser import Page, Person, Tab, serve_folder, share_browser, share_upset

browser, site, upset = share_browser, serve_folder, share_upset
OFFERED = [
    ("upsetting_q4", "wear", "tools.punch.wear", "coefficient"),
    ("square_cup", "zones", "blank.zones", "0.thickness"),
    ("upsetting_q4", "separation", "separation", "size"),
    ("upsetting_q4", "end", "limits.end", "0.column"),
]
FOUND = {
    "ended_by": "the end of `limits.end.0`: die.fill is above 0.98",
    "wear": {"punch": {"deepest_mm": 0.02, "parts": 1000, "limit_mm": 0.1, "parts_until_limit": 5000,
                       "deepest_at_mm": [3.0, 4.0]}},
    "weld_lines": {"thick": {"into_zone": {"mm": 2.5, "place": [1.0, 2.0]},
                             "out_of_zone": {"mm": -0.5, "place": [3.0, 4.0]}}},
    "separation": {"cracks": 2, "pieces": 2, "first_crack": {"time_s": 0.4, "stroke_mm": 3.5},
                   "parted": {"time_s": 0.8, "stroke_mm": 7.0}, "work_J": 31.7},
}  # fmt: skip


@pytest.mark.parametrize(("example", "word", "key", "leaf"), OFFERED)
def test_search_offers_the_keys_and_a_click_adds_them(
    browser: Any, site: Server, tmp_path: Path, example: str, word: str, key: str, leaf: str
) -> None:
    copy_example(example, tmp_path)
    page = Tab(browser, f"{site.address}edit?case={example}.toml")
    page.tab.get_by_label("Search", exact=True).fill(word)
    page.tab.locator("#found").get_by_role("button", name=key, exact=True).click()
    Person(page).wait()
    field = page.tab.locator(f'[data-key="{key}.{leaf}"]')
    field.wait_for(state="attached")
    heads = field.evaluate("(e) => e.closest('section').querySelector('h2').innerText")
    assert heads != "Other settings"
    page.close()


def test_result_has_a_line_for_each_and_a_click_goes_to_its_step(browser: Any, upset: Result, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(upset.folder, folder)
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    last = upset.times[-1]
    FOUND["separation"]["first_crack"]["time_s"] = 0.5 * last
    (folder / "summary.json").write_text(json.dumps({**summary, **FOUND}), "utf-8")
    page = Page(browser, write_report(Result(folder)))
    words = page.tab.locator("table.result").inner_text()
    for text in (
        "limits.end.0", "Wear of punch", "0.02 mm after 1000 parts", "0.1 mm", "the limit is reached after 5000 parts",
        "Weld line of thick", "moved by 2.5 mm", "Separation", "2 pieces", "First crack", "punch at 3.5 mm",
    ):  # fmt: skip
        assert text in words, text
    page.tab.get_by_role("button", name="First crack").click()
    page.settle()
    assert 0 < page.ask("() => presswork.store.state.step") < len(upset.times) - 1
    page.close()
