# SPDX-License-Identifier: Apache-2.0
"""The square cup of Cheng (1995) drawn by increments, and its blank found again by one step back, and by stages."""

from __future__ import annotations

import numpy as np
import pytest

from validation.inverse_of_cup import DEPTHS, OTHERS, STAGES, draw_cup, find_blank, follow_increments, off_rim

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def cup(tmp_path_factory):
    return draw_cup(tmp_path_factory.mktemp("cup"))


@pytest.mark.parametrize(("depth", "stages"), [(15.0, 1), (15.0, STAGES), (20.0, STAGES), (25.0, STAGES)])
def test_the_blank_is_the_square_within_a_millimetre(cup, depth, stages) -> None:
    assert np.abs(find_blank(cup, depth, stages=stages).off_outline).max() < 1.0


def test_the_path_is_most_of_what_one_step_is_off(cup) -> None:
    """The increments' own shapes as stages, every node in its place: what is left then is not the path's."""
    start = cup.mesh.points[:, :2]
    middle, corner = np.argmax(start[:, 0] - start[:, 1]), np.argmax(start.sum(axis=1))
    one, many = (follow_increments(cup, depths) for depths in ((25.0,), tuple(np.arange(1.0, 26.0))))
    for node, rest in ((middle, 0.45), (corner, 0.1)):
        off = [abs(blank[node].max() - start.max()) for blank in (one, many)]
        assert off[1] < min(rest, 0.25 * off[0])


@pytest.mark.parametrize("stages", [1, STAGES])
def test_corners_are_found_within_a_millimetre_at_every_depth(cup, stages) -> None:
    for depth in DEPTHS:
        inverse = find_blank(cup, depth, stages=stages)
        start = cup.mesh.points[:, :2]
        corner = np.argmax(start.sum(axis=1))
        assert np.abs(inverse.found.blank[corner] - start[corner]).max() < 1.0


@pytest.mark.parametrize(
    ("depth", "stages", "rms"),
    [(15.0, 1, 0.022), (20.0, 1, 0.032), (25.0, 1, 0.045), (15.0, 3, 0.017), (20.0, 3, 0.02), (25.0, 3, 0.022)],
)
def test_thickness_strain_is_near_that_of_the_increments(cup, depth, stages, rms) -> None:
    true, found = find_blank(cup, depth, stages=stages).strains
    assert np.sqrt(np.mean((found - true) ** 2)) < rms


@pytest.mark.parametrize("stages", [1, STAGES])
def test_the_punch_force_is_near_that_of_the_increments(cup, stages) -> None:
    for depth in DEPTHS:
        force = np.interp(depth, cup.history["punch.stroke"], cup.history["punch.force"])
        assert find_blank(cup, depth, stages=stages).found.punch_force == pytest.approx(force, rel=0.1)


@pytest.mark.parametrize("name", OTHERS)
def test_stages_find_the_blanks_of_other_cups_within_a_millimetre(name, tmp_path) -> None:
    """And thickness strain at full depth nearer to the increments' than one step does."""
    keys, process = OTHERS[name]
    other = draw_cup(tmp_path, 2.0, *keys)
    for depth in DEPTHS:
        assert np.abs(off_rim(find_blank(other, depth, stages=STAGES, **process))).max() < 1.0
    strains = [find_blank(other, DEPTHS[-1], stages=n, **process).strains for n in (1, STAGES)]
    one, three = (np.sqrt(np.mean((found - true) ** 2)) for true, found in strains)
    assert three < 0.7 * one
