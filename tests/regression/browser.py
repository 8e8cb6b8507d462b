# SPDX-License-Identifier: Apache-2.0
"""A real browser for pages: the system's Chromium, driven by Playwright, drawing without a GPU."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@contextmanager
def chromium() -> Iterator[Any]:
    """Start a browser; skip the test with a message where there is none."""
    sync_api = pytest.importorskip("playwright.sync_api", reason='no Playwright: pip install "presswork[test]"')
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        pytest.skip("no Chromium is installed (Debian: apt-get install chromium); pages are not tried in a browser")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=OPTIONS)
        try:
            yield browser
        finally:
            browser.close()


class Tab:
    """A page that is open; every error in it and every address that it asks for is noted."""

    def __init__(self, browser: Any, address: str, width: int = 1280, height: int = 800) -> None:
        self.tab = browser.new_page(viewport={"width": width, "height": height})
        self.errors: list[str] = []
        self.addresses: list[str] = []
        self.tab.on("console", lambda message: message.type == "error" and self.errors.append(message.text))
        self.tab.on("pageerror", lambda error: self.errors.append(str(error)))
        self.tab.on("request", lambda request: self.addresses.append(request.url))
        self.tab.goto(address)
        self.wait_until_drawn()

    def wait_until_drawn(self) -> None:
        """Wait until the page that is open shows what it is for."""
        self.tab.wait_for_load_state()
        self.tab.wait_for_selector("html[data-ready]", timeout=60_000)

    def close(self) -> None:
        """Close the page; it must have shown no error."""
        assert not self.errors, self.errors
        self.tab.close()

    def ask(self, script: str, argument: Any = None) -> Any:
        """Return what a function of JavaScript returns in the page."""
        return self.tab.evaluate(script, argument)

    def settle(self) -> None:
        """Wait until what was asked for is drawn."""
        self.tab.wait_for_timeout(50)
        self.ask("async () => { while (presswork.stage.isBusy) await new Promise((done) => setTimeout(done, 10)); }")

    def choose(self, label: str, value: str) -> None:
        """Choose in a list by its label."""
        self.tab.get_by_label(label, exact=True).first.select_option(value)
        self.settle()

    def press(self, name: str) -> None:
        """Press a button by its name."""
        self.tab.get_by_role("button", name=name, exact=True).first.click()
        self.settle()


class Page(Tab):
    """A page that is opened from a file."""

    def __init__(self, browser: Any, path: Path, width: int = 1280, height: int = 800) -> None:
        super().__init__(browser, path.as_uri(), width, height)
