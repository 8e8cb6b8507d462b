# SPDX-License-Identifier: Apache-2.0
"""Sharp corners of tools in runs whose meshes change."""

from itertools import pairwise

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.case.tools.rounded import round_outer_corners
from presswork.geometry.profile_path import ProfilePath
from presswork.model import Friction, Profile, Tool


def step(m=0.1):
    """A die with an inner and an outer sharp corner, and a bend of 11 degrees."""
    corners = np.array([[20, 4], [10, 4], [10, 8], [5, 8], [0, 9]], dtype=float)
    rows = [[*a, *b, 0, 0, 0] for a, b in pairwise(corners)]
    return Tool("die", Profile(np.array(rows)), friction=Friction(law="shear", m=m))


def test_the_corner_that_points_into_the_metal_gets_a_radius_and_no_other():
    (tool,) = round_outer_corners([step(np.array([0.1, 0.2, 0.3, 0.4]))], 0.5)
    rows = tool.shape.segments
    assert len(rows) == 5
    np.testing.assert_allclose(rows[1], [10.5, 4, 10, 4.5, 10.5, 4.5, -1])
    np.testing.assert_allclose(rows[0, 2:4], [10.5, 4])
    np.testing.assert_allclose(rows[2, :4], [10, 4.5, 10, 8])
    np.testing.assert_array_equal(tool.friction.m, [0.1, 0.1, 0.2, 0.3, 0.4])


def test_a_corner_between_lines_too_short_stays_sharp():
    (tool,) = round_outer_corners([step()], 11.0)
    np.testing.assert_array_equal(tool.shape.segments, step().shape.segments)


@pytest.mark.parametrize(("remesh", "radius"), [({"size": 1.0, "smallest_size": 0.4}, 0.2), (None, np.inf)])
def test_a_case_with_new_meshes_rounds_sharp_corners_by_half_its_smallest_cell(remesh, radius):
    case = Case(
        title="indenter",
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": {"size": [10, 10], "cells": [10, 10]}},
        materials={
            "steel": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 0}}
        },
        tools={"punch": {"profile": [[-1, 10], [3, 10], [3, 15]], "contact": "frictionless"}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"stroke": 1, "direction": [0, -1]}}}],
        remesh=remesh,
    )
    (tool,) = build_model(case).plane_tools
    assert ProfilePath(tool.shape.segments).radius.min() == pytest.approx(radius)
