# SPDX-License-Identifier: Apache-2.0
"""The blank of a square cup with an even flange, from a square in a few draws."""

from __future__ import annotations

import numpy as np
import pytest

from validation.blank_of_square_cup import TOLERANCE, draw_again, search

pytestmark = pytest.mark.validation


def test_the_flange_meets_its_target_in_four_draws_and_on_a_finer_mesh(tmp_path) -> None:
    found = search(tmp_path, 2.5, 'stages.0.velocity="4 m/s"')
    assert found.status == "completed", found.reason
    assert len(found.draws) <= 4
    assert found.draws[0].fit.worst > 10.0
    assert np.abs(found.best.fit.deviation).max() <= TOLERANCE
    assert np.abs(draw_again(found, tmp_path / "again")).max() < 2 * TOLERANCE
