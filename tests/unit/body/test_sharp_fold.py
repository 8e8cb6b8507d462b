# SPDX-License-Identifier: Apache-2.0
"""What inner radius a folded sheet has, by its nodes and directors, on folds of known radius."""

from dataclasses import replace

import numpy as np
import pytest

from presswork.body.sharp_fold import find_sharp_fold
from presswork.implicit.remedy import find_remedy
from presswork.implicit.stepping import ImplicitProcedure
from tests.problems.plane_solids import elastic
from tests.problems.shells import CLAMPED, patch, shell_model

THICKNESS = 1.0


def bent(radius: float) -> ImplicitProcedure:
    """Return half a turn of a strip round the radius of its mid-surface [mm]."""

    def arc(u, v):
        return np.column_stack([radius * np.sin(u), v, radius * (1.0 - np.cos(u))])

    def normal(u, v):
        return np.column_stack([-np.sin(u), 0 * v, np.cos(u)])

    lines = np.linspace(0.0, np.pi, 9), np.array([0.0, 1.0])
    mesh = patch(arc, *lines, thickness=THICKNESS, normal=normal)
    return ImplicitProcedure(shell_model(mesh, elastic(2e5, 0.3), [("left", CLAMPED)]), threads=1)


@pytest.mark.parametrize("radius", [0.52, 0.6, 0.8])
def test_the_inner_radius_is_that_of_the_middle_less_half_the_thickness(radius: float) -> None:
    procedure = bent(radius)
    fold = find_sharp_fold(procedure.model.mesh, procedure.mechanics, procedure.state)
    assert fold is not None
    assert fold.inner_radius == pytest.approx(radius - 0.5 * THICKNESS, abs=1e-6)
    assert np.hypot(fold.place[0], fold.place[2] - radius) == pytest.approx(radius, rel=0.03)
    told = find_remedy(replace(procedure.model, analysis="stamping"), 0, fold)
    assert "Leave the fold room" in told
    assert "inertia" not in told


def test_a_bend_of_a_thickness_inside_is_no_sharp_fold() -> None:
    procedure = bent(1.5)
    assert find_sharp_fold(procedure.model.mesh, procedure.mechanics, procedure.state) is None
