# SPDX-License-Identifier: Apache-2.0
"""A rim is flanged and hemmed, onto the panel itself and round an inner panel: how thick a flat hem is; resume."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from tests.problems.hems import INNER, ROOM, SHEET, hem_line
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end


@pytest.mark.parametrize("inner", [0.0, pytest.param(INNER, marks=pytest.mark.validation)])
def test_a_flat_hem_is_as_thick_as_its_sheets(inner: float, tmp_path) -> None:
    """Two sheets and the inner panel, up to the room that the steel leaves; overlap below 3 % of the thickness."""
    result = run_to_end(build_model(StampingCase.model_validate(hem_line(inner))), tmp_path)
    hem, history = result.summary["hem"], result.history
    least, most = hem["formed"]["thickness_mm"]
    assert most == pytest.approx(ROOM + inner, abs=0.03)
    assert least > 2.0 * SHEET + inner - 0.03
    assert abs(hem["formed"]["opening_degrees"]["mean"]) < 1.0
    assert hem["roll_in_mm"]["mean"] > 0.0
    assert result.summary["overlap_mm"] < 0.03 * SHEET
    assert (result.summary["overlap_mm"] > 0.0) == (inner == 0.0), "without an inner panel the flange lies on the panel"
    assert np.abs(history["energy_error_percent"]).max() < 2.0
    assert history["hem_prehem.stroke"].max() == pytest.approx(6.0, rel=1e-6)


@pytest.mark.validation
def test_a_hem_goes_on_with_the_same_bits(tmp_path) -> None:
    """Stopped while the flange is pressed on the panel."""
    model = build_model(StampingCase.model_validate(hem_line(0.0)))
    run_to_end(model, tmp_path / "whole")
    run_in_two_parts(model, tmp_path / "parts", 86)
    assert_same_bits(tmp_path / "parts", tmp_path / "whole")
