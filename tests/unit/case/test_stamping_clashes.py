# SPDX-License-Identifier: Apache-2.0
"""Stampings whose tools cannot do what the stages ask are refused before anything is computed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model, describe
from presswork.geometry.swept_tool import draw_die, draw_holder, draw_punch, triangulate
from tests.unit.case.round_cup import CUP, changed

DRAW = {"name": "draw", "tools": {"punch": {"stroke": 20}}}


def build(*changes: tuple[str, object]) -> None:
    build_model(StampingCase.model_validate(changed(CUP, *changes)))


def refuse(fragments: list[str], *changes: tuple[str, object]) -> None:
    with pytest.raises(CaseError) as error:
        build(*changes)
    for fragment in fragments:
        assert fragment in str(error.value)


@pytest.mark.parametrize(("size", "fragments"), [
    ([2, 0], ["blank.element_size", "> 0"]),
    ([2, -1], ["blank.element_size", "> 0"]),
    (-1, ["blank.element_size", "> 0"]),
    ([2, 60], ["blank.element_size = 60", "larger than half of the blank, 50 mm"]),
    ([0.01, 0.01], ["blank.element_size", "elements, more than memory will hold"]),
    ([2, "1 kg"], ["blank.element_size", "a length", "mass"]),
    ([2, 1, 1], ["blank.element_size", "[x, y], two values"]),
    ("wide", ["blank.element_size", "expected a length"]),
])  # fmt: skip
def test_sides_of_elements_that_fit_no_rectangle_are_refused(size, fragments) -> None:
    blank = {key: value for key, value in CUP["blank"].items() if key != "diameter"}
    refuse(fragments, ("blank", blank | {"shape": "rectangle", "size": [100, 40], "element_size": size}))


@pytest.mark.parametrize(("path", "value", "fragments"), [
    ("tools.punch.diameter", 60, ["tools.punch", "negative", "are their kinds swapped?"]),
    ("tools.punch.kind", "die", ["tools.punch.kind", "called punch, but is a die"]),
    ("tools.die.face_width", 6, ["tools.die.face_width", "wider than its edge radius of 6 mm"]),
    ("blank.element_size", 60, ["blank.element_size", "larger than half of the blank, 50 mm"]),
    ("blank.diameter", 52, ["tools.die.diameter", "falls through the opening of die, by 0.25 mm"]),
    ("blank.diameter", 53, ["tools.holder.diameter", "smaller than the opening of holder, by 0.5 mm"]),
    ("stages.0.tools.holder.force", 0, ["stages.0.tools.holder.force", "cannot close"]),
    ("stages.0.tools.holder.force", "10 MN", ["stages.0.tools.holder.force", "the sheet yields at 200 MPa", "10 kN"]),
    ("tools.holder.position", [0, 0, 30], ["tools.holder.position", "pushed", "starts 29.6 mm off the blank"]),
    ("tools.punch.position", [0, 0, 1e5],
     ["tools.punch.position = [0.0, 0.0, 100000.0]", "starts 1e+05 mm off the blank and moves 20 mm", "longer"]),
    ("tools.die.position", [0, 0, -40], ["tools.die.position", "the die starts 39.6 mm off", "never touches it"]),
    ("tools.punch.position", [0, 0, -5], ["tools.punch.position = [0.0, 0.0, -5.0]", "starts in the blank", "move it"]),
    ("stages.0.velocity", 2e6, ["stages.0.velocity = 2000000.0", "waves in the sheet", '"2 m/s" is usual']),
    ("stages.0.duration", 1e-9, ["stages.0.duration = 1e-09", "20 mm at 2.22e+10 mm/s", "numbers are mm/s and s"]),
    ("materials.steel.young", 206, ["materials.steel.young = 206", "of no metal", '"206 GPa"']),
    ("materials.steel.young", "206000 GPa", ["materials.steel.young", "of no metal", '"206 GPa"']),
    ("materials.steel.hardening.yield_stress", 200e6,
     ["materials.steel.hardening", "is 2e+08 MPa", "of Young's modulus", "plain numbers are MPa"]),
    ("tools.die.mu", 1.4, ["tools.die.mu", "< 1"]),
    ("materials.steel.forming_limit", {"law": "keeler"}, ["forming_limit.n", "missing key"]),
    ("materials.steel.forming_limit", {"law": "points", "points": [[0, 0.3]]}, ["forming_limit.points", "two points"]),
])  # fmt: skip
def test_bad_input_is_named(path, value, fragments) -> None:
    refuse(fragments, (path, value))


def write_plate(path: Path, *starts: tuple[float, float], size: tuple[float, float]) -> str:
    """Write plates at z = 0 that look down, each from its start."""
    facets = ""
    for x, y in starts:
        plan = [(x, y), (x + size[0], y), (x + size[0], y + size[1]), (x, y + size[1])]
        for face in ((0, 2, 1), (0, 3, 2)):
            corners = "".join(f"vertex {plan[i][0]} {plan[i][1]} 0\n" for i in face)
            facets += f"facet normal 0 0 -1\nouter loop\n{corners}endloop\nendfacet\n"
    path.write_text(f"solid plate\n{facets}endsolid plate\n")
    return str(path)


def test_a_pushed_tool_from_a_file_that_lies_beside_the_blank_is_told_so(tmp_path: Path) -> None:
    path = write_plate(tmp_path / "pad.stl", (60, -60), (-80, -60), size=(20, 120))
    pad = {"kind": "holder", "shape": "file", "path": path}
    refuse(["tools.pad:", "no part of it lies over the blank: the nearest is", "check the unit and the place"],
           ("tools.pad", pad), ("stages.0.tools.pad", {"force": 1e3}), ("blank.symmetry", []))  # fmt: skip


def test_a_tool_between_the_nodes_of_the_blank_is_over_it(tmp_path: Path) -> None:
    """A plate of 2 mm on elements of some 5 mm; and one beside the blank."""
    path = write_plate(tmp_path / "pin.stl", (11.5, 11.5), size=(2, 2))
    pin = {"kind": "punch", "shape": "file", "path": path, "position": [0, 0, 10]}
    stroke = ("stages.0.tools.pin", {"stroke": 12})
    build(("tools.pin", pin), stroke)
    refuse(["tools.pin.position", "no part of the punch lies over the blank"],
           ("tools.pin", pin | {"position": [200, 0, 10]}), stroke)  # fmt: skip


def test_a_punch_off_the_blank_may_come_to_it_by_its_own_way_or_the_die_s() -> None:
    """30 mm off: 31 mm of stroke are enough, and so are 20 mm of its own and 12 mm of a die that lifts the blank."""
    high, held = ("tools.punch.position", [0, 0, 30.4]), ("stages.0.tools.holder.force", 1e4)
    build(high, held, ("stages.0.tools.punch.stroke", 31))
    build(high, held, ("stages.0.tools.die", {"stroke": 12}))
    refuse(["tools.punch.position", "30 mm off"], high, held, ("stages.0.tools.die", {"stroke": 9}))


def test_a_holder_must_come_near_the_sheet_and_leave_it_its_thickness() -> None:
    stage = ("stages.0", DRAW)
    build(stage, ("tools.holder.gap", 1.1))
    refuse(["tools.holder.gap", "never comes nearer to the die than 2 thicknesses"], stage, ("tools.holder.gap", 2))
    high = ("tools.holder.position", [0, 0, 5])
    refuse(["tools.holder.position", "holds nothing"], stage, high)
    close = {"name": "close", "tools": {"holder": {"stroke": 4.6}}}
    build(("stages", [close, DRAW]), high)
    close["tools"] = {"holder": {"stroke": 4.8}}
    refuse(["stages.0.tools.holder.stroke", "goes 0.12 mm further"], ("stages", [close, DRAW]), high)
    build(("stages", [DRAW, {"name": "open", "tools": {"holder": {"stroke": -9}}}]))


def test_a_pressure_counts_the_flange_of_the_whole_part() -> None:
    """200 MPa on the ring beyond the holder's edge radius, 28 to 50 mm: 1078 kN, and the mesh is coarse."""
    build(("stages.0.tools.holder.force", 950e3))
    refuse(["press the flange"], ("stages.0.tools.holder.force", 1200e3))


