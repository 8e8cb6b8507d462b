# SPDX-License-Identifier: Apache-2.0
"""Bent tools keep what lies under a holder that stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.geometry.foot_on_triangles import split_long
from presswork.geometry.rigid_warp import RigidWarp
from presswork.model import FloatArray, ToolKind, Triangulation
from presswork.study.compensated_tools import PressedTool, bend_tools, find_gap_change
from tests.problems.compensation import channel_face

RIM = 23.0
"""Where the holder begins [mm]."""


def press(kind: ToolKind, up: float, across: tuple[float, float]) -> PressedTool:
    """Return a face of a channel's tools, so far from the middle, of triangles of 1 mm."""
    face = channel_face(up, reach=60.0)
    middle = np.abs(face.points[face.triangles][:, :, 0].mean(axis=1))
    chosen = face.triangles[(middle > across[0]) & (middle < across[1])]
    used, number = np.unique(chosen, return_inverse=True)
    points, triangles = split_long(face.points[used], number.reshape(chosen.shape).astype(np.int32), 1.0)
    return PressedTool(kind, kind, Triangulation(points, triangles, False), np.zeros(3), np.zeros(3))


@pytest.fixture(scope="module")
def tools() -> tuple[PressedTool, ...]:
    return press("die", -0.5, (0.0, 60.0)), press("punch", 0.6, (0.0, 19.0)), press("holder", 0.5, (RIM, 60.0))


@pytest.fixture(scope="module")
def warp() -> RigidWarp:
    """Walls are opened by 5 degrees, which begin within 3 mm and fade over 4 mm towards the binder."""
    middle = channel_face(0.0, reach=60.0)
    points, _ = split_long(middle.points, middle.triangles, 1.0)
    points = points[points[:, 0] >= 0.0]
    turned = (
        np.radians(5.0) * np.clip((points[:, 0] - 14.0) / 3.0, 0.0, 1.0) * np.clip((RIM - points[:, 0]) / 4.0, 0.0, 1.0)
    )
    moved = points + np.column_stack([-turned * points[:, 2], np.zeros(len(points)), turned * (points[:, 0] - 10.0)])
    return RigidWarp(points, moved, (True, False))


def largest_move(tool: PressedTool, before: PressedTool, where: np.ndarray) -> float:
    moved: FloatArray = tool.shape.points - before.shape.points
    return float(np.linalg.norm(moved[where], axis=1).max())


def test_what_lies_under_a_holder_that_stays_stays_too(tools, warp) -> None:
    die, punch, holder = bend_tools(tools, warp, 1.0, fix_holders=True)
    assert holder is tools[2]
    under = np.abs(tools[0].shape.points[:, 0]) >= np.abs(holder.shape.points[:, 0]).min()
    assert largest_move(die, tools[0], under) == 0.0
    assert largest_move(die, tools[0], ~under) > 0.2
    alone = replace(die, shape=replace(die.shape, points=warp.carry(tools[0].closed)))
    as_drawn = (tools[0], holder)
    assert find_gap_change((die, holder), as_drawn, 3.0) < 0.4 * find_gap_change((alone, holder), as_drawn, 3.0)
    assert find_gap_change((die, punch), (tools[0], tools[1]), 3.0) < 0.02
