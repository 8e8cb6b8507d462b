# SPDX-License-Identifier: Apache-2.0
"""What the tests of whole runs share: a stamping run from data, a run stopped and resumed, runs bit by bit."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.model import Model
from presswork.recorder import Outcome, run_model
from presswork.results import load_checkpoint


def run_stamping(data: dict[str, Any], folder: Path, **changes: Any) -> Result:
    """Run a stamping to its end, other keys of the case put in."""
    case = StampingCase.model_validate({**copy.deepcopy(data), **changes})
    return run_to_end(build_model(case), folder)


def run_to_end(model: Model, folder: Path) -> Result:
    """Run a model on one thread."""
    outcome = run_model(model, folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def stop_after(reports: int) -> Callable[[object], None]:
    """Return what stops a run as Ctrl-C does, after so many rows or increments."""
    left = iter(range(reports - 1, -1, -1))

    def stop(_: object) -> None:
        if next(left) == 0:
            raise KeyboardInterrupt

    return stop


def run_in_two_parts(model: Model, folder: Path, reports: int, *, threads: int = 1) -> Result:
    """Run a model that is stopped after so many rows or increments, and resume it."""
    assert run_model(model, folder, threads=threads, on_increment=stop_after(reports)).status == "interrupted"
    outcome = run_model(model, folder, threads=threads, resume=True)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def stop_within_a_row(model: Model, folder: Path, monkeypatch: pytest.MonkeyPatch, loop: type, calls: int) -> Outcome:
    """Run a model on one thread; it is stopped, as Ctrl-C does, when the loop has been advanced so many times."""
    advance, left = loop.advance, iter(range(calls - 1, -1, -1))

    def interrupted(self: object, *args: Any, **kwargs: Any) -> None:
        advance(self, *args, **kwargs)
        if next(left) == 0:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(loop, "advance", interrupted)
        return run_model(model, folder, threads=1)


def assert_same_bits(folder: Path, wanted: Path) -> None:
    """Compare history, every field of every saved step, and the checkpoint."""
    assert (folder / "history.csv").read_bytes() == (wanted / "history.csv").read_bytes()
    found, first = Result(folder), Result(wanted)
    np.testing.assert_array_equal(found.times, first.times)
    for name in first.field_names:
        for step in range(len(first.times)):
            np.testing.assert_array_equal(found.field(name, step), first.field(name, step), err_msg=f"{name}, {step}")
    arrays, _ = load_checkpoint(folder / "checkpoint.h5")
    for name, values in load_checkpoint(wanted / "checkpoint.h5")[0].items():
        np.testing.assert_array_equal(arrays[name], values, err_msg=name)
