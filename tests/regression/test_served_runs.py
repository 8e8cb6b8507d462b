# SPDX-License-Identifier: Apache-2.0
"""Runs of a folder in a real browser: the list, a run that computes, stopped and let go on, sweeps."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.results import Result
from presswork.server.http import Server
from presswork.server.site import Site
from presswork.study.sweep import run_sweep
from tests.regression.browser import Tab, share_browser

browser = share_browser

ATTACK = "</script><img src=x onerror=\"document.title='taken'\"><script>document.title = 'taken'</script>"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an upsetting whose title would be a script, and its finer sister."""
    root = tmp_path_factory.mktemp("opened")
    path = copy_example("upsetting_q4", root)
    for name, cells in (("coarse", "[6,6]"), ("fine", "[8,8]")):
        case = Case.from_toml(path, overrides=[f"workpiece.mesh.cells={cells}", "output.steps=8"])
        run(case.model_copy(update={"title": f"{name} {ATTACK}"}), root / name)
    return root


@pytest.fixture
def site(folder: Path) -> Iterator[Server]:
    site = Site(folder)
    with Server(site.answer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()
    site.close()


def ask(server: Server, address: str, method: str = "GET") -> Any:
    request = urllib.request.Request(server.address + address, method=method, data=b"" if method == "POST" else None)
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)


def wait_for(server: Server, name: str, *words: str, seconds: float = 120) -> dict[str, Any]:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        state: dict[str, Any] = ask(server, f"state?run={name}")
        if state["word"] in words:
            return state
        time.sleep(0.1)
    raise AssertionError(f"{name} is {state}, not {words}")


def wait_until_still(path: Path, still: float = 2.0, seconds: float = 60.0) -> int:
    """Return the size of a file once it has stayed the same: a run notices a pause at its next increment."""
    end = time.monotonic() + seconds
    size, since = path.stat().st_size, time.monotonic()
    while time.monotonic() - since < still:
        assert time.monotonic() < end, f"{path.name} still grows after {seconds:g} s"
        time.sleep(0.1)
        if (now := path.stat().st_size) != size:
            size, since = now, time.monotonic()
    return size


def test_list_shows_all_runs_and_sorts_them(browser: Any, site: Server) -> None:
    page = Tab(browser, site.address)
    names = page.tab.locator("#runs tbody tr td:nth-child(3)")
    assert set(names.all_inner_texts()) == {"coarse", "fine"}
    assert ATTACK in page.tab.locator("#runs").inner_text()
    page.tab.get_by_role("button", name="Run", exact=True).click()
    assert names.all_inner_texts() == ["coarse", "fine"]
    page.tab.get_by_role("button", name="Run ▲").click()
    assert names.all_inner_texts() == ["fine", "coarse"]
    page.tab.get_by_label("Search").fill("coarse")
    assert names.all_inner_texts() == ["coarse"]
    assert page.tab.title() != "taken"
    page.close()


def test_chosen_runs_are_compared(browser: Any, site: Server) -> None:
    page = Tab(browser, site.address)
    for name in ("coarse", "fine"):
        page.tab.get_by_label(f"Compare {name}").check()
    page.tab.get_by_role("button", name="Compare chosen runs").click()
    page.wait_until_drawn()
    assert page.ask("() => presswork.stage.viewer.views.length") == 2
    assert ATTACK in page.tab.locator("h1").inner_text()
    assert "taken" not in page.tab.title().split(ATTACK)
    page.close()


def test_served_page_shows_the_values_of_the_results(browser: Any, site: Server, folder: Path) -> None:
    result = Result(folder / "coarse")
    page = Tab(browser, f"{site.address}run?run=coarse")
    page.wait_until_drawn()
    step = len(result.times) - 1
    for name in ("effective_stress", "stress_xy", "contact_pressure"):
        script = "async ([step, name]) => [...await presswork.runs[0].values(step, presswork.runs[0].findField(name))]"
        values = result.scalar(name, step)
        np.testing.assert_allclose(page.ask(script, [step, name]), values, atol=2e-5 * np.ptp(values))
    page.choose("Range", "all")
    every = [result.field("effective_stress", i) for i in range(len(result.times))]
    scale = page.ask("() => presswork.stage.legend.full")
    np.testing.assert_allclose(scale, [np.min(every), np.max(every)], rtol=1e-6)
    page.close()


