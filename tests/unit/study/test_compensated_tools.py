# SPDX-License-Identifier: Apache-2.0
"""Bent tools keep what lies under a holder that stays, end near the blank, and keep their strokes."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomli_w

from presswork.api import build
from presswork.case import CaseError, StampingCase
from presswork.geometry.foot_on_triangles import split_long
from presswork.geometry.rigid_warp import RigidWarp
from presswork.model import FloatArray, ToolKind, Triangulation
from presswork.study.compensate import _Search
from presswork.study.compensated_tools import (
    PressedTool,
    bend_tools,
    cut_into_triangles,
    find_gap_change,
    find_room,
    find_undercut,
    place_tools,
)
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
    part = channel_face(0.0, reach=60.0).points
    changed = [find_gap_change((lower, holder), as_drawn, part, 3.0) for lower in (die, alone)]
    assert changed[0] < 0.4 * changed[1]
    assert find_gap_change((die, punch), (tools[0], tools[1]), part, 3.0) < 0.02


def test_a_gap_counts_where_the_part_lies(tools, warp) -> None:
    """Half of the part is looked at: tools that are bent in the other half keep their gap."""
    die, punch, _ = tools
    part = channel_face(0.0, reach=60.0).points
    far = np.where(punch.shape.points[:, :1] < -3.0, [0.0, 0.0, 0.5], 0.0)
    bent = replace(punch, shape=replace(punch.shape, points=punch.shape.points + far))
    assert find_gap_change((die, bent), (die, punch), part[part[:, 0] > 3.0], 3.0) == 0.0
    assert find_gap_change((die, bent), (die, punch), part, 3.0) == pytest.approx(0.5, rel=0.05)


def turn_walls(points: FloatArray, angle: float) -> FloatArray:
    """Return places with the part's walls turned inwards about their top by an angle [degree], the bottom kept level.

    Their bottom comes to lie farther out, so above a draft of 15 degrees they lean over.
    """
    sink = np.clip(-points[:, 2], 0.0, 16.0)
    out = np.sign(points[:, 0]) * np.tan(np.radians(angle)) * sink
    return points + np.column_stack([out, np.zeros((len(points), 2))])


def test_tools_that_lean_over_leave_less_room_along_the_stroke(tools) -> None:
    """Walls of 75 degrees: turned by 10 they still open upwards, turned by 35 the punch's bottom does not pass."""
    die, punch, _ = tools
    room = []
    for angle in (0.0, 10.0, 35.0):
        bent = [replace(t, shape=replace(t.shape, points=turn_walls(t.shape.points, angle))) for t in (die, punch)]
        room.append(find_room(bent, (die, punch), 1.0, 16.0))
    assert room[0] == pytest.approx(1.1, abs=0.02)
    assert room[1] > 0.9
    assert room[2] < 0.5


def test_a_punch_may_lean_over_above_the_parts_wall(tools) -> None:
    """A punch goes up straight from its wall's end: turned by 5 degrees, that lean is no undercut of the part."""
    _, punch, _ = tools
    rim = np.array([[12.0, y, z] for z in (0.0, 8.0) for y in (-3.0, 0.0, 3.0)])
    cells = np.array([[0, 4, 3], [0, 1, 4], [1, 5, 4], [1, 2, 5]], dtype=np.int32)
    inwards = rim - np.tan(np.radians(5.0)) * np.column_stack([rim[:, 2], np.zeros((6, 2))])
    straight, leaning = (replace(punch, shape=Triangulation(points, cells, False)) for points in (rim, inwards))
    found = [find_undercut((leaning,), (straight,), rim, 5.0, uprights=uprights).angle for uprights in (True, False)]
    assert found == [pytest.approx(5.0, abs=0.01), 0.0]


