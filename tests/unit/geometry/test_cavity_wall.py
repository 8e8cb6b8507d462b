# SPDX-License-Identifier: Apache-2.0
"""The wall of a cavity ends at the flash land, and only dies with one have it."""

from itertools import pairwise

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.examples import copy_example
from presswork.geometry.cavity_wall import CavityWall, find_cavity_wall
from presswork.geometry.pose import start_profile
from presswork.observe.working_direction import find_working_direction

DOWN = np.array([0.0, -1.0])


def find(example, tool, tmp_path) -> CavityWall | None:
    model = build_model(Case.from_toml(copy_example(example, tmp_path)))
    found = next(t for t in model.plane_tools if t.name == tool)
    way = find_working_direction(model, found)
    middle = model.mesh.points.mean(axis=0)
    return find_cavity_wall(start_profile(found), way, middle, np.array([0.0, middle[1]]))


@pytest.mark.parametrize(
    ("example", "tool", "begin", "end"),
    [
        ("forging_hub", "die", 0.0, 21.4),
        ("forging_flash", "die", 0.0, 21.4),
        ("forging_h_section", "die", 0.0, 20.3),
        ("gear_blank", "blocker", 0.0, 30.2),
        ("gear_blank", "finisher", 0.0, 29.9),
    ],
)
def test_wall_reaches_from_the_axis_to_the_land(tmp_path, example, tool, begin, end):
    wall = find(example, tool, tmp_path)
    assert wall is not None
    x = wall.places[:, 0]
    assert x.min() == pytest.approx(begin, abs=0.2)
    assert x.max() == pytest.approx(end, abs=0.3)
    assert wall.land[:, 0].min() > x.max() - 1e-9
    assert np.ptp(wall.land[:, 1]) < 0.06 * np.ptp(wall.places[:, 1])


@pytest.mark.parametrize(
    ("example", "tool"),
    [("can_extrusion", "punch"), ("piercing", "punch"), ("upsetting_90", "platen"), ("gear_blank", "platen")],
)
def test_punches_and_platens_have_no_cavity(tmp_path, example, tool):
    assert find(example, tool, tmp_path) is None


def test_a_die_with_flash_on_both_sides_has_the_wall_between_its_lands():
    corners = [(-30, 2), (-10, 2), (-8, 8), (8, 8), (10, 2), (30, 2)]
    lines = np.array([[*a, *b, 0, 0, 0] for a, b in pairwise(corners)], dtype=float)
    wall = find_cavity_wall(lines, DOWN, np.zeros(2))
    assert wall is not None
    assert np.abs(wall.places[:, 0]).max() == pytest.approx(10.0, abs=0.2)
    assert wall.land[:, 1] == pytest.approx(2.0)
    assert len(wall.places) * wall.piece == pytest.approx(16 + 2 * np.hypot(2, 6), rel=0.02)
