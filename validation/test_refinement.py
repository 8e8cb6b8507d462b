# SPDX-License-Identifier: Apache-2.0
"""Blanks refined as they are formed beside blanks as fine from the start; some minutes."""

from __future__ import annotations

import pytest

from validation.refinement import form_all, measure

pytestmark = pytest.mark.validation

BOUNDS = {"square_cup": (0.02, 0.1, 0.5), "hemispherical_punch": (0.01, 1e-9, 0.25)}
"""Of the punch force, of draw-in [mm], of the share of shell cycles."""


@pytest.mark.parametrize("name", BOUNDS)
def test_a_refined_blank_gives_what_a_fine_one_gives_in_a_part_of_the_work(tmp_path, name) -> None:
    """And the coarse one does not: its thinnest shell and its draw-in are farther off."""
    force, draw_in, share = BOUNDS[name]
    found = {run: measure(result) for run, result in form_all(tmp_path, name).items()}
    refined, fine, coarse = found["refined"], found["fine"], found["coarse"]
    assert refined["punch force"] == pytest.approx(fine["punch force"], rel=force)
    assert refined["thinnest"] == pytest.approx(fine["thinnest"], abs=0.01)
    assert abs(refined["thinnest"] - fine["thinnest"]) < 0.6 * abs(coarse["thinnest"] - fine["thinnest"])
    for way in ("side", "diagonal"):
        assert refined[f"draw-in, {way}"] == pytest.approx(fine[f"draw-in, {way}"], abs=draw_in)
    assert refined["shell cycles [1e6]"] < share * fine["shell cycles [1e6]"]
    assert refined["balance"] < 0.2
