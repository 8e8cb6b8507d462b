# SPDX-License-Identifier: Apache-2.0
"""Contact pressure on the surface of a tool in space."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import build_model
from presswork.case.space.schema import SpaceCase
from presswork.post.die_stress import find_die_stress
from presswork.recorder import run_model
from presswork.results import Result, ResultError
from presswork.view.plots.die_stress_plot import plot_die_stress


@pytest.fixture(scope="module")
def upset(tmp_path_factory) -> Result:
    """A quarter of a block, upset by 10 % under a smooth plane: the pressure is the same everywhere."""
    case = {
        "title": "pressed",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 10, 8], "cells": [2, 2, 2]}},
        "materials": {"steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 500}}},
        "tools": {"die": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "contact": "frictionless"}},
        "boundary": {"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}}
        | {"back": {"set": "back", "fix": ["z"]}},
        "stages": [{"name": "press", "tools": {"die": {"stroke": 0.8, "direction": [0, 0, -1]}}}],
        "solver": {"initial_increment": 0.25, "max_increment": 0.25},
    }
    return run_model(build_model(SpaceCase.model_validate(case)), tmp_path_factory.mktemp("upset") / "run").result


def test_the_pressure_on_a_die_bears_its_force(upset):
    found = find_die_stress(upset, "die")
    area = 0.5 * np.linalg.norm(
        np.cross(found.corners[:, 1] - found.corners[:, 0], found.corners[:, 2] - found.corners[:, 0]), axis=1
    )
    touched = found.pressure > 1e-9  # what is less is rounding of a node that just touches
    np.testing.assert_allclose(found.pressure[touched], 500.0, rtol=5e-3)
    assert 4.0 * (area * found.pressure).sum() == pytest.approx(upset.history["die.force"][-1], rel=0.2)
    assert area[touched].sum() == pytest.approx(np.prod(upset.points(-1).max(axis=0)[:2]), rel=0.2)
    assert (~touched).any(), "the tool is shown beside the workpiece, too"
    lengths = np.linalg.norm(np.roll(found.corners, -1, axis=1) - found.corners, axis=2)
    assert lengths.max() < 0.5 * 6.0


def test_a_tool_that_is_not_there_is_refused(upset):
    with pytest.raises(ResultError, match="no tool 'punch' in space; it has die"):
        find_die_stress(upset, "punch")


def test_the_picture_shows_the_side_that_is_pressed(upset):
    figure = plot_die_stress(upset, "die")
    assert figure.axes[0].elev < 0.0, "from below"
    assert figure.get_supxlabel().startswith("max 500 at (")
    assert figure.axes[1].get_ylabel() == "contact pressure [MPa]"
