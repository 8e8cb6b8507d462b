# SPDX-License-Identifier: Apache-2.0
"""Tools made from a part: held against the closed forms of a round cup, a rectangular pan and a hat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.geometry.foot_on_triangles import split_long
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.files.stl_file import pack_stl
from presswork.mesh.files.tool_file import read_tool
from presswork.model import FloatArray, OneStepModel, Triangulation
from presswork.onestep.offset_tools import CLEARANCE, OffsetTools, _smallest_radius, offset_tools
from presswork.onestep.process import Process
from presswork.onestep.stamping_case import _describe_stages
from tests.problems.one_step import NO_TRIANGLES, cup_profile, fan, make_model, revolve
from validation.stamped_parts import draw_face, draw_part

T, RADIUS, CORNER, DEPTH, FLANGE = 0.8, 25.0, 5.0, 20.0, 42.0


def cup() -> OneStepModel:
    points, quads = revolve(cup_profile(RADIUS, CORNER, DEPTH, FLANGE, 1.0), 96)
    return make_model(points, fan(96), quads, thickness=T)


def pan(half: tuple[float, float] = (40.0, 25.0)) -> OneStepModel:
    """A pan of mid-surface half widths with corners of 10 mm in the plan: a cup drawn apart at its quarters."""
    corner = 10.0
    points, quads = revolve(cup_profile(corner, CORNER, DEPTH, corner + 15.0, 1.0), 96)
    away = np.array(half) - corner
    shift = np.where(points[:, :2] > 1e-9, away, np.where(points[:, :2] < -1e-9, -away, 0.0))
    return make_model(points + np.pad(shift, ((0, 0), (0, 1))), fan(96), quads, thickness=T)


def hat() -> OneStepModel:
    """A channel along y with two flanges, open at both ends."""
    half = cup_profile(RADIUS, CORNER, DEPTH, FLANGE, 1.0)
    line = np.concatenate([half[:0:-1] * [-1.0, 1.0], half])
    y = np.linspace(-15.0, 15.0, 13)
    points = np.array([[x, b, z] for x, z in line for b in y])
    index = np.arange(len(points)).reshape(len(line), len(y))
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    return make_model(points, NO_TRIANGLES, quads.astype(np.int32), thickness=T)


PARTS = {"cup": cup, "pan": pan, "hat": hat}


@pytest.fixture(scope="module", params=PARTS)
def made(request) -> tuple[OneStepModel, OffsetTools]:
    model = PARTS[request.param]()
    return model, offset_tools(model, 70.0)


def curved_panel() -> OneStepModel:
    """A panel whose flange bends to a radius of 600 mm, 10 degrees at its ends."""
    part = replace(draw_part(7), binder_radius=600.0, thickness=T)
    face = draw_face(part, 0.0)
    return make_model(face.points, face.triangles, np.zeros((0, 4), dtype=np.int32), thickness=T)


def test_a_curved_flange_has_a_holder_that_leaves_the_thickness_all_round(tmp_path) -> None:
    model = curved_panel()
    tools = offset_tools(model, 150.0)
    assert tools.notes == ()
    for kind, down in (("punch", -1.0), ("die", 1.0), ("holder", -1.0)):
        path = tmp_path / f"{kind}.stl"
        path.write_bytes(pack_stl(kind, tools.faces[kind]))
        read_tool(path, facing=(0.0, 0.0, down))  # says that it faces neither way where walls outweigh its face
    holder = find(tools, "holder")
    under = holder.points[holder.points[:, 2] < model.points[:, 2].max() + 0.6 * T]
    over_part = under[(np.abs(under[:, :2]) < np.abs(model.points[:, :2]).max(axis=0)).all(axis=1)]
    gap = make_surface(find(tools, "die")).nearest(np.ascontiguousarray(over_part))[0]
    assert len(over_part) > 200
    assert gap.min() > T - 0.02, "nowhere nearer to the die than the sheet is thick"
    pressing = over_part[gap < T + 0.02]  # all but the rolled edge
    around = np.degrees(np.arctan2(pressing[:, 1], pressing[:, 0]))
    assert np.histogram(around, 12, (-180.0, 180.0))[0].min() > 5, "all round the part"


def test_the_flange_under_a_holder_is_found_on_open_and_curved_parts() -> None:
    """A hat's outline is mostly its section; the flange of the curved panel falls by 10 degrees to both sides."""
    part = hat()
    process = Process(part)
    held = part.points[process.find_tools(process.shape(part.points)).flange]
    assert held[:, 2].min() == pytest.approx(DEPTH)
    assert np.abs(held[:, 0]).min() == pytest.approx(RADIUS + CORNER, abs=1.0)
    panel = curved_panel()
    process = Process(panel)
    held = panel.points[process.find_tools(process.shape(panel.points)).flange]
    assert np.ptp(held[:, 2]) > 5.0 * T
    around = np.degrees(np.arctan2(held[:, 1], held[:, 0]))
    assert np.histogram(around, 12, (-180.0, 180.0))[0].min() > 5, "all round the part"


