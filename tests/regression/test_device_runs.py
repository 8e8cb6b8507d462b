# SPDX-License-Identifier: Apache-2.0
"""Stampings whose cycles the code for cards computes, on the CPU: from case file to results, restart across both."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import Result, _core
from presswork.case import StampingCase, build_model
from presswork.cli.commands import app
from presswork.examples import copy_example
from presswork.explicit.input_checks import ExplicitError
from presswork.fingerprint import fingerprint
from presswork.outcome import GaveUpError
from presswork.post.section import measure_draw_in
from presswork.process.begin import begin
from presswork.recorder import StartError, run_model
from tests.regression.whole_runs import run_in_two_parts, run_to_end, stop_after
from tests.unit.case.round_cup import CUP, changed

AGREEMENT = 1e-8
"""Of the largest value of a whole stamping."""


def make(device: str, **explicit: Any) -> dict[str, Any]:
    return changed(
        CUP,
        ("blank.element_size", 8),
        ("stages.0.velocity", "10 m/s"),
        ("stages.0.tools.punch.stroke", 8),
        ("explicit", {"device": device, "precision": "double", **explicit}),
        ("output", {"rows": 10, "steps": 2}),
        *((f"tools.{name}.mu", 0.1) for name in ("punch", "die", "holder")),
    )


def model_of(data: dict[str, Any]) -> Any:
    return build_model(StampingCase.model_validate(data))


def compare(found: Result, expected: Result) -> None:
    """Forces, energies, thickness, stress, place and draw-in."""
    for name, values in expected.history.items():
        if np.issubdtype(values.dtype, np.floating) and "second" not in name:
            scale = np.abs(values).max()
            np.testing.assert_allclose(found.history[name], values, rtol=0, atol=AGREEMENT * scale, err_msg=name)
    for field in ("thickness", "displacement", "stress_top", "equivalent_plastic_strain"):
        values = expected.field(field)
        scale = np.abs(values).max()
        np.testing.assert_allclose(found.field(field), values, rtol=0, atol=AGREEMENT * scale, err_msg=field)
    assert measure_draw_in(found, 0.0) == pytest.approx(measure_draw_in(expected, 0.0), rel=AGREEMENT)


@pytest.fixture(scope="module")
def on_cpu(tmp_path_factory: pytest.TempPathFactory) -> Result:
    return run_to_end(model_of(make("cpu")), tmp_path_factory.mktemp("cpu") / "out")


def test_a_cup_is_the_same_by_the_code_for_cards(on_cpu: Result, tmp_path: Path) -> None:
    found = run_to_end(model_of(make("host")), tmp_path / "out")
    assert on_cpu.history["punch.force"].max() > 1000.0
    assert "by the host build of the code for cards" in (tmp_path / "out" / "run.log").read_text()
    compare(found, on_cpu)


def test_a_cup_begun_on_the_cpu_is_resumed_on_a_device(on_cpu: Result, tmp_path: Path) -> None:
    assert fingerprint(model_of(make("cpu"))) == fingerprint(model_of(make("host")))
    folder = tmp_path / "out"
    assert run_model(model_of(make("cpu")), folder, threads=1, on_increment=stop_after(5)).status == "interrupted"
    outcome = run_model(model_of(make("host")), folder, threads=1, resume=True)
    assert outcome.status == "completed", outcome.reason
    compare(outcome.result, on_cpu)


def test_a_run_stopped_and_resumed_on_a_device_has_the_same_bits(tmp_path: Path) -> None:
    """Rows, too, whose energies and steps a device finds."""
    data = changed(
        make("host"), ("blank.element_size", 12), ("materials.steel.damage", {"criterion": "cockcroft_latham"})
    )
    whole = run_to_end(model_of(data), tmp_path / "whole")
    parts = run_in_two_parts(model_of(data), tmp_path / "parts", 2)
    for name, values in whole.history.items():
        if "second" not in name:
            np.testing.assert_array_equal(parts.history[name], values, err_msg=name)
    assert whole.history["damage_cockcroft_latham_max"].max() > 0
    for field in ("displacement", "stress_top", "damage_cockcroft_latham"):
        np.testing.assert_array_equal(parts.field(field), whole.field(field))


def test_a_row_that_fails_on_a_device_leaves_the_state_before_it(tmp_path: Path) -> None:
    """As on the CPU: kept there, changed meanwhile by added mass, and taken back."""
    found = {}
    for device in ("cpu", "host"):
        data = changed(make(device, target_step="1 us"), ("blank.element_size", 12))
        run = begin(model_of(data), threads=1)
        rows = run.advance()
        next(rows)
        before = run.to_arrays()
        advance = run.shells.advance

        def fail(*given: Any, advance: Any = advance, **how: Any) -> None:
            advance(*given, **how)
            raise ExplicitError("made to fail")

        run.shells.advance = fail
        with pytest.raises(GaveUpError, match="made to fail"):
            next(rows)
        found[device] = before, run.to_arrays()
    for before, after in found.values():
        assert set(before) == set(after)
        for name, values in before.items():
            np.testing.assert_array_equal(after[name], values, err_msg=name)


def test_the_command_line_chooses_a_device(tmp_path: Path) -> None:
    """And says what a device that is not there lacks, and what else there is."""
    case = copy_example("square_cup", tmp_path)
    told = CliRunner().invoke(app, ["run", str(case), "--device", "gpu", "--no-plot"])
    assert told.exit_code == 2
    assert "explicit.device" in told.output
    assert "choices: cpu, cuda, host" in told.output
    if not _core.list_cuda_cards()[0]:
        told = CliRunner().invoke(app, ["run", str(case), "--device", "cuda", "--no-plot"])
        assert told.exit_code == 2
        assert 'take device = "cpu"' in " ".join(told.output.split())


def test_what_no_device_computes_is_refused_before_it_starts() -> None:
    data = changed(make("host"), ("blank.refine", {"levels": 1}))
    with pytest.raises(StartError, match=r'does not compute refined sheets: take device = "cpu"'):
        begin(model_of(data), threads=1)
