# SPDX-License-Identifier: Apache-2.0
"""Which shells are split, and where their new nodes lie."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_hemispherical_punch
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.split import SplitMesh
from presswork.model import FloatArray, Refinement
from presswork.process.mesh_change.refinement import PlacedTool, bend_angles, choose_shells, place_nodes, tool_angles

NOWHERE = PlacedTool(make_surface(draw_hemispherical_punch(20.0, 30.0)), np.array([0.0, 0.0, 1e3]))


def sheet(n: int, size: float) -> tuple[SplitMesh, FloatArray]:
    """Flat, n x n shells of this side from the origin on."""
    x, y = np.meshgrid(np.arange(n + 1) * size, np.arange(n + 1) * size)
    first = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)
    return SplitMesh.begin(cells, (n + 1) ** 2), np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)


def on_cylinder(points: FloatArray, radius: float) -> FloatArray:
    angle = points[:, 0] / radius
    return np.stack([radius * np.sin(angle), points[:, 1], radius * np.cos(angle)], axis=1)


def on_sphere(points: FloatArray, radius: float) -> FloatArray:
    height = np.sqrt(radius**2 - points[:, 0] ** 2 - points[:, 1] ** 2)
    return np.column_stack([points[:, :2], height])


def test_the_angle_of_a_bent_sheet_is_side_over_radius_at_every_level() -> None:
    mesh, points = sheet(8, 1.0)
    np.testing.assert_array_equal(bend_angles(mesh, points), 0.0)
    np.testing.assert_allclose(bend_angles(mesh, on_cylinder(points, 10.0)), 0.1, rtol=1e-2)
    step = mesh.split(np.arange(64) % 8 < 4)
    points, mesh = on_cylinder(step.interpolate(points), 10.0), step.mesh
    np.testing.assert_allclose(bend_angles(mesh, points), np.where(mesh.level == 1, 0.05, 0.1), rtol=0.02)


def test_shells_are_split_above_the_angle_as_far_as_there_are_levels() -> None:
    mesh, points = sheet(8, 1.0)
    step = mesh.split(np.arange(64) % 8 < 4)
    points, mesh = on_cylinder(step.interpolate(points), 10.0), step.mesh
    thickness = np.full(len(mesh.cells), 0.5)
    assert not choose_shells(mesh, points, thickness, [NOWHERE], Refinement(2, 0.11)).any()
    coarse = choose_shells(mesh, points, thickness, [NOWHERE], Refinement(2, 0.06))
    np.testing.assert_array_equal(coarse, mesh.level == 0)
    assert choose_shells(mesh, points, thickness, [NOWHERE], Refinement(2, 0.04)).all()
    np.testing.assert_array_equal(
        choose_shells(mesh, points, thickness, [NOWHERE], Refinement(1, 0.04)), mesh.level == 0
    )


def test_a_tool_is_seen_where_it_is_nearly_touched_and_turns() -> None:
    """A hemisphere of radius 20 mm that touches the middle of a flat sheet: near the pole it turns by side over radius,
    and beyond where the gap is a side there is nothing to see."""
    mesh, points = sheet(12, 1.0)
    tool = PlacedTool(make_surface(draw_hemispherical_punch(20.0, 30.0)), np.array([0.0, 0.0, 0.25]))
    angles = tool_angles(mesh, points, np.full(len(mesh.cells), 0.5), tool)
    radius = np.linalg.norm(points[mesh.cells].mean(axis=1), axis=1)
    near = radius < 5.0  # gap 0.25 + 25/40
    np.testing.assert_allclose(angles[near], 1.0 / 20, rtol=0.08)
    assert (angles[radius > 8.5] == 0).all()


@pytest.mark.parametrize("shape", [on_cylinder, on_sphere])
def test_new_nodes_lie_on_the_curved_sheet(shape) -> None:
    """On a cylinder and a sphere, rim aside, within 2 % of what the chords are off."""
    mesh, points = sheet(8, 1.0)
    points, radius = shape(points - [4.0, 4.0, 0.0], 10.0), 10.0
    step = mesh.split(np.ones(64, dtype=bool))
    placed = place_nodes(mesh, step, points, np.full(64, 0.5), [], [NOWHERE])
    np.testing.assert_array_equal(placed[:81], points)
    measured = slice(0, 3, 2) if shape is on_cylinder else slice(0, 3)
    inside = np.flatnonzero((np.abs(placed[81:, 0]) < 2.6) & (np.abs(placed[81:, 1]) < 2.6)) + 81
    off = radius - np.linalg.norm(placed[inside][:, measured], axis=1)
    chord = radius - np.linalg.norm(step.interpolate(points)[inside][:, measured], axis=1)
    assert len(inside) > 30
    assert np.abs(off).max() < 0.02 * chord.max()


def test_new_nodes_are_as_deep_in_a_tool_as_their_parents() -> None:
    """A flat sheet pressed by 0.01 mm into the pole of a hemisphere, and a coarse mesh round one."""
    mesh, points = sheet(8, 1.0)
    points[:, :2] -= 4.0
    tool = PlacedTool(make_surface(draw_hemispherical_punch(50.0, 60.0)), np.array([0.0, 0.0, 0.0]))
    depth = 0.01
    points[:, 2] = 50.0 - np.sqrt((50.0 + 0.25 - depth) ** 2 - points[:, 0] ** 2 - points[:, 1] ** 2)
    step = mesh.split(np.ones(64, dtype=bool))
    placed = place_nodes(mesh, step, points, np.full(64, 0.5), [], [tool])
    gap, _ = tool.nearest(placed, 5.0)
    np.testing.assert_allclose(0.25 - gap, depth, atol=1e-4)
    chord, _ = tool.nearest(step.interpolate(points), 5.0)
    assert (0.25 - chord).max() > depth + 4e-3