@pytest.mark.parametrize(("make", "force", "stages"), [
    (curved_panel, 1e4, [{"holder": {"close": 0.84}}, {"punch": {}, "holder": {"force": 1e4}}]),
    (curved_panel, 0.0, [{"holder": {"close": 0.88}}, {"punch": {}}]),
    (hat, 1e4, [{"punch": {}, "holder": {"force": 1e4}}]),
])  # fmt: skip
def test_a_written_case_wraps_the_blank_round_a_curved_binder_first(make, force, stages) -> None:
    model = replace(make(), holder_force=force)
    made = offset_tools(model, 150.0)
    found = [stage["tools"] for stage in _describe_stages({"holder": {}}, made, model)]
    assert found[-1]["punch"].pop("stroke") == pytest.approx(made.stroke, rel=1e-5)
    assert found == stages


def find(tools: OffsetTools, kind: str) -> Triangulation:
    return tools.faces[kind]


def test_the_stroke_is_the_parts_depth(made) -> None:
    assert made[1].stroke == pytest.approx(DEPTH, abs=1e-3)
    assert made[1].notes == ()
    assert made[1].smallest_radius == pytest.approx(CORNER, rel=0.25), "of a mesh of chords"


def test_faces_lie_half_a_thickness_off_the_part_and_the_die_farther_by_the_clearance(made) -> None:
    model, tools = made
    punch, die, holder = (find(tools, kind).points for kind in ("punch", "die", "holder"))
    assert punch[:, 2].min() == pytest.approx(0.5 * T, abs=2e-3)
    assert die[:, 2].min() == pytest.approx(-(0.5 + CLEARANCE) * T, abs=2e-3)
    assert die[:, 2].max() == pytest.approx(DEPTH - 0.5 * T, abs=2e-3)
    assert holder[:, 2].min() == pytest.approx(DEPTH + 0.5 * T)
    width = float(np.abs(model.points[np.abs(model.points[:, 2] - DEPTH / 2) < 3.0, 0]).max())
    wall = [np.abs(p[(p[:, 2] > 8.0) & (p[:, 2] < 12.0), 0]).max() for p in (punch, die)]
    assert wall == pytest.approx([width - 0.5 * T, width + (0.5 + CLEARANCE) * T], abs=2e-3)
    assert np.abs(punch[:, 0]).max() == pytest.approx(width - 0.5 * T, abs=0.02), "without the shoulder"


def test_the_holder_ends_where_the_dies_shoulder_begins_and_both_reach_beyond_the_blank(made) -> None:
    model, tools = made
    holder, die = find(tools, "holder"), find(tools, "die")
    pressing = holder.points[np.abs(holder.points[:, 2] - DEPTH - 0.5 * T) < 1e-9]
    inner = float(np.abs(model.points[np.abs(model.points[:, 2] - DEPTH / 2) < 3.0, 0]).max()) + CORNER
    at_middle = pressing[np.abs(pressing[:, 1]) < 2.0]
    assert np.abs(at_middle[:, 0]).min() == pytest.approx(inner, abs=0.1)
    for tool in (holder, die):
        assert np.abs(tool.points[:, 0]).max() > 70.0