def write_stl(path: Path, points: np.ndarray, triangles: np.ndarray) -> dict[str, str]:
    facets = (
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*p) for p in points[t])
        + "endloop\nendfacet\n" for t in triangles
    )  # fmt: skip
    path.write_text("solid tool\n" + "".join(facets) + "endsolid tool\n")
    return {"shape": "file", "path": str(path)}


def test_the_unit_suggested_for_a_tool_is_that_which_fits_the_blank(tmp_path) -> None:
    """5.3 across in the file's numbers, a blank of 100 mm: 134 mm in inches come nearer to it than 53 in cm."""
    punch = write_stl(tmp_path / "punch.stl", np.array([[0, 0, 0], [5.2, 0, 0], [0, 1, 0]]), np.array([[0, 2, 1]]))
    refuse(['give its unit: "inch" (134.5 mm) or "cm" (52.95 mm)'],
           ("tools.punch", {"kind": "punch", **punch, "unit": "um"}))  # fmt: skip


def write_closed_die(folder: Path) -> list[tuple[str, object]]:
    """A die from a file with a bottom 18 mm below its face: with a blank of 0.8 mm 18 mm of stroke are all there is."""
    points, triangles = triangulate(draw_die((26.25, 26.25), 26.25, 6.0, width=60.0, depth=18.0), 0.05)
    low = np.flatnonzero(points[:, 2] < -18 + 1e-6)
    order = low[np.argsort(np.arctan2(points[low, 1], points[low, 0]))]
    bottom = [[len(points), a, b] for a, b in zip(order, np.roll(order, -1), strict=True)]
    die = write_stl(folder / "die.stl", np.vstack([points, [0, 0, -18]]), np.vstack([triangles, bottom]))
    return [("tools.die", {"kind": "die", **die})]


