# SPDX-License-Identifier: Apache-2.0
"""An observer of one's own, written here alone: it measures how high the workpiece stands, by both procedures."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from presswork import build_model, run_model
from presswork.case import Case
from presswork.model import Model
from presswork.observe.contract import History, Observed, Observer, Row
from presswork.process.begin import begin
from tests.consistency.test_added_procedure import BLOCK

PRESSED = 0.1


class Height(Observer):
    """The height of the workpiece, and how often it was measured."""

    def __init__(self) -> None:
        self.times = np.zeros(1)

    def columns(self, run: Observed) -> list[str]:
        return ["height"]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        self.times += 1.0
        return {"height": float(np.ptp(run.positions()[:, 1]))}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        return {"height": {"least_mm": float(history["height"].min()), "measured": int(self.times[0])}}

    def warnings(self, run: Observed, history: History) -> list[str]:
        return ["the workpiece is low"] if history["height"][-1] < 4.95 else []

    def arrays(self) -> dict[str, NDArray[Any]]:
        return {"height.times": self.times}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.times = arrays["height.times"].copy()


def observed(model: Model, threads: int) -> Any:
    recording = begin(model, threads)
    recording.observers.add(Height())  # type: ignore[attr-defined]
    return recording


def make_model(procedure: str) -> Model:
    case = copy.deepcopy(BLOCK) | {"procedure": procedure}
    if procedure == "explicit":
        case["workpiece"]["element"] = "quad4_1pt"
        case["materials"]["steel"]["density"] = "7850 kg/m^3"
        case["stages"][0]["duration"] = "200 us"
        case["output"] = {"rows": 4, "steps": 1}
    return build_model(Case(**case))


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_an_observer_added_from_outside_has_columns_summary_warnings_and_a_checkpoint(
    procedure: str, tmp_path: Path
) -> None:
    """The top goes down by 0.1 of 5 mm, so the height is 4.9 mm at the end, whatever forms it."""
    model = make_model(procedure)
    whole = run_model(model, tmp_path / "whole", procedure=observed).result
    assert whole.history["height"][-1] == pytest.approx(5.0 - PRESSED, rel=1e-9)
    rows = len(whole.history["time"])
    assert whole.summary["height"] == {"least_mm": whole.history["height"][-1], "measured": rows}
    assert "the workpiece is low" in whole.summary["warnings"]

    def stop(now: Any) -> None:
        raise KeyboardInterrupt

    assert run_model(model, tmp_path / "out", procedure=observed, on_increment=stop).status == "interrupted"
    resumed = run_model(model, tmp_path / "out", procedure=observed, resume=True).result
    assert resumed.summary["height"] == whole.summary["height"], "what it keeps goes through the checkpoint"
