# SPDX-License-Identifier: Apache-2.0
"""A real browser for pages: the system's Chromium, driven by Playwright, drawing without a GPU."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.report import write_report
from presswork.results import Result
from presswork.server.http import Server
from presswork.server.site import Site

ATTACK = "</script><script>document.title = 'taken'</script>"
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


# Fixtures; a module of tests takes them up by names of its own: browser = share_browser.


@pytest.fixture(scope="module")
def share_browser() -> Iterator[Any]:
    """Return a browser for the tests of a module."""
    with chromium() as found:
        yield found


@pytest.fixture
def serve_folder(tmp_path: Path) -> Iterator[Server]:
    """Return a server on a test's own folder."""
    site = Site(tmp_path)
    with Server(site.answer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()
    site.close()


@pytest.fixture(scope="module")
def share_upset(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """Return a cylinder upset by 60 %, with a title that would be a script."""
    folder = tmp_path_factory.mktemp("upset")
    case = Case.from_toml(copy_example("upsetting_q4", folder), overrides=["workpiece.mesh.cells=[8,8]"])
    return run(case.model_copy(update={"title": f"Upsetting {ATTACK}"}), folder / "out").result


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


class Person:
    """Someone who works with mouse and keyboard; counts clicks and keys, of a file's dialog two clicks."""

    def __init__(self, page: Tab) -> None:
        self.page = page
        self.clicks = 0
        self.typed = 0

    def press(self, name: str) -> None:
        """Press a button."""
        self.page.tab.get_by_role("button", name=name).first.click()
        self.clicks += 1

    def type(self, key: str, text: str) -> None:
        """Click into a field of the editor and type."""
        field = self.page.tab.locator(f'[data-key="{key}"]')
        field.click()
        field.fill(text)
        self.clicks += 1
        self.typed += len(text)

    def key(self, *keys: str) -> None:
        """Press keys, or type words into what has the focus."""
        for key in keys:
            is_one = key in ("Tab", "Enter", "Escape", "Space") or "+" in key
            self.page.tab.keyboard.press(key) if is_one else self.page.tab.keyboard.type(key)
            self.typed += 1 if is_one else len(key)

    def choose_file(self, name: str, path: Path) -> None:
        """Press a button that asks for a file, and choose one."""
        with self.page.tab.expect_file_chooser() as asked:
            self.press(name)
        asked.value.set_files(path)
        self.clicks += 1

    def wait(self) -> None:
        """Wait until the case is checked."""
        self.page.tab.wait_for_timeout(100)
        self.page.tab.wait_for_selector('html[data-checking="false"]', timeout=60_000)


class Page(Tab):
    """A page that is opened from a file."""

    def __init__(self, browser: Any, path: Path, width: int = 1280, height: int = 800) -> None:
        super().__init__(browser, path.as_uri(), width, height)


@pytest.fixture
def open_report(browser: Any, upset: Result) -> Iterator[Page]:
    """Return the page of the module's run; it must ask for nothing but itself, and show no error."""
    opened = Page(browser, write_report(upset))
    yield opened
    assert not [address for address in opened.addresses if not address.startswith(("file:", "blob:", "data:"))]
    opened.close()
