# SPDX-License-Identifier: Apache-2.0
"""One step back from parts of operations in a row: the blank, its thickness, the punch force."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import Result
from validation.one_step_of_operations import CUP_STEEL, HOLDER, step_back
from validation.press_line_twice import run_line

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def line(tmp_path_factory) -> Result:
    return run_line(tmp_path_factory.mktemp("line"))


@pytest.mark.parametrize(("stage", "rim", "rms"), [("draw_form", 0.3, 0.01), ("draw_springback", 0.5, 0.015)])
def test_the_round_blank_is_found_from_the_drawn_and_from_the_trimmed_part(line, stage, rim, rms) -> None:
    back = step_back(line, stage, CUP_STEEL, 0.8, HOLDER, 0.1)
    assert np.abs(back.off_rim).max() < rim
    true, found = back.strains
    assert np.sqrt(np.mean((found - true) ** 2)) < rms


def test_the_punch_force_of_the_draw_is_near_that_of_the_increments(line) -> None:
    drawn = line.history["stage"] == "draw_form"
    force = float(line.history["draw_punch.force"][drawn][-1])
    assert step_back(line, "draw_form", CUP_STEEL, 0.8, HOLDER, 0.1).found.punch_force == pytest.approx(force, rel=0.1)
