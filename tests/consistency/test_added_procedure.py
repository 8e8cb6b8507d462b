# SPDX-License-Identifier: Apache-2.0
"""A procedure of one's own, written here alone: it carries the workpiece along x without deforming it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from presswork import Result, build_model, run_model
from presswork.case import Case
from presswork.fields.instant import Instant
from presswork.fields.table import compute_fields
from presswork.model import Model
from presswork.process.model_run import ModelRun
from presswork.process.run import Snapshot
from presswork.recorder import Progress
from presswork.timing import Timing

STEPS, WAY = 8, 40.0

BLOCK: dict[str, Any] = {
    "title": "block on a belt",
    "analysis": "plane_strain",
    "workpiece": {"material": "steel", "mesh": {"kind": "rectangle", "size": [10.0, 5.0], "cells": [2, 1]}},
    "materials": {
        "steel": {
            "young": 200000.0,
            "poisson": 0.3,
            "hardening": {"law": "linear", "yield_stress": 400.0, "modulus": 1000.0},
        }
    },
    "boundary": {"all": {"set": "bottom", "fix": ["x", "y"]}},
    "stages": [{"name": "carry", "duration": 2.0, "displacement": [{"set": "top", "component": "y", "value": -0.1}]}],
}


@dataclass(frozen=True)
class Step:
    number: int
    is_save_point: bool = True


class Conveyor(ModelRun):
    """Moves all nodes by WAY [mm] in STEPS equal steps."""

    def __init__(self, model: Model, threads: int) -> None:
        super().__init__(model)
        self.timing = Timing("moving")
        self._x = np.zeros(1)
        self._number = np.zeros(1, dtype=np.int64)

    @property
    def columns(self) -> list[str]:
        return ["time", "stage", "increment", "way"]

    @property
    def number(self) -> int:
        return int(self._number[0])

    def advance(self) -> Iterator[Step]:
        while self.number < STEPS:
            self._x += WAY / STEPS
            self._number += 1
            yield Step(self.number)

    def remaining(self) -> float:
        return 1.0 - self.number / STEPS

    def begin_log(self) -> str:
        return "conveyor"

    def log_lines(self, report: Step) -> list[str]:
        return [f"step {report.number}"]

    def progress_text(self, report: Step) -> str:
        return f"step {report.number}"

    def row(self, report: Step) -> dict[str, float | int | str]:
        return {"time": self._time(), "stage": "carry", "increment": report.number, "way": float(self._x[0])}

    def _time(self) -> float:
        return self.model.stages[0].duration * self.number / STEPS

    def snapshot(self) -> Snapshot:
        displacement = np.zeros_like(self.mesh.points)
        displacement[:, 0] = self._x
        points, cells = compute_fields(Instant(model=self.model, displacement=displacement))
        return Snapshot(self._time(), points, cells, {"title": self.title, "analysis": self.model.analysis})

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        return {"x": self._x, "number": self._number}

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        self._x[...], self._number[...] = arrays["x"], arrays["number"]

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        return {"way_mm": float(self._x[0]), "warnings": []}


@pytest.fixture
def model() -> Model:
    return build_model(Case.model_validate(BLOCK))


def test_its_history_fields_and_summary_are_written(model: Model, tmp_path: Path) -> None:
    outcome = run_model(model, tmp_path / "out", procedure=Conveyor)
    assert outcome.status == "completed"
    result = Result(outcome.folder)
    np.testing.assert_allclose(result.history["way"], WAY * np.arange(1, STEPS + 1) / STEPS, rtol=1e-14)
    np.testing.assert_allclose(result.field("displacement", -1)[:, 0], WAY)
    assert result.summary["way_mm"] == pytest.approx(WAY)


def test_it_is_interrupted_and_resumed_like_any_other(model: Model, tmp_path: Path) -> None:
    def interrupt(progress: Progress) -> None:
        if progress.fraction > 0.5:
            raise KeyboardInterrupt

    whole = run_model(model, tmp_path / "whole", procedure=Conveyor).folder
    folder = tmp_path / "resumed"
    assert run_model(model, folder, procedure=Conveyor, on_increment=interrupt).status == "interrupted"
    assert run_model(model, folder, procedure=Conveyor, resume=True).status == "completed"
    assert (folder / "history.csv").read_bytes() == (whole / "history.csv").read_bytes()