def test_a_stroke_deeper_than_the_die_is_refused_with_the_stroke_at_which_tools_close(tmp_path) -> None:
    """A twentieth of the thickness is left to facets: 18.04 mm."""
    die = write_closed_die(tmp_path)
    key = "stages.0.tools.punch.stroke"
    build(*die, (key, 18.0))
    for stroke, further in ((18.16, "0.12"), (18.5, "0.46"), (22, "3.96"), (60, "42")):
        refuse(
            [f"{key} = {stroke:g}", "after 18.04 mm of stroke punch leaves less than the blank's 0.8 mm to die",
             f"goes {further} mm further", "shorten the stroke to 18.04", "limits.stop = false"],
            *die, (key, stroke),
        )  # fmt: skip
    refuse(["punch", "die", "swapped"], *die, ("tools.punch.diameter", 55), ("tools.holder.diameter", 58))


def test_tools_that_close_in_a_later_stage_are_refused_there(tmp_path) -> None:
    stages = [{"name": n, "tools": {"punch": {"stroke": s}}} for n, s in (("draw", 15), ("up", -5), ("set", 9))]
    die = write_closed_die(tmp_path)
    refuse(
        ["stages.2.tools.punch.stroke = 9", "after 18.04 mm", "shorten the stroke to 8.04"], *die, ("stages", stages)
    )
    stages[2]["tools"] = {"punch": {"stroke": 8}}
    build(*die, ("stages", stages))


def test_limits_that_do_not_stop_let_tools_close_with_a_warning(tmp_path, caplog) -> None:
    build(*write_closed_die(tmp_path), ("stages.0.tools.punch.stroke", 18.5), ("limits", {"stop": False}))
    assert "leaves less than the blank's 0.8 mm to die" in caplog.text


def test_check_says_after_which_stroke_tools_close(tmp_path) -> None:
    case = StampingCase.model_validate(changed(CUP, *write_closed_die(tmp_path), ("stages.0.tools.punch.stroke", 15)))
    said = describe(build_model(case))
    assert "punch and die close on the sheet when they have come 18.04 mm nearer" in said
    assert "close on the sheet" not in describe(build_model(StampingCase.model_validate(CUP)))


