# SPDX-License-Identifier: Apache-2.0
"""The square cup of Cheng (1995), chapter 4: explicit beside the experiment, and implicit beside explicit."""

from __future__ import annotations

import numpy as np
import pytest

from validation.cup_influence import round_punch
from validation.square_cup import EXPERIMENT, STROKE, THESIS, draw_cup, draw_in

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def cup(tmp_path_factory):
    return draw_cup(tmp_path_factory.mktemp("cup"))


def test_the_implicit_procedure_draws_the_same_cup(tmp_path) -> None:
    """Neither irons: draw-in within 0.3 mm, punch force within 5 %, extremes of thickness strain within 0.02."""
    cup = draw_cup(tmp_path / "explicit", 2.0, "explicit.ironing=false")
    other = draw_cup(tmp_path / "implicit", 2.0, 'procedure="implicit"')
    for angle in EXPERIMENT:
        np.testing.assert_allclose(draw_in(other, angle), draw_in(cup, angle), atol=0.3)
    forces = [np.interp(STROKE, r.history["punch.stroke"], r.history["punch.force"]) for r in (cup, other)]
    np.testing.assert_allclose(forces[1], forces[0], rtol=0.05)
    apart = np.subtract(*(r.summary["extremes"]["thickness_strain"] for r in (cup, other)))
    assert np.abs(apart).max() < 0.02


def test_a_pushed_holder_irons_the_corners_of_the_flange_only_near_the_yield_stress(tmp_path) -> None:
    """They bear it, and come to half the yield stress: strain above 0.22; draw-in within 0.05 mm, force within 1 %."""
    cups = [draw_cup(tmp_path / key, 2.0, f"explicit.ironing={key}") for key in ("true", "false")]
    for angle in EXPERIMENT:
        np.testing.assert_allclose(*(draw_in(c, angle) for c in cups), atol=0.05)
    np.testing.assert_allclose(*(c.history["punch.force"].max() for c in cups), rtol=0.01)
    ironed, free = (c.summary["extremes"]["thickness_strain"][1] for c in cups)
    assert 0.22 < ironed < 0.24 < free


@pytest.mark.parametrize("angle", EXPERIMENT)
def test_draw_in_is_closer_to_the_experiment_than_the_thesis(cup, angle) -> None:
    """One choice of holder force and friction for all strokes."""
    here, there = (np.abs(d - EXPERIMENT[angle]) for d in (draw_in(cup, angle), THESIS[angle]))
    assert (here < there).all()


def test_the_cup_is_symmetric_and_quasi_static(cup) -> None:
    np.testing.assert_allclose(draw_in(cup, 0), draw_in(cup, 90), atol=1e-3)
    assert cup.summary["warnings"] == []
    assert np.abs(cup.history["energy_error_percent"]).max() < 0.5


def test_the_table_belongs_to_the_square_punch(tmp_path) -> None:
    """Under the cylindrical punch of the thesis's second process the flange comes in by little more than half."""
    other = draw_cup(tmp_path, 2.0, *round_punch())
    assert (draw_in(other, 0.0) < 0.65 * EXPERIMENT[0.0]).all()
