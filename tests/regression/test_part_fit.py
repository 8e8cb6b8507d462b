# SPDX-License-Identifier: Apache-2.0
"""A part that does not fit the tools of its next operation is told of before that operation is computed."""

from __future__ import annotations

import copy
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from presswork.case import StampingCase, build_model
from presswork.recorder import Outcome, run_model

EXAMPLE = tomllib.loads((files("presswork.examples") / "restruck_channel.toml").read_text())
TOOLS = ("punch", "die", "holder")


def strike(folder: Path, changes: dict[str, Any] | None = None, **place: Any) -> Outcome:
    """Draw the example's hat channel 50 mm wide with a coarse mesh, and lay it into a second operation.

    changes: keys of the case by their dots, within the second operation, or beginning with "case." at its top.
    """
    case = copy.deepcopy(EXAMPLE)
    case["blank"] |= {"element_size": [2.5, 10.0], "points": 5}
    case["output"] = {"steps": 1, "rows": 4}
    case["operations"][0]["stages"][0]["tools"]["holder"]["force"] = "4 kN"
    second = case["operations"][1]
    del second["springback"]
    second["place"] = {"tip": True, **place}
    for keys, value in (changes or {}).items():
        at: Any = case if keys.startswith("case.") else second
        *path, last = keys.removeprefix("case.").split(".")
        for key in path:
            at = at[int(key)] if isinstance(at, list) else at.setdefault(key, {})
        at[last] = value
    return run_model(build_model(StampingCase.model_validate(case)), folder, threads=1)


def widths(by: float) -> dict[str, Any]:
    """Tools all wider by this [mm] than those that the part was drawn with."""
    drawn = EXAMPLE["operations"][0]["tools"]
    return {f"tools.{name}.width": drawn[name]["width"] + by for name in TOOLS}


RADII = {"tools.die.edge_radius": 3, "tools.punch.edge_radius": 3, "tools.die.bottom_radius": 3}


@pytest.mark.parametrize("changes", [{}, RADII])
def test_a_part_that_is_struck_again_by_tools_of_smaller_radii_fits(tmp_path, changes) -> None:
    """Though its walls spring open by centimetres, so that it stands far above the die."""
    outcome = strike(tmp_path / "out", changes)
    assert outcome.status == "completed"
    assert "does not fit" not in " ".join(outcome.result.summary["warnings"])


def test_tools_wider_than_the_part_are_told_of_with_half_the_difference(tmp_path) -> None:
    """All are wider by 7 mm: walls lie 3.5 mm beside them, as formed, and go on; the warning stays in the summary."""
    outcome = strike(tmp_path / "out", widths(7.0))
    assert outcome.status == "completed"
    (text,) = [text for text in outcome.result.summary["warnings"] if "does not fit the closed tools" in text]
    assert text.startswith("operations.restrike.stages.0.tools.punch.close: ")
    assert "mostly sideways" in text
    assert "check widths and radii of die, punch, holder" in text
    assert 3.0 < float(text.partition("sideways, by ")[2].split()[0]) < 4.0
    assert text in (tmp_path / "out" / "run.log").read_text()


@pytest.mark.parametrize(
    ("changes", "place", "told"),
    [
        (widths(27.0), {}, "of what lies between them is off them"),
        ({"tools.die.depth": 13}, {}, "mostly in height, by "),
        ({}, {"over": "x", "tip": False}, "of what lies between them is off them"),
    ],
)
def test_a_part_that_does_not_fit_at_all_ends_the_line_before_its_operation(tmp_path, changes, place, told) -> None:
    outcome = strike(tmp_path / "out", changes, **place)
    assert outcome.status == "gave_up"
    assert (
        "the operation restrike cannot begin: operations.restrike.stages.0.tools.punch.close: the part does not fit"
        in (outcome.reason)
    )
    assert told in outcome.reason
    assert "limits.stop = false" in outcome.reason
    assert not [stage for stage in outcome.result.history["stage"] if stage.startswith("restrike")]


def test_limits_that_do_not_stop_let_a_part_that_does_not_fit_run(tmp_path) -> None:
    outcome = strike(tmp_path / "out", {"tools.die.depth": 13, "case.limits.stop": False})
    assert [text for text in outcome.result.summary["warnings"] if "does not fit the closed tools" in text]
    assert "restrike_close" in outcome.result.history["stage"]


def test_tools_that_all_go_past_the_part_end_the_line_before_its_operation(tmp_path) -> None:
    """A punch whose stroke ends above the part."""
    punch = {"kind": "punch", "shape": "strip", "width": 50, "edge_radius": 4, "position": [0, 0, 40]}
    stages = [{"name": "close", "tools": {"punch": {"stroke": 5}}}]
    tools = {"die": EXAMPLE["operations"][1]["tools"]["die"], "punch": punch}
    outcome = strike(tmp_path / "out", {"tools": tools, "stages": stages})
    assert "operations.restrike.tools.punch: the punch passes the part, as every tool that moves does" in outcome.reason


def test_a_tool_that_is_pushed_from_afar_ends_the_line_before_its_operation(tmp_path) -> None:
    holder = {"kind": "holder", "shape": "strip", "width": 53, "edge_radius": 4, "position": [0, 0, 40]}
    stages = [{"name": "close", "duration": "1 ms", "tools": {"holder": {"force": "2 kN"}}}]
    tools = {"die": EXAMPLE["operations"][1]["tools"]["die"], "holder": holder}
    outcome = strike(tmp_path / "out", {"tools": tools, "stages": stages})
    assert "operations.restrike.tools.holder.position: the holder is pushed by a force, but starts " in outcome.reason
