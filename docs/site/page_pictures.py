# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of the browser's pages in README and guide anew, in Chromium: `python -m docs.site.page_pictures`.

Runs the examples square_cup and flat_bar first (a minute or two), or takes them from a folder that holds them:
`python -m docs.site.page_pictures FOLDER`. It needs Chromium and Playwright.
"""

from __future__ import annotations

import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

from presswork import read_case, run
from presswork.examples import copy_example
from presswork.server.http import Server
from presswork.server.site import Site
from tests.regression.browser import Tab, chromium

IMAGES = Path(__file__).parents[1] / "img"
STARTER, CUP, BAR = "cylindrical_cup", "square_cup", "flat_bar"
WIDTH, HEIGHT = 1280, 800


def compute(root: Path, site: Site) -> None:
    """Run what is not there yet."""
    if not (root / f"{STARTER}.toml").is_file():
        site.drafts.create(STARTER, STARTER)
    for name in (CUP, BAR):
        if not (root / f"{name}.toml").is_file():
            copy_example(name, root)
        if not (root / name / "summary.json").is_file():
            run(read_case(root / f"{name}.toml"), root / name)


def shoot(browser: Any, address: str, name: str, *, height: int = HEIGHT, **choices: str) -> None:
    """Open a page, choose in its lists, and write its picture."""
    page = Tab(browser, address, WIDTH, height)
    for label, value in choices.items():
        page.choose(label, value)
    if "edit" in address:
        page.tab.frame_locator("#drawing").locator("html[data-ready]").wait_for(timeout=60_000)
    page.tab.wait_for_timeout(1500)
    page.tab.screenshot(path=IMAGES / f"{name}.png")
    page.close()


def main() -> None:
    """Write the pictures."""
    with tempfile.TemporaryDirectory() as place:
        root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(place)
        site = Site(root)
        compute(root, site)
        with Server(site.answer) as server, chromium() as browser:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            at = server.address
            shoot(browser, f"{at}run?run={CUP}", "report", Field="thinning")
            shoot(browser, f"{at}new", "processes", height=960)
            shoot(browser, f"{at}edit?case={STARTER}.toml", "new_case", height=1180)
            shoot(browser, at, "runs", height=520)
            server.shutdown()
        site.close()


if __name__ == "__main__":
    main()
