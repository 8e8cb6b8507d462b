# SPDX-License-Identifier: Apache-2.0
"""What the tests of whole runs share: a stamping run from data, a run stopped and resumed, runs bit by bit."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result, _core
from presswork.case import StampingCase, build_model
from presswork.model import Model
from presswork.process.begin import begin
from presswork.process.run import Run
from presswork.recorder import Outcome, Progress, run_model
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


def run_in_two_parts(
    model: Model, folder: Path, when: int | Callable[[Progress], bool], *, threads: int | tuple[int, int] = 1
) -> Result:
    """Run a model that is stopped as Ctrl-C does, after so many rows or increments or when told; resume it.

    threads: of both parts, or of each.
    """

    def stop(progress: Progress) -> None:
        assert callable(when)
        if when(progress):
            raise KeyboardInterrupt

    first, then = threads if isinstance(threads, tuple) else (threads, threads)
    stopping = stop_after(when) if isinstance(when, int) else stop
    assert run_model(model, folder, threads=first, on_increment=stopping).status == "interrupted"
    outcome = run_model(model, folder, threads=then, resume=True)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def compare_with_restart(model: Model, rows: int, threads: int, until: int | None = None) -> dict[str, Any]:
    """Compare all arrays of a run on one thread with those of one restarted after some rows on others; return them.

    until: rows after which they are compared; None: at the end.
    """
    before = _core.max_threads()
    try:
        whole, part, resumed = (begin(model, threads=n) for n in (1, threads, threads))
        _advance(whole, until)
        _advance(part, rows)
        resumed.load_arrays(part.to_arrays())  # type: ignore[attr-defined]
        _advance(resumed, None if until is None else until - rows)
    finally:
        _core.set_threads(before)
    one, other = whole.to_arrays(), resumed.to_arrays()  # type: ignore[attr-defined]
    assert set(one) == set(other)
    assert all(np.asarray(one[name]).tobytes() == np.asarray(other[name]).tobytes() for name in one)
    return dict(one)


def _advance(run: Run, rows: int | None) -> None:
    for _ in itertools.islice(run.advance(), rows):
        pass


def stop_at_fold(folder: Path) -> Callable[[Progress], bool]:
    """Return what tells that the log of a run has a body that folds onto itself."""
    return lambda _: "fold onto itself" in (folder / "run.log").read_text()


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
