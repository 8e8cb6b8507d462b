# SPDX-License-Identifier: Apache-2.0
"""Pictures of energies and reactions say of which part of the whole they are."""

from __future__ import annotations

from typing import Any

import pytest

from presswork import Result
from presswork.report.history import pack_history
from presswork.report.pack import Blocks
from presswork.view.plots.history_plot import plot_energies, plot_history
from presswork.view.style import name_part
from tests.regression.test_sweep_kinds import STRIP
from tests.regression.whole_runs import run_stamping

PARTS = {"of the quarter computed": ["x", "y"], "of the half computed": ["x"], "": []}


@pytest.fixture(scope="module", params=PARTS, ids=["quarter", "half", "whole"])
def strip(request: Any, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Result]:
    """A strip that is pulled, computed as a whole and in parts; its right end is moved."""
    data = {**STRIP, "procedure": "implicit", "blank": {**STRIP["blank"], "symmetry": PARTS[request.param]}}
    data["boundary"] = {**STRIP["boundary"], "left": {"set": "left", "fix": ["x"]}}
    if "x" in PARTS[request.param]:
        del data["boundary"]["left"]
    if "y" not in PARTS[request.param]:
        data["boundary"]["middle"] = {"set": "right", "fix": ["y"]}
    return request.param, run_stamping(data, tmp_path_factory.mktemp("strip") / "out")


def test_energies_say_of_which_part_they_are(strip) -> None:
    part, result = strip
    assert plot_energies(result).get_ylabel() == (f"energy {part} [J]" if part else "energy [J]")


def test_reactions_say_of_which_part_they_are_and_others_do_not(strip) -> None:
    part, result = strip
    label = plot_history(result, y="right.force_x").get_ylabel()
    assert label == f"right force x{' ' if part else ''}{part} [kN]"
    assert plot_history(result, x="time", y="iterations").get_ylabel() == "iterations"


def test_curves_of_the_page_say_of_which_part_they_are(strip) -> None:
    part, result = strip
    labels = {c["name"]: c["label"] for c in pack_history(result, Blocks())["columns"]}
    end = f" {part}" if part else ""
    assert labels["plastic_work"] == f"plastic work{end}"
    assert labels["right.force_x"] == f"right force x{end}"
    assert labels["right.displacement_x"] == "right displacement x"


def test_the_half_has_twice_the_work_of_the_quarter(tmp_path) -> None:
    """As the labels say: pulled by 2 mm from a fixed end it is strained as its half is by 1 mm."""
    work = []
    for planes in ("xy", "y"):
        data = {**STRIP, "procedure": "implicit", "blank": {**STRIP["blank"], "symmetry": list(planes)}}
        if planes == "y":
            data["boundary"] = {**STRIP["boundary"], "left": {"set": "left", "fix": ["x"]}}
            pull = {"set": "right", "component": "x", "value": 2}
            data["stages"] = [{**STRIP["stages"][0], "displacement": [pull]}]
        result = run_stamping(data, tmp_path / planes)
        assert name_part(result) == {"xy": "of the quarter computed", "y": "of the half computed"}[planes]
        work.append(float(result.history["external_work"][-1]))
    assert work[1] == pytest.approx(2.0 * work[0], rel=1e-3)
