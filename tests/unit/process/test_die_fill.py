# SPDX-License-Identifier: Apache-2.0
"""How far dies are filled: both dies, and only where metal can be. References are areas of cylinders and planes."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.observe.die_fill import make_die_fill

RADIUS, DEPTH, HEIGHT = 10.0, 5.0, 12.0
HARDENING = {"law": "swift", "K": 500, "e0": 0.01, "n": 0.2}


def make_case(analysis, *, behind=1.0, upper=8.0, width=RADIUS, **changes):
    """A billet of the radius of the pockets of two dies; it stands on the lower floor, the upper one is above it.

    behind: how far the profiles go on beyond the axis; upper: distance of the lands [mm].
    """
    pocket = [[-behind, -DEPTH], [RADIUS, -DEPTH], [RADIUS, 0.0], [RADIUS + 5.0, 0.0]]
    above = [[x, upper - y] for x, y in reversed(pocket)]
    return Case(
        **{
            "title": "two dies",
            "analysis": analysis,
            "workpiece": {
                "material": "steel",
                "mesh": {"size": [width, HEIGHT], "origin": [0, -DEPTH], "cells": [20, 24]},
            },
            "materials": {"steel": {"young": 2e5, "poisson": 0.3, "hardening": HARDENING}},
            "tools": {
                "upper": {"profile": above, "contact": "frictionless"},
                "lower": {"profile": pocket, "contact": "frictionless"},
            },
            "boundary": {"axis": {"set": "left", "fix": ["x"]}},
            "stages": [{"name": "press", "tools": {"upper": {"stroke": 7.0, "direction": [0, -1]}}}],
        }
        | changes
    )


def measure(model, **moved):
    displacement = {tool.name: np.asarray(moved.get(tool.name, np.zeros(2))) for tool in model.tools}
    fill = make_die_fill(model)
    return fill.measure(model.mesh, model.mesh.points, displacement) | fill.summarise(
        model.mesh, model.mesh.points, displacement
    )


@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("behind", [0.0, 1.0, 15.0])
def test_a_die_that_stands_is_filled_alone_where_metal_can_be(analysis, behind):
    """The billet of the pocket's radius touches all of the lower die; beyond the axis there is no metal to touch."""
    found = measure(build_model(make_case(analysis, behind=behind, upper=8.0)), upper=[0.0, 0.5])
    assert found["lower.fill"] == 1.0
    assert found["die_fill"]["lower"]["largest_gap_mm"] < 1e-9
    floor, wall = (np.pi * RADIUS**2, 2 * np.pi * RADIUS * DEPTH) if analysis == "axisymmetric" else (RADIUS, DEPTH)
    assert found["upper.fill"] == 0.0
    assert set(found["die_fill"]) == {"lower"}, "the upper die is 6.5 mm above the billet"
    assert found["lower.flash_thickness"] == pytest.approx(8.5)
    narrow = measure(build_model(make_case(analysis, behind=behind, width=0.5 * RADIUS)))
    touched = 0.25 * floor if analysis == "axisymmetric" else 0.5 * floor
    assert narrow["lower.fill"] == pytest.approx(touched / (floor + wall), abs=0.01)


def test_a_container_round_a_punch_is_no_die_with_a_flash():
    """The flat rim of a container faces no tool where the punch is narrower than its bore."""
    tools = {
        "punch": {"profile": [[RADIUS - 0.1, 8.0], [-1.0, 8.0]], "contact": "frictionless"},
        "container": {
            "profile": [[-1.0, -DEPTH], [RADIUS, -DEPTH], [RADIUS, 20.0], [RADIUS + 5.0, 20.0]],
            "contact": "frictionless",
        },
    }
    stages = [{"name": "press", "tools": {"punch": {"stroke": 7.0, "direction": [0, -1]}}}]
    assert make_die_fill(build_model(make_case("axisymmetric", tools=tools, stages=stages))).columns(None) == []


def test_where_the_other_die_lies_on_the_wall_no_metal_is_missing():
    """The lands of the dies meet at the upper edge of the lower die's wall."""
    model = build_model(make_case("axisymmetric", width=0.5 * RADIUS))
    fill = make_die_fill(model)
    (lower,) = (die for die in fill._dies if die.name == "lower")
    apart = {"upper": np.array([0.0, -8.0]), "lower": np.zeros(2)}
    places, _, area = fill._find_reach(lower, model.mesh, model.mesh.points, apart)
    assert len(places) < len(lower.places)
    assert area.sum() < lower.area.sum()
    assert (np.abs(places[:, 1]) > lower.tolerance).all()
