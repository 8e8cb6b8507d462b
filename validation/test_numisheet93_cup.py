# SPDX-License-Identifier: Apache-2.0
"""The square cup of NUMISHEET'93 beside the mean draw-in that was measured."""

from __future__ import annotations

import numpy as np
import pytest

from validation.numisheet93_cup import MEASURED, OTHER_PROGRAM, draw_cup, measure

pytestmark = pytest.mark.validation


def test_aluminium_is_drawn_in_as_measured_at_15_mm(tmp_path) -> None:
    """Sides within 10 %, the diagonal within 5 % of the mean; the scatter is not known."""
    found = measure(draw_cup(tmp_path, "aluminium"))
    for side in ("x", "y"):
        assert found[side][0] == pytest.approx(MEASURED["side"][0], rel=0.1)
    assert found["diagonal"][0] == pytest.approx(MEASURED["diagonal"][0], rel=0.05)


@pytest.fixture(scope="module")
def isotropic(tmp_path_factory) -> dict[str, np.ndarray]:
    return measure(draw_cup(tmp_path_factory.mktemp("isotropic"), "aluminium", isotropic=True))


def test_isotropic_aluminium_is_drawn_in_as_another_program_with_bricks_found(isotropic) -> None:
    """Within 3 % on the sides at both depths, and on the diagonal at 40 mm."""
    for side in ("x", "y"):
        np.testing.assert_allclose(isotropic[side], OTHER_PROGRAM["side"], rtol=0.03)
    assert isotropic["diagonal"][1] == pytest.approx(OTHER_PROGRAM["diagonal"][1], rel=0.03)


@pytest.mark.xfail(strict=True, reason="3.1 % off a figure with one decimal")
def test_isotropic_aluminium_is_drawn_in_on_the_diagonal_at_15_mm(isotropic) -> None:
    """Within 3 %."""
    assert isotropic["diagonal"][0] == pytest.approx(OTHER_PROGRAM["diagonal"][0], rel=0.03)


@pytest.fixture(scope="module")
def steel(tmp_path_factory) -> dict[str, np.ndarray]:
    return measure(draw_cup(tmp_path_factory.mktemp("steel"), "steel"))


def test_steel_is_drawn_in_on_its_sides_as_measured_at_40_mm(steel) -> None:
    """Within 5 % of the mean."""
    for side in ("x", "y"):
        assert steel[side][1] == pytest.approx(MEASURED["side"][1], rel=0.05)


@pytest.mark.xfail(strict=True, reason="2.4 mm too far on the diagonal")
def test_steel_is_drawn_in_on_the_diagonal_as_measured_at_40_mm(steel) -> None:
    assert steel["diagonal"][1] == pytest.approx(MEASURED["diagonal"][1], rel=0.05)