def test_run_is_followed_stopped_and_goes_on_to_the_same_bits(browser: Any, site: Server, folder: Path) -> None:
    """Begun by the program in a process of its own, as from a terminal; steered from the page alone."""
    name = begin_long_run(folder, "long")
    wait_for(site, name, "running")
    end = time.monotonic() + 60
    while not (folder / name / "results.vtkhdf").is_file() and time.monotonic() < end:
        time.sleep(0.05)
    page = Tab(browser, f"{site.address}run?run={name}")
    rows, steps = "() => presswork.runs[0].curves.columns[0].values.n", "() => presswork.runs[0].steps.length"
    page.tab.wait_for_function("() => (presswork.runs[0].curves.columns[0]?.values.n ?? 0) > 3", timeout=60_000)
    page.tab.get_by_role("tab", name="Curves").click()
    chosen = "() => document.querySelector('#panel select').selectedOptions[0].textContent.includes('force')"
    page.tab.wait_for_function(chosen, timeout=20_000)
    page.tab.get_by_role("button", name="Hold the computation", exact=False).click()
    wait_for(site, name, "paused")
    held = wait_until_still(folder / name / "history.csv")
    time.sleep(1.0)
    assert (folder / name / "history.csv").stat().st_size == held
    assert ask(site, f"state?run={name}")["word"] == "paused", "the run has not ended"
    page.tab.get_by_role("button", name="Go on from", exact=False).click()
    wait_for(site, name, "running")
    before = page.ask(rows), page.ask(steps)
    page.tab.wait_for_function(f"() => presswork.runs[0].curves.columns[0].values.n > {before[0]}", timeout=60_000)
    page.tab.wait_for_function(f"() => presswork.runs[0].steps.length > {before[1]}", timeout=60_000)
    assert page.ask("() => presswork.store.state.step") == page.ask(steps) - 1, "the latest shape is shown"
    page.tab.get_by_role("button", name="Stop after this increment", exact=False).click()
    state = wait_for(site, name, "interrupted")
    assert 0.0 < state["fraction"] < 1.0
    assert state["can"] == ["resume"]
    page.tab.get_by_role("button", name="Go on from", exact=False).click()
    wait_for(site, name, "completed")
    page.tab.wait_for_function("() => presswork.runs[0].summary.status === 'completed'", timeout=60_000)
    page.tab.get_by_role("tab", name="Result").click()
    page.tab.wait_for_selector(".verdict.ok", timeout=20_000)
    page.close()
    whole = run(Case.from_toml(folder / name / "case.toml"), folder / "whole").result
    history = (folder / name / "history.csv").read_text(), (folder / "whole" / "history.csv").read_text()
    assert history[0] == history[1]
    np.testing.assert_array_equal(Result(folder / name).field("stress"), whole.field("stress"))
    shutil.rmtree(folder / "whole")


def begin_long_run(folder: Path, name: str) -> str:
    """Run the upsetting in small increments, which takes some seconds, and return its name."""
    settings = ["workpiece.mesh.cells=[6,6]", "output.steps=40", "solver.max_increment=0.001"]
    options = [word for setting in settings for word in ("--set", setting)]
    command = [sys.executable, "-c", "from presswork.cli import main; main()", "run", str(folder / "upsetting_q4.toml")]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    command += ["--output", str(folder / name), "--quiet", "--no-plot", "--no-report", "--threads", "1", *options]
    subprocess.Popen(command, env=environment, start_new_session=True)
    return name


@pytest.mark.validation
def test_each_member_of_a_sweep_is_a_click_from_its_part(browser: Any, site: Server, folder: Path) -> None:
    vary = {"stages.0.tools.punch.stroke": [2.0, 4.0, 6.0]}
    case = folder / "upsetting_q4.toml"
    run_sweep(case, vary, folder / "sweep", settings=["workpiece.mesh.cells=[4,4]", "output.steps=2"], jobs=1)
    page = Tab(browser, site.address)
    members = page.tab.locator("#runs a[href*='member_']:not([tabindex])")
    assert members.count() == 0, "members of a sweep do not flood the list"
    page.tab.get_by_label("Members of sweeps").check()
    assert members.count() == 3
    page.tab.get_by_role("link", name="sweep", exact=True).click()
    page.wait_until_drawn()
    assert page.tab.locator("#members tbody tr").count() == 3
    page.tab.get_by_role("link", name="member_001").click()
    page.wait_until_drawn()
    assert page.ask("() => presswork.runs[0].name") == "member_001"
    page.tab.go_back()
    page.wait_until_drawn()
    table = ask(site, "table?sweep=sweep")
    assert [row[1] for row in table["rows"]] == [2.0, 4.0, 6.0]
    names = page.tab.locator("#curves .key li").all_inner_texts()
    assert names == [f"punch stroke {stroke} mm" for stroke in (2, 4, 6)]
    drawn = page.ask("() => presswork.curves.series.map(({ x, y }) => [x.at(-1), y.at(-1)])")
    for (stroke, force), number in zip(drawn, range(3), strict=True):
        history = Result(folder / "sweep" / f"member_00{number}").history
        assert [stroke, force] == pytest.approx([history["punch.stroke"][-1], 1e-3 * history["punch.force"][-1]])
    script = "({ series: [{ x, y }], plot }) => [plot.valToPos(x[2], 'x'), plot.valToPos(y[2], 'y')]"
    x, y = page.ask(f"() => ({script})(presswork.chart)")
    page.tab.locator("#scatter .u-over").click(position={"x": x, "y": y})
    page.tab.wait_for_url("**/run?*")
    page.wait_until_drawn()
    assert page.ask("() => presswork.runs[0].name") == "member_002"
    page.tab.go_back()
    page.wait_until_drawn()
    place = "({ series: [, { x, y }], plot }) => [plot.valToPos(x.at(-1), 'x'), plot.valToPos(y.at(-1), 'y')]"
    x, y = page.ask(f"() => ({place})(presswork.curves)")
    page.tab.locator("#curves .u-over").click(position={"x": x, "y": y})
    page.tab.wait_for_url("**/run?*")
    page.wait_until_drawn()
    assert page.ask("() => presswork.runs[0].name") in ("member_001", "member_002"), "both curves pass there"
    page.close()
