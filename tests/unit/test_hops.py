# SPDX-License-Identifier: Apache-2.0
"""How many files a case passes from its text to its report, counted in runs.

A case has stations: its text is parsed, its model is made, tools touch the metal, the cells answer, a row is written, a
page is written; a forging that is hot and gets new meshes also has its cells smoothed, its values carried, and its heat
conducted. The files on the way to them are those of the functions at work when a station is reached, and its own, each
once.
What stands above an aim (20, hot and on new meshes 25) is a ceiling that may only come down.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import presswork.recorder
import presswork.report.write
from presswork import _core, api, model
from presswork.examples import copy_example
from presswork.implicit.heat_equation import HeatEquation
from presswork.remesh.carrier import Carrier

PACKAGE = Path(presswork.recorder.__file__).parent
CEILING, HOT_CEILING = 17, 29
FIRST = {"loads": tomllib, "__init__": model.Model}
"""Stations that count when they are first reached."""
DEEPEST = {
    "touch_profile": _core,
    "evaluate_block": _core,
    "append": presswork.recorder.History,
    "write_whole": presswork.report.write,
}
"""Stations that count where most files are passed to reach them."""
ON_NEW_MESHES = {"smooth_cells": _core, "points": Carrier, "solve": HeatEquation}


@pytest.fixture
def passed(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, list[str]]]:
    """Files by the station that they lead to."""
    found: dict[str, list[str]] = {}

    def mark(owner: Any, name: str, *, first: bool) -> None:
        inner = getattr(owner, name)
        home = [] if owner in (_core, tomllib) else _files_of(getattr(inner, "__module__", None))

        def station(*given: Any, **named: Any) -> Any:
            if name not in found or not first:
                files = list(dict.fromkeys([*_files_at_work(), *home]))
                found[name] = max(found.get(name, []), files, key=len)
            return inner(*given, **named)

        monkeypatch.setattr(owner, name, station)

    for name, owner in {**FIRST, **DEEPEST, **ON_NEW_MESHES}.items():
        mark(owner, name, first=name in FIRST)
    return found


def _files_at_work() -> Iterator[str]:
    """Yield the files of the package whose functions are at work."""
    frame = sys._getframe(1)
    while frame.f_back is not None:
        frame = frame.f_back
        path = Path(frame.f_code.co_filename)
        if path.is_relative_to(PACKAGE):
            yield str(path.relative_to(PACKAGE))


def _files_of(module: str | None) -> list[str]:
    """Return the file in which a station is itself."""
    path = Path(str(getattr(sys.modules.get(module or ""), "__file__", "")))
    return [str(path.relative_to(PACKAGE))] if path.is_relative_to(PACKAGE) else []


def follow(name: str, keys: list[str], folder: Path, passed: dict[str, list[str]]) -> set[str]:
    """Return the files that a case passes from its text to its report."""
    path = copy_example(name, folder)
    passed.clear()
    outcome = api.run(api.load(path, keys), folder / "out", threads=1)
    presswork.report.write.write_report(outcome.result, folder / "report.html")
    return {file for files in passed.values() for file in files}


def test_a_case_passes_few_files_from_its_text_to_its_report(passed: dict[str, list[str]], tmp_path: Path) -> None:
    files = follow("upsetting_q4", ["workpiece.mesh.cells=[4,4]", "stages.0.tools.punch.stroke=2"], tmp_path, passed)
    assert passed.keys() >= FIRST.keys() | DEEPEST.keys()
    assert len(files) == CEILING, f"lower the ceiling if it came down: {len(files)} {sorted(files)}"


def test_a_hot_forging_on_new_meshes_passes_few_files_more(passed: dict[str, list[str]], tmp_path: Path) -> None:
    keys = ["workpiece.mesh.cells=[4,6]", "remesh.every=0.5", "stages.0.tools.die.stroke=3", "output.steps=2"]
    files = follow("hot_upsetting", keys, tmp_path, passed)
    assert passed.keys() >= FIRST.keys() | DEEPEST.keys() | ON_NEW_MESHES.keys()
    assert len(files) == HOT_CEILING, f"lower the ceiling if it came down: {len(files)} {sorted(files)}"
