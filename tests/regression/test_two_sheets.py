# SPDX-License-Identifier: Apache-2.0
"""Two sheets that lie on each other in one blank, touch and both deform."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import CaseError, StampingCase, build_model
from presswork.post import cut_sheet
from presswork.post.section import find_breaks
from tests.regression.whole_runs import run_stamping

LENGTH, WIDTH, THICKNESS, YOUNG, DOWN = 40.0, 4.0, 0.8, 206e3, 0.4
ALONG, ACROSS = 20, 2


def write_strips(path: Path, heights: list[float]) -> Path:
    """Write strips along x, one over the other; the set `tip` is the end of the last."""
    nodes, cells, first = ["*NODE"], ["*ELEMENT, TYPE=S4, ELSET=all"], 1
    for height in heights:
        for i in range(ALONG + 1):
            for j in range(ACROSS + 1):
                number = first + i * (ACROSS + 1) + j
                nodes.append(f"{number}, {i * LENGTH / ALONG}, {j * WIDTH / ACROSS}, {height}")
                if i < ALONG and j < ACROSS:
                    after = number + ACROSS + 1
                    cells.append(f"{len(cells)}, {number}, {after}, {after + 1}, {number + 1}")
        first += (ALONG + 1) * (ACROSS + 1)
    tip = ", ".join(str(first - 1 - j) for j in range(ACROSS + 1))
    path.write_text("\n".join([*nodes, *cells, "*NSET, NSET=tip", tip, ""]))
    return path


def make_case(path: Path, procedure: str, **changes: Any) -> dict[str, Any]:
    """Clamped at x = 0, the upper strip's end is moved down."""
    return {
        "title": "strips", "analysis": "stamping", "procedure": procedure,
        "blank": {"shape": "file", "path": str(path), "thickness": THICKNESS, "material": "spring_steel"},
        "materials": {"spring_steel": {"young": YOUNG, "poisson": 0.3,
                                       "hardening": {"law": "linear", "yield_stress": 1500, "modulus": 100}}},
        "tools": {}, "boundary": {"clamp": {"set": "left", "hold": "clamped"}}, "self_contact": {"mu": 0.0},
        "stages": [{"name": "press", "displacement": [{"set": "tip", "component": "z", "value": -DOWN}],
                    "duration": 1 if procedure == "implicit" else "20 ms"}],
        "output": {"steps": 1, "rows": 20}, **changes,
    }  # fmt: skip


def run(folder: Path, procedure: str, heights: list[float], **changes: Any) -> Result:
    path = write_strips(folder / "strips.inp", heights)
    return run_stamping(make_case(path, procedure, **changes), folder / procedure)


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_two_strips_on_each_other_take_twice_the_force_of_one(tmp_path: Path, procedure: str) -> None:
    """Bernoulli's cantilevers without friction: each takes 3 E I w/L^3, whatever lies on it."""
    each = 3.0 * YOUNG * WIDTH * THICKNESS**3 / 12.0 * DOWN / LENGTH**3
    two = run(tmp_path, procedure, [-0.5 * THICKNESS, 0.5 * THICKNESS])
    assert -two.history["tip.force_z"][-1] == pytest.approx(2.0 * each, rel=0.015)
    z = two.points(-1)[:, 2].reshape(2, ALONG + 1, ACROSS + 1)
    np.testing.assert_allclose(z[1, -1] - z[0, -1], THICKNESS, atol=0.01 * THICKNESS)
    line = cut_sheet(two, 0.01).line
    assert find_breaks(line).tolist() == [ALONG]  # the lower strip, then the upper


def test_both_sheets_are_held_as_they_spring_back(tmp_path: Path) -> None:
    """What was bent elastically is straight again; each strip is held near its middle, where it was pressed to."""
    free = run(tmp_path, "implicit", [-0.5 * THICKNESS, 0.5 * THICKNESS], springback={})
    z = free.points(-1)[:, 2].reshape(2, ALONG + 1, ACROSS + 1)
    for strip in z:
        bend = strip[0] - 2.0 * strip[ALONG // 2] + strip[-1]
        np.testing.assert_allclose(bend, 0.0, atol=0.01 * DOWN)


def test_sheets_without_contact_are_refused(tmp_path: Path) -> None:
    path = write_strips(tmp_path / "strips.inp", [0.0, 0.8])
    case = make_case(path, "explicit")
    del case["self_contact"]
    with pytest.raises(CaseError, match=r"2 parts that share no node .*\[self_contact\]"):
        build_model(StampingCase.model_validate(case))
    line = {"shape": "circle", "diameter": 50}
    with pytest.raises(CaseError, match="trim: a blank of several sheets that lie on each other is not trimmed"):
        build_model(StampingCase.model_validate(make_case(path, "explicit", trim={"line": line})))
