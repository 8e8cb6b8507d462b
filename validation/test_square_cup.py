# SPDX-License-Identifier: Apache-2.0
"""The square cup of Cheng (1995), chapter 4, by the explicit procedure beside the experiment."""

from __future__ import annotations

import numpy as np
import pytest
from square_cup import EXPERIMENT, draw_cup, draw_in

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def cup(tmp_path_factory):
    return draw_cup(tmp_path_factory.mktemp("cup"))


@pytest.mark.parametrize("angle", EXPERIMENT)
def test_draw_in_follows_the_experiment(cup, angle) -> None:
    """One choice of holder force and friction for all strokes: within 0.75 mm, 0.45 along the diagonal."""
    apart = np.abs(draw_in(cup, angle) - EXPERIMENT[angle])
    assert apart.max() < (0.75 if angle == 0 else 0.45)


def test_the_cup_is_symmetric_and_quasi_static(cup) -> None:
    np.testing.assert_allclose(draw_in(cup, 0), draw_in(cup, 90), atol=1e-3)
    assert cup.summary["warnings"] == []
    assert np.abs(cup.history["energy_error_percent"]).max() < 0.5
