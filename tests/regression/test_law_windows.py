# SPDX-License-Identifier: Apache-2.0
"""How far metal flowed outside the window of its hot law: stampings tell it in summary.json and in run.log."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import run_model
from presswork.case import StampingCase, build_model

HOT: dict[str, Any] = {
    "young": "150 GPa", "poisson": 0.3, "density": "7830 kg/m^3", "heating": {"start": 700},
    "hardening": {"law": "norton_hoff", "K": 20, "e0": 0.01, "n": 0.2, "m": 0.1, "beta": 2500,
                  "strain_window": [0.005, 0.05], "rate_window": [1e-6, 10], "temperature_window": [600, 900]},
}  # fmt: skip
PULL: dict[str, Any] = {
    "title": "hot strip in tension",
    "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 2, "material": "steel",
              "symmetry": ["x", "y"]},
    "materials": {"steel": HOT},
    "boundary": {"flat": {"set": "all", "fix": ["z"]}},
    "stages": [{"name": "pull", "process_time": 0.5, "velocity": "0.5 m/s",
                "displacement": [{"set": "right", "component": "x", "value": 1}]}],
    "output": {"rows": 20, "steps": 2, "checkpoint_every": 3},
}  # fmt: skip


def stop_halfway(progress: Any) -> None:
    if progress.fraction > 0.5:
        raise KeyboardInterrupt


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_stamping_tells_how_far_metal_flowed_outside_the_window(procedure: str, tmp_path: Path) -> None:
    """A strip pulled by 10 % in half a second, smoothly: strains to 0.095, rates of some 0.2 1/s."""
    model = build_model(StampingCase.model_validate({**PULL, "procedure": procedure}))
    result = run_model(model, tmp_path / "whole", threads=1).result
    told = result.summary["law_windows"]["steel"]
    assert told["strain"]["window"] == [0.005, 0.05]
    assert told["strain"]["reached"][1] == pytest.approx(np.log(1.1), rel=0.02)
    assert told["strain"]["share_above"] == pytest.approx(0.48, abs=0.1)
    assert 0.1 < told["rate"]["reached"][1] < 0.6
    assert told["rate"]["share_above"] == 0.0
    assert told["temperature"]["reached"] == [700.0, 700.0]
    (warning,) = (text for text in result.summary["warnings"] if "its law holds" in text)
    assert "steel: its law holds for a strain from 0.005 to 0.05, and metal flowed up to 0.09" in warning
    last = (tmp_path / "whole" / "run.log").read_text().splitlines()[-1 - len(result.summary["warnings"]) :]
    assert any(line.endswith(f"warning: {warning}") for line in last)
    run_model(model, tmp_path / "parts", threads=1, on_increment=stop_halfway)
    parts = run_model(model, tmp_path / "parts", threads=1, resume=True).result
    assert parts.summary["law_windows"] == result.summary["law_windows"]
    assert (tmp_path / "parts/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()


def test_a_law_within_its_window_is_not_warned_of(tmp_path: Path) -> None:
    wide = {**HOT, "hardening": HOT["hardening"] | {"strain_window": [0.0, 1.0]}}
    model = build_model(StampingCase.model_validate({**PULL, "procedure": "implicit", "materials": {"steel": wide}}))
    result = run_model(model, tmp_path / "out", threads=1).result
    assert result.summary["law_windows"]["steel"]["strain"]["share_above"] == 0.0
    assert not any("its law holds" in text for text in result.summary["warnings"])
