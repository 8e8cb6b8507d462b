# SPDX-License-Identifier: Apache-2.0
"""Stampings whose cycles the code for cards computes, on the CPU: from case file to results, restart across both."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.post.section import measure_draw_in
from presswork.process.begin import begin
from presswork.recorder import StartError, fingerprint, run_model
from tests.regression.whole_runs import run_to_end, stop_after
from tests.unit.case.round_cup import CUP, changed

AGREEMENT = 1e-8
"""Of the largest value of a whole stamping."""


def make(device: str, **explicit: Any) -> dict[str, Any]:
    return changed(
        CUP,
        ("blank.element_size", 8),
        ("stages.0.velocity", "10 m/s"),
        ("stages.0.tools.punch.stroke", 8),
        ("explicit", {"device": device, **explicit}),
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
    compare(found, on_cpu)


def test_a_cup_begun_on_the_cpu_is_resumed_on_a_device(on_cpu: Result, tmp_path: Path) -> None:
    assert fingerprint(model_of(make("cpu"))) == fingerprint(model_of(make("host")))
    folder = tmp_path / "out"
    assert run_model(model_of(make("cpu")), folder, threads=1, on_increment=stop_after(5)).status == "interrupted"
    outcome = run_model(model_of(make("host")), folder, threads=1, resume=True)
    assert outcome.status == "completed", outcome.reason
    compare(outcome.result, on_cpu)


def test_what_no_device_computes_is_refused_before_it_starts() -> None:
    data = changed(make("host"), ("blank.refine", {"levels": 1}))
    with pytest.raises(StartError, match=r'does not compute refined sheets: take device = "cpu"'):
        begin(model_of(data), threads=1)
