# SPDX-License-Identifier: Apache-2.0
"""A fluid under a flat blank that a holder presses on a die, and what leaks off it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.regression.whole_runs import run_stamping

FORCE, DIAMETER = 20e3, 90.0
"""Of the holder on the whole blank [N], and of the blank [mm]."""


def make_case() -> dict[str, Any]:
    tool = {"shape": "round", "diameter": 50, "edge_radius": 5, "mu": 0.1}
    holder = {"holder": {"force": FORCE}}
    return {
        "title": "leak",
        "analysis": "stamping",
        "procedure": "implicit",
        "blank": {
            "shape": "circle", "diameter": DIAMETER, "thickness": 3, "element_size": 5, "material": "dc04",
            "symmetry": ["x", "y"],
        },
        "tools": {"die": {"kind": "die", **tool}, "holder": {"kind": "holder", **tool}},
        "pressure": {"water": {"face": "bottom", "inside": {"shape": "circle", "diameter": 40}, "seal": "tools"}},
        "stages": [
            {"name": "close", "duration": 0.01, "tools": holder},
            {"name": "press", "duration": 0.01, "tools": holder, "pressure": {"water": {"p": 6.0}}},
        ],
        "output": {"steps": 1},
    }  # fmt: skip


def test_a_fluid_leaks_where_it_carries_the_holder(tmp_path: Path) -> None:
    """It keeps its pressure until the ring that is left presses no more: p times the wet area and the force of the die
    are the holder's; p lies below force over area, and within 15 % of it, whatever is given beyond.
    """
    run = run_stamping(make_case(), tmp_path / "out")
    p, leak, die = (run.history[f"{name}"] for name in ("pressure.water.p", "pressure.water.leak", "die.force"))
    most = FORCE / (0.25 * np.pi * DIAMETER**2)
    tight = run.history["time"] < 0.0145
    assert leak[tight].max() < 1e-3
    assert p[tight].max() > 2.5
    assert 0.85 * most < p[-1] < most
    assert p[-1] == pytest.approx(p[-10], rel=0.02), "the leak does not flicker"
    assert p[-1] + leak[-1] == pytest.approx(6.0)
    wet = (FORCE - die[-1]) / p[-1]
    assert 0.6 < wet / (0.25 * np.pi * DIAMETER**2) < 1.0
    assert any("leaks over the flange" in text for text in run.summary["warnings"])
