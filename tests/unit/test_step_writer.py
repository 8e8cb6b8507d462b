# SPDX-License-Identifier: Apache-2.0
"""Saved steps are written beside the computation, in order, and what fails stops the run with its own message."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest

from presswork import step_writer
from presswork.process.run import Snapshot
from presswork.results import OutputError, count_steps
from presswork.step_writer import StepWriter
from tests.unit.results.upset_output import make_mesh


def snapshot(time: float) -> Snapshot:
    mesh = make_mesh()
    return Snapshot(time, {"displacement": np.full((len(mesh.points), 3), time)}, {}, {"title": "made up"})


def test_a_step_is_written_while_the_run_goes_on(tmp_path: Path, monkeypatch) -> None:
    """append comes back before the file is there; wait, and the next append, come back after."""
    go_on, write = threading.Event(), step_writer.append_step

    def held(*given, **named) -> None:
        assert go_on.wait(10)
        write(*given, **named)

    monkeypatch.setattr(step_writer, "append_step", held)
    path = tmp_path / "results.vtkhdf"
    steps = StepWriter(path)
    steps.append(make_mesh(), snapshot(0.0))
    assert steps.count == 1
    steps.look()
    assert not path.exists()
    go_on.set()
    steps.append(make_mesh(), snapshot(1.0))
    assert count_steps(path) >= 1
    steps.wait()
    assert count_steps(path) == steps.count == 2
    steps.go_back(1)
    assert count_steps(path) == steps.count == 1
    steps.close()


def test_a_step_that_cannot_be_written_stops_the_run_before_a_checkpoint_counts_on_it(tmp_path: Path) -> None:
    path = tmp_path / "results.vtkhdf"
    steps = StepWriter(path)
    steps.append(make_mesh(), snapshot(0.0))
    steps.wait()
    path.unlink()  # by somebody else
    steps.append(make_mesh(), snapshot(1.0))
    for look in (steps.wait, steps.check, lambda: steps.append(make_mesh(), snapshot(2.0))):
        with pytest.raises(OutputError, match=r"results\.vtkhdf was deleted or changed"):
            look()
    assert not path.exists()
    steps.close()