def test_a_tool_from_a_file_has_the_symmetry_of_the_blank(tmp_path) -> None:
    points, triangles = triangulate(draw_punch((25, 25), 25, 5, 30), 0.05)
    there = {"kind": "punch", **write_stl(tmp_path / "there.stl", points, triangles)}
    off = {"kind": "punch", **write_stl(tmp_path / "off.stl", points + np.array([0.4, 0, 0]), triangles)}
    build(("tools.punch", there))
    refuse(
        ["tools.punch", "plane x = 0 cuts this tool", "halves differ, by 0.799 mm at (24.6, 0,"], ("tools.punch", off)
    )
    build(("tools.punch", off), ("blank.symmetry", ["y"]))


def test_a_blank_larger_than_a_holder_from_a_file_is_refused(tmp_path) -> None:
    points, triangles = triangulate(draw_holder((27, 27), 27, 1, width=21, height=10), 0.05)
    holder = {"kind": "holder", **write_stl(tmp_path / "holder.stl", points, triangles)}
    refuse(
        ["tools.holder.path", "the blank is larger than the holder: it reaches 2 mm beyond"], ("tools.holder", holder)
    )
    build(("tools.holder", holder), ("blank.diameter", 95))


def test_a_mesh_too_coarse_for_the_radius_of_a_tool_from_a_file_is_told_as_for_a_drawn_one(tmp_path) -> None:
    """Elements of 6 mm round a radius of 5 mm, 7.85 mm of arc: 1.3 of them."""
    points, triangles = triangulate(draw_punch((25, 25), 25, 5, 30), 0.02)
    from_file = ("tools.punch", {"kind": "punch", **write_stl(tmp_path / "punch.stl", points, triangles)})
    for changes in ([], [from_file]):
        said = describe(build_model(StampingCase.model_validate(changed(CUP, *changes))))
        (hint,) = [line for line in said.splitlines() if line.startswith("hint:") and "edge of punch" in line]
        assert float(hint.split()[1]) == pytest.approx(1.3, abs=0.2)
    fine = describe(build_model(StampingCase.model_validate(changed(CUP, from_file, ("blank.element_size", 2)))))
    assert "edge of punch" not in fine


def test_a_card_that_the_implicit_procedure_would_leave_idle_is_refused():
    refuse(["explicit.device", "explicit procedure alone"], ("procedure", "implicit"), ("explicit", {"device": "cuda"}))
    build(("procedure", "implicit"), ("explicit", {"precision": "single"}))


@pytest.mark.parametrize(("tool", "fault"), [
    ("punch", "punch leaves less than the blank's"), ("holder", "punch strikes holder"),
])  # fmt: skip
def test_drawn_tools_that_stand_beside_each_other_are_refused(tool: str, fault: str) -> None:
    refuse(["stages.0.tools.punch.stroke", fault], ("blank.symmetry", []), (f"tools.{tool}.position", [30, 0, 0.5]))


def test_a_holder_that_is_closed_before_it_is_pushed_may_start_off_the_blank() -> None:
    """By a distance that it closes to, or by a stroke that brings it within a thickness of the blank."""
    high = ("tools.holder.position", [0, 0, 5])
    push = {"name": "draw", "tools": {"punch": {"stroke": 20}, "holder": {"force": 1e4}}}
    build(("stages", [{"name": "close", "tools": {"holder": {"close": 0.9}}}, push]), high)
    build(("stages", [{"name": "close", "tools": {"holder": {"stroke": 4.4}}}, push]), high)
    refuse(["tools.holder.position", "pushed by a force, but starts 2.6 mm off the blank"],
           ("stages", [{"name": "close", "tools": {"holder": {"stroke": 2}}}, push]), high)  # fmt: skip


def test_check_hints_at_a_holder_that_leaves_a_sheet_no_room_to_thicken() -> None:
    """Without a force or a gap the holder stands one thickness off; at a gap of 1.1 thicknesses no warning follows."""

    def find_hint(*changes: tuple[str, Any]) -> bool:
        drawn = changed(CUP, ("stages", [{"name": "draw", "tools": {"punch": {"stroke": 20}}}]), *changes)
        return "hint: holder stands still, 0.8 mm from die" in describe(build_model(StampingCase.model_validate(drawn)))

    assert find_hint()
    assert not find_hint(("tools.holder.gap", 0.88))
    assert not find_hint(("stages.0.tools.holder", {"force": "10 kN"}))
