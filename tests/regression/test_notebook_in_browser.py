# SPDX-License-Identifier: Apache-2.0
"""Results and cases in a notebook, in a real browser: the page draws in its frame, which may do nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from presswork import Case, run
from presswork.case.case_file import CaseFile
from presswork.examples import copy_example
from presswork.results import Result
from tests.regression.browser import chromium


def test_result_and_case_draw_themselves(tmp_path: Path) -> None:
    path = copy_example("upsetting_q4", tmp_path)
    settings = ["workpiece.mesh.cells=[4,4]", "output.steps=2", 'title="a <b>title</b>"']
    case = Case.from_toml(path, overrides=settings)
    result = run(case, tmp_path / "out").result
    with chromium() as browser:
        for shown, height in ((result, 640), (case, 420)):
            tab = browser.new_page(viewport={"width": 1000, "height": 900})
            errors: list[str] = []
            tab.on("pageerror", lambda error, errors=errors: errors.append(str(error)))
            tab.set_content(f"<!doctype html><html><body>{shown._repr_html_()}</body></html>")
            frame = tab.frame_locator("iframe")
            frame.locator("html[data-ready]").wait_for(timeout=60_000)
            assert frame.locator("#canvas").bounding_box()["height"] > 0.4 * height
            assert tab.locator("iframe").get_attribute("title") == "a <b>title</b>"
            assert not errors
            tab.close()


def test_case_that_cannot_be_computed_says_why(tmp_path: Path) -> None:
    case: CaseFile = Case.from_toml(copy_example("upsetting_q4", tmp_path), overrides=["workpiece.material=<i>"])
    assert "&lt;i&gt;" in case._repr_html_()


def test_results_that_cannot_be_read_say_why(tmp_path: Path) -> None:
    (tmp_path / "results.vtkhdf").write_bytes(b"<script>")
    assert "<pre>" in Result(tmp_path)._repr_html_()


@pytest.mark.parametrize("name", ["upsetting_q4", "square_cup"])
def test_showing_a_case_leaves_no_file(tmp_path: Path, name: str) -> None:
    from presswork import read_case

    path = copy_example(name, tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert "<iframe" in read_case(path)._repr_html_()
    assert sorted(tmp_path.rglob("*")) == before
