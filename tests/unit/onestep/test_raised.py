# SPDX-License-Identifier: Apache-2.0
"""Raised parts: what of a cup stays, what goes with the punch, and where the sheet lies on it."""

import numpy as np
import pytest

from presswork.onestep.part import prepare_part
from presswork.onestep.raised import RaisedSurface, carry_nodes, find_raise
from tests.problems.one_step import cup_profile, fan, revolve

RADIUS, EDGE, DEPTH, AROUND, THICKNESS = 25.0, 5.0, 24.0, 48, 0.8


@pytest.fixture(scope="module")
def cup():
    points, quads = revolve(cup_profile(RADIUS, EDGE, DEPTH, 36.0, 1.25), AROUND)
    return prepare_part(points, fan(AROUND), quads), points, quads


def raise_cup(cup, thickness=THICKNESS):
    part, points, _ = cup
    z = points[:, 2]
    return find_raise(part, z > z.max() - 0.01, z < z.min() + 0.01, thickness)


def test_the_straight_wall_takes_what_the_bottom_is_raised_by(cup):
    share, way = raise_cup(cup)
    z = cup[1][:, 2] - cup[1][:, 2].min()
    by_height = [share[np.abs(z - at).argmin()] for at in (EDGE, 0.5 * DEPTH, DEPTH - EDGE)]
    assert by_height == pytest.approx([1.0, 0.5, 0.0], abs=0.1)
    wall = DEPTH - 2.0 * EDGE
    assert way == pytest.approx(wall, rel=0.1)
    rows = share[1:].reshape(-1, AROUND)
    assert np.ptp(rows, axis=1).max() < 1e-6
    assert (np.diff(rows[:, 0]) < 1e-12).all()


def test_a_flat_part_cannot_be_raised():
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(16)])
    index = np.arange(16).reshape(4, 4)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    part = prepare_part(points, quads[:0, :3].astype(np.int32), quads.astype(np.int32))
    edge = points[:, 0] == 0.0
    share, way = find_raise(part, edge, points[:, 0] == 3.0, 0.8)
    assert way == 0.0
    assert not share.any()


def test_the_surface_is_round_between_the_nodes(cup):
    """Points halfway between nodes of the edge radius lie on its circle, to the fourth order of the angle between."""
    part, points, quads = cup
    triangles = np.concatenate([fan(AROUND), quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    rows = points[1:].reshape(-1, AROUND, 3)[:, 0]
    on_edge = np.flatnonzero((rows[:, 2] < rows[:, 2].min() + EDGE - 0.5) & (rows[:, 0] > RADIUS - EDGE + 0.5))
    halfway = 0.5 * (rows[on_edge[:-1]] + rows[on_edge[1:]])
    placed, normals = RaisedSurface(part, triangles, THICKNESS).place(halfway, None)
    centre = np.array([RADIUS - EDGE, 0.0, rows[:, 2].min() + EDGE])
    chord = EDGE - np.linalg.norm(halfway - centre, axis=1)
    assert chord.max() > 0.03
    assert np.linalg.norm(placed - centre, axis=1) == pytest.approx(EDGE, abs=0.06 * chord.max())
    assert np.abs((normals * (placed - centre)).sum(axis=1)) == pytest.approx(EDGE, rel=1e-3)


def test_metal_goes_on_beyond_the_rim():
    """A sheet that was shifted: metal inside follows it, metal beyond its rim keeps its way to the rim."""
    rng = np.random.default_rng(0)
    flat = rng.uniform(-1.0, 1.0, (40, 2))
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    sheet = np.column_stack([0.5 * corners + [3.0, 2.0], np.full(4, 7.0)])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    carried = carry_nodes(flat, corners, sheet, triangles)
    assert carried == pytest.approx(np.column_stack([0.5 * flat + [3.0, 2.0], np.full(40, 7.0)]), abs=1e-12)
    beyond = carry_nodes(np.array([[1.5, 0.25]]), corners, sheet, triangles)
    assert beyond == pytest.approx(np.array([[4.0, 2.125, 7.0]]), abs=1e-12)
