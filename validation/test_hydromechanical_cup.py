# SPDX-License-Identifier: Apache-2.0
"""The example `hydromechanical_cup`, and the same tools without water: one is drawn, the other one tears.

`pytest -n0 -s -m validation validation/test_hydromechanical_cup.py` prints the figures of
docs/verification/sealed_fluid.md.
"""

from __future__ import annotations

import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from presswork import StampingCase, build_model
from presswork.recorder import Outcome, run_model

pytestmark = pytest.mark.validation


def read_example() -> dict[str, Any]:
    return tomllib.loads((files("presswork") / "examples" / "hydromechanical_cup.toml").read_text("utf-8"))


def draw(data: dict[str, Any], folder: Path) -> tuple[Outcome, float]:
    """Return how a run ended, and its largest thinning [%]."""
    outcome = run_model(build_model(StampingCase.model_validate(data)), folder, threads=1)
    return outcome, float(outcome.result.history["max_thinning_percent"][-1])


def test_a_cup_of_ratio_2_6_is_drawn_with_counter_pressure_and_tears_without(tmp_path: Path) -> None:
    water, thinning = draw(read_example(), tmp_path / "water")
    plain = read_example()
    plain["stages"][0]["tools"]["holder"]["force"] = "50 kN"
    del plain["pressure"], plain["stages"][0]["pressure"]
    dry, torn = draw(plain, tmp_path / "plain")
    print(f"with water {thinning:.1f} %, without {torn:.1f} % ({dry.status})")
    assert water.status == "completed"
    assert thinning < 30.0
    assert dry.status == "gave_up"
    assert torn > 69.0
