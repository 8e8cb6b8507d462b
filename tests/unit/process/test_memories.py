# SPDX-License-Identifier: Apache-2.0
"""What a recording remembers survives a checkpoint, and a limit that is passed stops it unless it may go on."""

from __future__ import annotations

import copy
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case import Case
from presswork.model import Limits
from presswork.observe.contract import Measure, Observer, Observers
from presswork.observe.memory.limits import LimitsPassed
from presswork.observe.memory.of_model import list_memories
from tests.consistency.test_added_procedure import BLOCK

ROW = {"time": 0.5, "stage": "press", "punch.stroke": 2.0}


class Deep(Observer):
    """Measures a penetration that is given."""

    def __init__(self, *values: float) -> None:
        self._values = iter(values)

    def measures(self, run: Any) -> list[Measure]:
        return [Measure("penetration", next(self._values), "a tool is deep")]


def run_with(observer: Observer) -> Any:
    return SimpleNamespace(observers=Observers([observer]))


@pytest.mark.parametrize("stop", [True, False])
def test_a_limit_that_is_passed_stops_a_run_or_warns_at_its_end(stop: bool) -> None:
    passed = LimitsPassed(Limits(penetration=0.5, stop=stop))
    run = run_with(Deep(0.4, 0.6))
    assert passed.look(run, ROW) is None
    reason = passed.look(run, {**ROW, "punch.stroke": 3.0})
    assert (reason is not None) == stop
    text = reason or passed.warnings()[0]
    assert text.startswith("stage 'press', punch at 3 mm: a tool is deep")
    assert passed.summary({})["limits"]["penetration"]["largest"] == 0.6


def test_what_is_largest_stays_after_a_state_that_is_farther_from_its_limit() -> None:
    passed, run = LimitsPassed(Limits()), run_with(Deep(0.3, 0.1))
    for time in (0.5, 0.6):
        passed.look(run, {**ROW, "time": time})
    assert passed.summary({})["limits"]["penetration"]["time_s"] == 0.5


def test_memories_go_through_a_checkpoint() -> None:
    model = replace(build_model(Case.model_validate(copy.deepcopy(BLOCK))), limits=Limits(penetration=0.5, stop=False))
    first, again = list_memories(model), list_memories(model)
    passed = next(m for m in first._memories if isinstance(m, LimitsPassed))
    passed.look(run_with(Deep(0.6)), ROW)
    stress = np.arange(len(model.mesh.blocks[0].connectivity), dtype=float)
    first.note_step(0, model.mesh, SimpleNamespace(time=0.5, point_data={}, cell_data={"effective_stress": stress}))
    again.load_text(first.to_text())
    history = {"time": np.array([0.5]), "punch.force": np.array([-3.0])}
    assert again.summary(history) == first.summary(history)
    assert again.warnings() == first.warnings() != []
    assert again.summary(history)["fields"]["effective_stress"]["largest"]["value"] == stress.max()
    assert again.summary(history)["largest_forces"]["punch"]["force_n"] == -3.0
