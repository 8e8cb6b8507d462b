# SPDX-License-Identifier: Apache-2.0
"""What single precision changes in a stamping."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.post.section import measure_draw_in
from tests.regression.whole_runs import run_to_end
from tests.unit.case.round_cup import CUP, changed


def cup(**explicit: Any) -> Any:
    changes = [("blank.element_size", 8), ("stages.0.velocity", "10 m/s"), ("stages.0.tools.punch.stroke", 8)]
    output = ("output", {"rows": 10, "steps": 2})
    return build_model(StampingCase.model_validate(changed(CUP, *changes, ("explicit", explicit), output)))


def draw(folder: Path, precision: str) -> Result:
    return run_to_end(cup(precision=precision), folder)


def test_a_cup_in_single_precision_is_that_in_double(tmp_path: Path) -> None:
    """Draw-in and thickness within 1e-4 mm, the punch's force within 1e-3 of the largest, energies within 1e-4."""
    double, single = (draw(tmp_path / name, name) for name in ("double", "single"))
    assert measure_draw_in(double, 0.0) > 0.5
    assert measure_draw_in(single, 0.0) == pytest.approx(measure_draw_in(double, 0.0), abs=1e-4)
    np.testing.assert_allclose(single.field("thickness"), double.field("thickness"), rtol=0, atol=1e-4)
    for name, share in (("punch.force", 1e-3), ("internal_energy", 1e-4), ("friction_energy", 1e-4)):
        expected = double.history[name]
        np.testing.assert_allclose(single.history[name], expected, rtol=0, atol=share * np.abs(expected).max())
    assert np.abs(single.history["energy_error_percent"] - double.history["energy_error_percent"]).max() < 0.01
