# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of the browser's pages in README and guide anew, in Chromium: `python -m docs.site.page_pictures`.

Runs the examples square_cup, flat_bar, upsetting_q4 and a sweep first (a minute or two), or takes them from a folder
that holds them: `python -m docs.site.page_pictures FOLDER`. It needs Chromium and Playwright.
"""

from __future__ import annotations

import io
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from presswork import read_case, run
from presswork.examples import copy_example
from presswork.server.http import Server
from presswork.server.site import Site
from presswork.study.sweep import run_sweep
from tests.regression.browser import Tab, chromium

IMAGES = Path(__file__).parents[1] / "img"
STARTER, CUP, BAR, UPSET, SWEEP = "cylindrical_cup", "square_cup", "flat_bar", "upsetting_q4", "upsetting_sweep"
WIDTH, HEIGHT = 1280, 800
MOST_BYTES = 80_000
"""Size of a picture; it is drawn smaller until it fits."""


def compute(root: Path, site: Site) -> None:
    """Run what is not there yet."""
    if not (root / f"{STARTER}.toml").is_file():
        site.drafts.create(STARTER, STARTER)
    for name in (CUP, BAR, UPSET):
        if not (root / f"{name}.toml").is_file():
            copy_example(name, root)
        if not (root / name / "summary.json").is_file():
            run(read_case(root / f"{name}.toml"), root / name)
    if not (root / SWEEP / "table.csv").is_file():
        vary = {"stages.0.tools.punch.stroke": [5.0, 7.0, 9.0], "materials.steel.poisson": [0.2, 0.3]}
        run_sweep(root / f"{UPSET}.toml", vary, root / SWEEP, settings=["workpiece.mesh.cells=[4,4]"])


def save_small(picture: bytes, path: Path) -> None:
    """Write a PNG of 256 colours, drawn smaller until it has no more than MOST_BYTES."""
    from PIL import Image

    image = Image.open(io.BytesIO(picture)).convert("RGB")
    for scale in (1.0, 0.85, 0.7, 0.6, 0.5):
        size = (round(scale * image.width), round(scale * image.height))
        small = image.resize(size, Image.Resampling.LANCZOS) if scale < 1.0 else image
        content = io.BytesIO()
        small.quantize(256, dither=Image.Dither.NONE).save(content, "png", optimize=True)
        if content.tell() <= MOST_BYTES:
            break
    path.write_bytes(content.getvalue())


def shoot(
    browser: Any,
    address: str,
    name: str,
    act: Callable[[Tab], None] | None = None,
    *,
    height: int = HEIGHT,
    **choices: str,
) -> None:
    """Open a page, choose in its lists, act on it, and write its picture."""
    page = Tab(browser, address, WIDTH, height)
    for label, value in choices.items():
        page.choose(label, value)
    if "edit" in address:
        page.tab.frame_locator("#drawing").locator("html[data-ready]").wait_for(timeout=60_000)
    if act is not None:
        act(page)
    page.tab.wait_for_timeout(1500)
    save_small(page.tab.screenshot(), IMAGES / f"{name}.png")
    page.close()


def open_tab(name: str) -> Callable[[Tab], None]:
    """Return what opens a tab of a run's page."""
    return lambda page: page.tab.get_by_role("tab", name=name).click()


def cut_open(page: Tab) -> None:
    """Cut the part at x = 12 mm and show the field along the section."""
    open_tab("Measure")(page)
    page.choose("Across", "x")
    page.tab.get_by_label("Position of the section [mm]").fill("12")
    page.tab.keyboard.press("Tab")


def show_flow(page: Tab) -> None:
    """Show grain flow and contact stress."""
    page.press("Flow lines")
    open_tab("Contact")(page)


def show_dark(page: Tab) -> None:
    """Show the curves of a page in dark colours."""
    open_tab("Curves")(page)
    page.tab.get_by_role("button", name="Dark", exact=True).click()


def main() -> None:
    """Write the pictures."""
    with tempfile.TemporaryDirectory() as place:
        root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(place)
        site = Site(root)
        compute(root, site)
        with Server(site.answer) as server, chromium() as browser:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            at = server.address
            cup = f"{at}run?run={CUP}"
            shoot(browser, cup, "report", Field="thinning")
            shoot(browser, cup, "page_sheet", open_tab("Sheet"), height=1180, Field="thickness_strain")
            shoot(browser, cup, "page_limit", open_tab("Forming limit"), Field="forming_limit_margin_polar")
            shoot(browser, cup, "page_measure", cut_open, Field="equivalent_plastic_strain")
            shoot(browser, cup, "page_dark", show_dark, Field="thinning")
            shoot(browser, f"{at}run?run={UPSET}", "page_section", show_flow, Field="equivalent_plastic_strain")
            shoot(browser, f"{at}sweep?sweep={SWEEP}", "page_sweep", height=1000)
            shoot(browser, f"{at}new", "processes", height=960)
            shoot(browser, f"{at}edit?case={STARTER}.toml", "new_case", height=1180)
            shoot(browser, at, "runs", height=620)
            server.shutdown()
        site.close()


if __name__ == "__main__":
    main()