def test_tools_end_near_the_blank_and_their_strokes_stay_near_those_as_drawn(tmp_path) -> None:
    """A strip's tools are drawn to 1.5 times the blank; a part bent at its edge must not lift their far ends."""
    case = load_hat(tmp_path)
    model = build(case)
    drawn = cut_into_triangles(model, 4.0, 1.0)
    for tool in drawn:
        assert np.abs(tool.shape.points[:, 0]).max() < 50.0 + 5.0 + 2.0 * 4.0 + 1e-6
        mirrored = np.unique(np.round(tool.shape.points * [-1.0, 1.0, 1.0], 6) + 0.0, axis=0)
        assert np.array_equal(mirrored, np.unique(np.round(tool.shape.points, 6) + 0.0, axis=0))
    points = model.mesh.points
    bent = points + np.maximum(points[:, :1] - 30.0, 0.0) * [0.0, 0.0, -0.3]
    moved = bend_tools(drawn, RigidWarp(points, bent, model.symmetry), 1.0)
    data = tomllib.loads(case.text)
    given, lower = place_tools(case, data, moved, drawn, {tool.name: f"{tool.name}.stl" for tool in moved})
    stroke = given["stages"][-1]["tools"]["punch"]["stroke"]
    assert 20.0 <= stroke < 20.0 + 1.0, "the far ends of die and holder must not lengthen it"
    assert np.abs(lower).max() < 1.0


def test_a_holder_that_starts_farther_off_is_closed_by_distance_first(tmp_path) -> None:
    """Bent binders stand farther from each other than the flat blank is thick; a force would slam them."""
    case = load_hat(tmp_path)
    drawn = cut_into_triangles(build(case), 4.0, 1.0)
    after, before = ["draw"], ["draw_closing", "draw"]
    for bent, slams, names in ((0.6, {}, after), (0.6, {"slams": 0.5}, before), (2.0, {}, before)):
        ends = [np.where(np.abs(t.shape.points[:, :1]) > 40.0, [0.0, 0.0, -bent], 0.0) for t in drawn]
        shapes = [replace(t.shape, points=t.shape.points + end) for t, end in zip(drawn, ends, strict=True)]
        moved = [replace(t, shape=shape) for t, shape in zip(drawn, shapes, strict=True)]
        paths = {t.name: f"{t.name}.stl" for t in drawn}
        given, _ = place_tools(case, tomllib.loads(case.text), moved, drawn, paths, **slams)
        assert [stage["name"] for stage in given["stages"]] == names
    assert given["stages"][0]["tools"] == {"holder": {"close": pytest.approx(1.05)}}
    assert given["stages"][1]["tools"]["holder"] == {"force": 1000.0}


def test_bent_tools_with_too_little_room_are_run_anyway(tmp_path, caplog) -> None:
    """A punch widened by 1 mm a side leaves 0.2 mm beside a sheet of 1 mm: refused as drawn, warned of when bent."""
    load_hat(tmp_path)
    search = _Search(tmp_path / "hat.toml", (), 0.1, None, "mm", fix_binder=False)
    search.open_folder(tmp_path / "out", resume=False, overwrite=False)
    wide = np.array([26.0 / 25.0, 1.0, 1.0])
    tools = tuple(
        replace(t, shape=replace(t.shape, points=t.shape.points * wide)) if t.kind == "punch" else t
        for t in search.drawn
    )
    with pytest.raises(CaseError, match="leaves less than the blank's 1 mm"):
        search.build_loop(0, tools)
    assert "leaves less than" not in caplog.text
    model, _ = search.build_loop(1, tools)
    assert not model.limits.stop
    assert "leaves less than the blank's 1 mm" in caplog.text


def load_hat(folder):
    """Return a hat between strip tools of 50 and 52.4 mm with a holder."""
    tool = {"shape": "strip", "edge_radius": 5}
    data = {
        "title": "hat", "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [100, 8], "thickness": 1, "element_size": 4, "material": "dp600",
                  "symmetry": ["x"]},
        "tools": {"punch": {"kind": "punch", "width": 50, **tool}, "die": {"kind": "die", "width": 52.4, **tool},
                  "holder": {"kind": "holder", "width": 52.4, **tool}},
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 20}, "holder": {"force": 1000.0}}}],
        "springback": {},
    }  # fmt: skip
    path = folder / "hat.toml"
    path.write_text(tomli_w.dumps(data))
    return StampingCase.from_toml(path)
