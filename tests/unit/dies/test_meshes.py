# SPDX-License-Identifier: Apache-2.0
"""Meshes of die bodies: outlines from a profile and an outer contour, rings, and what does not fit."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.dies.meshes import mesh_body
from presswork.mesh import MeshError
from presswork.mesh.checks import corner_jacobians
from presswork.model import DieBody, DiePart
from presswork.post import cell_areas
from tests.problems.die_bodies import STEEL

# the profile of a lower die: a pot whose metal is on its right
POT = np.array([[0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0], [10.0, 0.0, 12.0, 8.0, 0.0, 0.0, 0.0]])


def part(**keys) -> DiePart:
    return DiePart(steel=STEEL, held=("bottom",), **keys)


def test_a_pot_has_metal_below_it() -> None:
    (mesh,) = mesh_body(POT, DieBody(1.0, (part(outer=30.0, bottom=-20.0),)))
    area = 30.0 * 28.0 - 10.0 * 8.0 - 0.5 * 2.0 * 8.0
    assert cell_areas(mesh.points, mesh.cells).sum() == pytest.approx(area, rel=1e-12)
    assert corner_jacobians(mesh.points, mesh.cells[:, :4]).min() > 0.0
    assert mesh.points[mesh.find_side("bottom"), 1] == pytest.approx(-20.0)
    assert np.ptp(mesh.points[mesh.find_side("right"), 1]) == pytest.approx(28.0)


def test_a_dome_with_metal_below_reaches_down_from_the_axis() -> None:
    dome = np.array([[0.0, 8.0, 12.0, 0.0, 0.0, 0.0, 0.0]])
    (mesh,) = mesh_body(dome, DieBody(1.0, (part(outer=12.5, bottom=-20.0),)))
    assert cell_areas(mesh.points, mesh.cells).sum() == pytest.approx(12.5 * 20.0 + 48.0, rel=1e-12)


def test_a_ring_shares_the_nodes_of_the_part_inside_where_they_touch() -> None:
    bore = np.array([[9.0, 0.0, 9.0, 30.0, 0.0, 0.0, 0.0]])
    core, inner, outer = mesh_body(
        bore, DieBody(1.5, (part(outer=20.0), part(outer=32.0, bottom=-5.0, top=25.0), part(outer=50.0, top=40.0)))
    )
    for one, other, x, low, high in ((core, inner, 20.0, 0.0, 25.0), (inner, outer, 32.0, -5.0, 25.0)):
        sides = [m.points[m.find_side(side), 1] for m, side in ((one, "right"), (other, "left"))]
        shared = [np.sort(y[(y > low - 1e-9) & (y < high + 1e-9)]) for y in sides]
        np.testing.assert_allclose(*shared, atol=1e-9)
        assert {low, high} <= {round(float(y), 9) for y in shared[0]}
        assert other.points[:, 0].min() == pytest.approx(x)
    assert cell_areas(outer.points, outer.cells).sum() == pytest.approx(18.0 * 45.0, rel=1e-12)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (DieBody(1.0, (part(outer=11.0, bottom=-20.0),)), "does not match the profile"),
        (DieBody(1.0, (part(outer=30.0, bottom=4.0),)), "does not match the profile"),
        (DieBody(1.0, (part(corners=((0.0, 20.0), (12.0, 20.0))),)), "does not match the profile"),
        (DieBody(1.0, (part(),)), "the profile is open"),
        (DieBody(1.0, (part(outer=30.0, bottom=-20.0), part(outer=25.0))), "sits on x = 30 mm"),
        (DieBody(1.0, (part(outer=30.0, bottom=-20.0), part(outer=40.0, bottom=9.0, top=20.0))), "does not touch"),
        (DieBody(1.0, (part(corners=((0.0, -20.0), (30.0, -10.0))), part(outer=40.0))), "a straight side"),
    ],
)
def test_an_outline_that_does_not_fit_is_refused(body: DieBody, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        mesh_body(POT, body)


def test_a_closed_profile_is_the_body_itself() -> None:
    square = np.array([[0, 0, 0, 10], [0, 10, 10, 10], [10, 10, 10, 0], [10, 0, 0, 0]], dtype=float)
    segments = np.column_stack([square, np.zeros((4, 3))])
    (mesh,) = mesh_body(segments, DieBody(2.0, (part(),)))
    assert cell_areas(mesh.points, mesh.cells).sum() == pytest.approx(100.0)
    with pytest.raises(MeshError, match="leave outer, corners and rings out"):
        mesh_body(segments, DieBody(2.0, (part(outer=20.0),)))