def test_punch_in_the_die_leaves_the_sheet_its_room(made, tmp_path) -> None:
    """Read from their files as a stamping reads them; at the end of the stroke, everywhere."""
    read = {}
    for kind, tool in made[1].faces.items():
        (tmp_path / f"{kind}.stl").write_bytes(pack_stl(kind, tool))
        facing = (0.0, 0.0, 1.0 if kind == "die" else -1.0)
        read[kind], notes = read_tool(tmp_path / f"{kind}.stl", facing=facing)
        assert not any("turned over" in note or "no area" in note for note in notes), notes
    gap = make_surface(read["die"]).nearest(read["punch"].points)[0]
    assert gap.min() > T, "facets lie nearer than the arcs that they stand for"
    low = read["punch"].points[:, 2] < DEPTH / 2
    assert gap[low].max() < (1.0 + 2.0 * CLEARANCE) * T


def test_offsets_of_arcs_are_exact(made) -> None:
    """The punch's edge radius is that of the part less half the thickness."""
    punch: FloatArray = find(made[1], "punch").points
    section = punch[(np.abs(punch[:, 1]) < 0.5) & (punch[:, 2] < CORNER - 0.3) & (punch[:, 2] > 0.5 * T + 0.1)]
    width = float(np.abs(made[0].points[np.abs(made[0].points[:, 2] - DEPTH / 2) < 3.0, 0]).max())
    section = section[np.abs(section[:, 0]) > width - CORNER]
    assert len(section) > 4
    distance = np.hypot(np.abs(section[:, 0]) - (width - CORNER), section[:, 2] - CORNER)
    assert distance == pytest.approx(CORNER - 0.5 * T, abs=0.02)


def test_a_symmetric_part_has_whole_tools() -> None:
    model = cup()
    kept = (model.points[:, 0] > -1e-9) & (model.points[:, 1] > -1e-9)
    number = np.cumsum(kept) - 1
    quads = number[model.quadrilaterals[kept[model.quadrilaterals].all(axis=1)]].astype(np.int32)
    triangles = number[model.triangles[kept[model.triangles].all(axis=1)]].astype(np.int32)
    quarter = make_model(model.points[kept], triangles, quads, thickness=T, symmetry=(True, True))
    tools = offset_tools(quarter, 70.0)
    whole = offset_tools(model, 70.0)
    for kind in ("punch", "die", "holder"):
        found, wanted = find(tools, kind).points, find(whole, kind).points
        assert found.min(axis=0) == pytest.approx(wanted.min(axis=0), abs=0.05)
        assert found.max(axis=0) == pytest.approx(wanted.max(axis=0), abs=0.05)


def test_a_part_without_a_flange_has_no_holder_and_says_so() -> None:
    points, quads = revolve(cup_profile(RADIUS, CORNER, DEPTH, FLANGE, 1.0), 48)
    kept = quads[(points[quads][:, :, 2] < 12.0).all(axis=1)]
    used, index = np.unique(np.concatenate([fan(48).ravel(), kept.ravel()]), return_inverse=True)
    triangles, cells = index[: 3 * 48].reshape(-1, 3), index[3 * 48 :].reshape(-1, 4)
    model = make_model(points[used], triangles.astype(np.int32), cells.astype(np.int32), thickness=T)
    tools = offset_tools(model, 60.0)
    assert list(tools.faces) == ["punch", "die"]
    assert "no level flange" in tools.notes[0]


def test_radii_that_the_sheet_cannot_have_are_told() -> None:
    points, quads = revolve(cup_profile(RADIUS, 0.3, DEPTH, FLANGE, 0.1), 48)
    tools = offset_tools(make_model(points, fan(48), quads, thickness=T), 70.0)
    assert any("fold over" in note for note in tools.notes)


@pytest.mark.parametrize("longest", [50.0, 1.5, 0.4])
def test_the_least_radius_is_that_of_the_chords_however_they_were_halved(longest: float) -> None:
    """Seven chords of a quarter circle of 5 mm between two planes, straight on for 20 mm."""
    angle = np.radians(np.linspace(0.0, 90.0, 8))
    arc = 5.0 * np.column_stack([np.sin(angle), np.cos(angle)])
    line = np.concatenate([[[-20.0, 5.0]], arc, [[5.0, -20.0]]])
    points = np.array([[x, y, z] for x, z in line for y in (0.0, 20.0)])
    index = np.arange(len(points)).reshape(-1, 2)
    quads = np.stack([index[:-1, 0], index[1:, 0], index[1:, 1], index[:-1, 1]], axis=-1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    points, triangles = split_long(points, triangles, longest)
    assert _smallest_radius(points, triangles) == pytest.approx(5.0, rel=0.01)
