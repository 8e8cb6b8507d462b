# SPDX-License-Identifier: Apache-2.0
"""Cases of stampings: what they build, and what they refuse."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model, describe, read_case
from presswork.case.description.stamping import describe_stamping
from presswork.examples import copy_example
from presswork.geometry.polygon import polygon_area
from presswork.model import Model
from tests.unit.case import round_cup
from tests.unit.case.round_cup import changed

CUP: dict[str, Any] = changed(
    round_cup.CUP,
    ("blank.thickness", "0.8 mm"),
    ("blank.rolling_direction", 30),
    ("tools.die.mu", 0.05),
    ("stages.0.velocity", "2 m/s"),
)


def build(**changes: Any) -> Model:
    """Build the cup with values changed: dots in a key are written as double underscores."""
    data = changed(CUP, *((path.replace("__", "."), value) for path, value in changes.items()))
    model = build_model(StampingCase.model_validate(data))
    return model


def test_model_holds_what_the_case_says() -> None:
    model = build()
    assert model.whole == 4
    assert model.rolling_direction == pytest.approx((np.sqrt(0.75), 0.5, 0))
    section = model.mesh.blocks[0].section
    assert section is not None
    assert section.thickness == 0.8
    punch, die, holder = model.tools
    assert punch.position == (0, 0, 0.4), "tools just touch the sheet's faces"
    assert die.position == (0, 0, -0.4)
    assert holder.position == (0, 0, 0.4)
    assert (punch.working_direction, die.working_direction, die.friction.mu) == ((0, 0, -1), (0, 0, 1), 0.05)
    stage = model.stages[0]
    assert stage.duration == pytest.approx(0.01 / 0.9)
    assert stage.ramp == pytest.approx(0.1 * stage.duration)
    assert stage.tool_motion["punch"].move == (0, 0, -20)
    force = stage.tool_motion["holder"].push.force
    assert force is not None
    assert force.tolist() == [[0.0, 10e3]]
    words = describe(model)
    for part in ("0.8 mm of steel", "edge radius 5 mm", "holder pushes with 10000 N", "those of the whole", "cycles"):
        assert part in words
    assert "elements round the edge of punch; elements of 2.6 mm would be 3" in words
    assert "limits.penetration may stop the run" in words, "chords of 5.7 mm sink 0.8 mm into a radius of 5"
    assert "may stop the run" not in describe(build(blank__element_size=3.5)), "half the thickness: 4 mm"
    assert "hint" not in describe(build(blank__element_size=2.5))
    assert 'velocities are mm/s, and "2 m/s" is usual' in describe(build(stages__0__velocity=2))


def test_drawn_tools_are_described_by_their_dimensions(tmp_path: Path) -> None:
    line = describe(build_model(read_case(copy_example("press_line", tmp_path))))
    assert "draw_punch: punch, round, 50 mm across, edge radius 6 mm" in line
    assert "flange_die: die, ring, 54 mm across inside and 76 mm outside, edge radius 4 mm" in line
    assert "flange_pad: holder, ring, 54 mm across inside and 70 mm outside, edge radii 1 and 5 mm" in line
    channel = describe(build_model(read_case(copy_example("restruck_channel", tmp_path))))
    assert "draw_die: die, straight along y, 53 mm wide, edge radius 6 mm" in channel
    assert "restrike_punch goes on until it leaves 0.82 mm to restrike_die" in channel
    assert "moves by 1 mm" not in channel
    assert "round the edge of pierce_post" not in line
    assert "  nothing moves: the tools stand where they touch the part" in line
    cup = describe(build_model(read_case(copy_example("square_cup", tmp_path))))
    assert "punch: punch, 51 x 51 mm, corners 10 mm, edge radius 4 mm" in cup


def test_a_cell_with_a_corner_of_180_degrees_is_named_and_sets_the_step(tmp_path: Path) -> None:
    """A plate of 4 x 4 squares of 5 mm; two corners of the last one are moved to 0.3 sqrt(2) mm from each other."""
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 20, 5), np.linspace(0, 20, 5), indexing="ij"))
    points = np.column_stack([x, y, np.zeros(25)])
    number = np.arange(25).reshape(5, 5)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    told = []
    for inner, corner in ((15.0, 20.0), (17.3, 17.6)):
        points[18, :2], points[24, :2] = inner, corner
        meshio.Mesh(points, [("quad", quads)]).write(tmp_path / f"{corner:g}.vtk")
        blank = {"shape": "file", "path": str(tmp_path / f"{corner:g}.vtk"), "thickness": 0.8, "material": "steel",
                 "symmetry": ["x", "y"]}  # fmt: skip
        data = changed(CUP, ("blank", blank), ("tools.punch.diameter", 12), ("tools.die.diameter", 14),
                       ("tools.holder.diameter", 14), ("stages.0.tools.punch.stroke", 3))  # fmt: skip
        told.append(describe(build_model(StampingCase.model_validate(data))))
    assert "narrowest" not in told[0]
    # its diagonals are 0.424 and 7.07 mm long: sqrt(2) x area / diagonal
    assert "hint: the narrowest element, at (17.48, 17.48) mm, is 0.3 mm across" in told[1]


def test_shells_long_along_the_straight_edges_of_a_strip_are_not_coarse(tmp_path: Path) -> None:
    case = copy_example("draw_bending", tmp_path)
    assert "hint" not in describe(build_model(read_case(case, ["blank.element_size=[1, 17.5]"])))
    assert "0.48 elements round the edge" in describe(build_model(read_case(case, ["blank.element_size=[17.5, 1]"])))


def test_the_density_is_that_of_a_metal_with_this_modulus() -> None:
    assert build().materials[0].density == pytest.approx(7.85e-9, rel=0.02), "steel"
    aluminium = build(materials__steel__young="69 GPa").materials[0]
    assert aluminium.density == pytest.approx(2.70e-9, rel=0.03)
    assert build(materials__steel__density="7850 kg/m^3").materials[0].density == pytest.approx(7.85e-9)


def test_a_law_of_strain_rate_asks_for_the_speed_of_the_press() -> None:
    data = changed(CUP, ("materials.steel.rate", {"law": "cowper_symonds", "D": 40, "q": 5}))
    for stage in data["stages"]:
        stage.pop("velocity", None)
        stage.pop("duration", None)
    with pytest.raises(
        CaseError, match=r"stages.0.duration: .* depends on the strain rate, and nothing times the stage"
    ):
        build_model(StampingCase.model_validate(data))
    for stage in data["stages"]:
        stage["velocity"] = 200.0
    assert build_model(StampingCase.model_validate(data)).materials[0].rate is not None


def test_a_gap_lifts_the_holder_off_the_die() -> None:
    model = build(tools__holder__gap=1.1, stages__0__tools={"punch": {"stroke": 20}})
    tools = {tool.name: tool for tool in model.tools}
    assert tools["holder"].position[2] - tools["die"].position[2] == pytest.approx(1.1)


def test_a_force_over_the_stroke_becomes_a_table() -> None:
    force = (
        build(stages__0__tools__holder={"force": [[0, "4 kN"], [15, "10 kN"]]})
        .stages[0]
        .tool_motion["holder"]
        .push.force
    )
    assert force is not None
    assert force.tolist() == [[0, 4e3], [0.75, 10e3]]


def test_times_follow_from_velocity_duration_and_ramp() -> None:
    stage = build(stages__0__ramp="2 ms").stages[0]
    assert stage.duration == pytest.approx(0.012)
    slow = {"name": "draw", "duration": 0.05, "tools": {"punch": {"stroke": 20}}}
    stage = build(stages__0=slow).stages[0]
    assert (stage.duration, stage.ramp) == pytest.approx((0.05, 0.005))


@pytest.mark.parametrize(("path", "value", "fragments"), [
    ("blank.thickness", 0, ["blank.thickness", "> 0"]),
    ("blank.diameter", "100 kg", ["blank.diameter", "a length", "mass"]),
    ("blank.element_size", 0.001, ["blank.element_size", "elements, more than memory will hold"]),
    ("blank.shape", "cirle", ["blank.shape", "circle"]),
    ("blank.material", "stel", ["blank.material", "did you mean `steel`"]),
    ("blank.symmetry", ["z"], ["blank.symmetry", "x"]),
    ("blank.thicknes", 1, ["blank.thicknes", "unknown key", "thickness"]),
    ("materials.steel.density", 7850, ["materials.steel.density", "7850", "density of no metal", "kg/m^3"]),
    ("materials.steel.density", 7.85e-12, ["materials.steel.density", "density of no metal"]),
    ("materials.steel.density", 0, ["materials.steel.density", "density of no metal"]),
    ("explicit", {"safety": ["1 m", "2"]}, ["explicit.safety", "without a unit; write for instance 0.9"]),
    ("tools.punch.diameter", 53, ["tools.punch", "clearance is negative", "0.25 mm larger", "die"]),
    ("tools.punch.diameter", 52, ["tools.punch", "clearance of 0.25 mm", "0.8 mm"]),
    ("tools.holder.diameter", 49, ["tools.punch", "clearance is negative", "holder"]),
    ("tools.punch.edge_radius", 26, ["tools.punch.edge_radius", "larger than the punch's radius of 25 mm"]),
    ("tools.die.edge_radius", 0, ["tools.die.edge_radius", "sharp edge"]),
    ("tools.die.gap", 1, ["tools.die.gap", "only a holder"]),
    ("blank.thickness", 0.0008, ["blank.thickness = 0.0008", "thinner than any rolled metal", "plain numbers are mm"]),
    ("tools.holder.gap", 0.7, ["tools.holder.gap", "smaller than the blank's thickness of 0.8 mm"]),
    ("tools.holder.face_width", 20, ["tools.holder.face_width", "larger than the holder", "3 mm beyond"]),
    ("tools.punch.face_width", 20, ["tools.punch.face_width", "no face"]),
    ("tools.punch.position", [1, 0, 5], ["tools.punch.position", "symmetry plane x = 0"]),
    ("tools.punch.kind", "stamp", ["tools.punch.kind", "die, holder, punch"]),
    ("tools.punch.shape", "hemisferical", ["tools.punch.shape", "did you mean `hemispherical`"]),
    ("tools.punch", {"kind": "die", "shape": "hemispherical", "diameter": 50}, ["hemispherical nose"]),
    ("tools.punch.mu", -0.1, ["tools.punch.mu", ">= 0"]),
    ("stages.0.tools.punch.stroke", -20, ["stages.0.tools.punch.stroke = -20", "only moves up", "stroke = 20"]),
    ("stages.0.tools.die", {"stroke": -1}, ["stages.0.tools.die.stroke = -1", "only moves down", "stroke = 1"]),
    ("explicit", {"target_step": 1}, ["explicit.target_step = 1", 'smooth start of the stage "draw", 0.00111 s']),
    ("stages.0.tools.punsh", {"stroke": 1}, ["stages.0.tools.punsh", "did you mean `punch`"]),
    ("stages.0.tools.punch", {}, ["punch.stroke: no motion given; for instance stroke = 25; leave punch out"]),
    ("stages.0.tools.holder", {}, ["holder.force: no motion given; for instance force = 20000; leave holder"]),
    ("stages.0.tools.punch", {"stroke": 1, "force": 1}, ["stroke and force are both given; leave stroke or force out"]),
    ("stages.0.tools.holder.force", -5, ["forces >= 0"]),
    ("stages.0.tools.holder.force", [[5, 1], [0, 2]], ["strokes of the table do not increase"]),
    ("stages.0.tools", {"holder": {"force": [[0, 1], [5, 2]]}}, ["stages.0.tools.holder.force", "no tool moves"]),
    ("stages.0.tools", {}, ["stages.0", 'nothing moves in the stage "draw"']),
    ("stages.0.ramp", "20 ms", ["stages.0.ramp", "do not fit into 20 mm at 2000 mm/s", "0.01 s"]),
    ("stages.0.duration", 1, ["stages.0.duration", "velocity and duration"]),
    ("stages.0.velocity", 0, ["stages.0.velocity", "> 0"]),
    ("stages.0.displacement", [{"set": "rim", "component": "x", "value": 1}], ["displacement.0.set", "no such node"]),
    ("self_contact", {"mu": -1}, ["self_contact.mu", ">= 0"]),
    ("tools.punch.direction", [1, 0, -1], ["tools.punch.direction", "give its position"]),
    ("explicit", {"safety": 1.2}, ["explicit.safety", "<= 1"]),
    ("explicit", {"target_step": -1}, ["explicit.target_step", "> 0"]),
    ("explicit", {"step_bound": "mesh", "target_step": "0.4 us"}, ["explicit.step_bound", "give one of the two"]),
    ("explicit", {"step_bound": "mesh", "device": "host"}, ["explicit.step_bound", "on the CPU", "take \"shells\""]),
    ("output", {"steps": 300}, ["output.steps", "no more than rows = 200"]),
    ("procedure", "implict", ["procedure", "explicit"]),
])  # fmt: skip
def test_bad_input_is_named(path, value, fragments) -> None:
    with pytest.raises(CaseError) as error:
        build_model(StampingCase.model_validate(changed(CUP, (path, value))))
    for fragment in fragments:
        assert fragment in str(error.value)


def test_a_punch_may_go_back_after_its_stroke() -> None:
    back = {"name": "lift", "tools": {"punch": {"stroke": -20}}}
    assert build(stages=[*CUP["stages"], back]).stages[1].tool_motion["punch"].move[2] == 20


@pytest.mark.parametrize("missing", ["die", "holder"])
def test_a_pushed_tool_needs_one_on_the_other_side(missing) -> None:
    data = copy.deepcopy(CUP)
    pushed = "holder" if missing == "die" else "die"
    del data["tools"][missing]
    data["stages"][0]["tools"] = {"punch": {"stroke": 20}, pushed: {"force": 1000}}
    with pytest.raises(CaseError, match=f"the {pushed} is pushed, but no {missing}"):
        build_model(StampingCase.model_validate(data))


@pytest.mark.parametrize(("punch", "die", "clearance"), [
    ({"size": [51, 51], "corner_radius": 10}, {"size": [54, 54], "corner_radius": 11.5}, None),
    ({"size": [51, 51], "corner_radius": 10}, {"size": [54, 54], "corner_radius": 14}, "0.4645"),
    ({"size": [51, 51], "corner_radius": 10}, {"size": [54, 52], "corner_radius": 11}, "0.5 mm"),
    ({"size": [51, 51], "corner_radius": 4}, {"size": [54, 54], "corner_radius": 20}, "negative"),
])  # fmt: skip
def test_the_clearance_of_rectangles_counts_in_their_corners_too(punch, die, clearance) -> None:
    """The thesis's square cup has 1.5 mm all round; a larger corner of the die eats (sqrt(2) - 1) of its growth."""
    data = copy.deepcopy(CUP)
    shape = {"shape": "rectangular", "edge_radius": 4}
    data["tools"] = {"punch": {"kind": "punch", **shape, **punch}, "die": {"kind": "die", **shape, **die}}
    data["stages"][0]["tools"] = {"punch": {"stroke": 5}}
    if clearance is None:
        build_model(StampingCase.model_validate(data))
        return
    data["explicit"] = {"ironing": False}
    with pytest.raises(CaseError, match=clearance):
        build_model(StampingCase.model_validate(data))


@pytest.mark.parametrize(("diameter", "how", "told"), [
    (51.2, {}, None),
    (51.2, {"explicit": {"ironing": False}}, "less than the blank's 0.8 mm"),
    (51.2, {"procedure": "implicit"}, 'or take procedure = "explicit", which irons sheets'),
    (51.6, {}, "less than 0.6 of the blank's 0.8 mm"),
])  # fmt: skip
def test_a_clearance_below_the_thickness_is_for_ironing(diameter: float, how: dict[str, Any], told: str | None) -> None:
    data = {**copy.deepcopy(CUP), **how}
    data["tools"]["punch"]["diameter"] = diameter
    if told is None:
        text = list(describe_stamping(build_model(StampingCase.model_validate(data))))
        assert any(line.startswith("ironing: two tools") for line in text)
        return
    with pytest.raises(CaseError, match=told):
        build_model(StampingCase.model_validate(data))


def test_the_check_says_that_the_implicit_procedure_does_not_iron() -> None:
    model = build_model(StampingCase.model_validate({**copy.deepcopy(CUP), "procedure": "implicit"}))
    assert any("the implicit procedure does not offer it" in line for line in describe_stamping(model))


def test_library_materials_and_overrides_work(tmp_path: Path) -> None:
    import tomli_w

    data = copy.deepcopy(CUP)
    data["blank"]["material"] = "aa6016_t4"
    (tmp_path / "cup.toml").write_text(tomli_w.dumps(data))
    case = read_case(tmp_path / "cup.toml", ["stages.0.tools.punch.stroke=5"])
    model = build_model(case)
    assert model.stages[0].tool_motion["punch"].move[2] == -5
    assert model.materials[model.mesh.blocks[0].material].young == pytest.approx(70e3)
    assert "stroke = 5" in model.case_text


def write_blank(path: Path, height: float = 0.0, low: float = 0.0) -> None:
    x, y = np.meshgrid(np.linspace(low, 30, 4), np.linspace(0, 30, 4))
    rows = "\n".join(
        f"{i + 1}, {a}, {b}, {height * a * a}" for i, (a, b) in enumerate(zip(x.flat, y.flat, strict=True))
    )
    cells = [(i, i + 1, i + 5, i + 4) for j in range(3) for i in range(4 * j + 1, 4 * j + 4)]
    lines = "\n".join(f"{k + 1}, {a}, {b}, {c}, {d}" for k, (a, b, c, d) in enumerate(cells))
    path.write_text(f"*NODE, NSET=all_nodes\n{rows}\n*ELEMENT, TYPE=S4\n{lines}\n")


def test_a_blank_from_a_file_is_cut_where_its_mesh_ends(tmp_path: Path) -> None:
    write_blank(tmp_path / "blank.inp")
    blank = {k: v for k, v in CUP["blank"].items() if k not in ("diameter", "element_size")}
    blank |= {"shape": "file", "path": str(tmp_path / "blank.inp")}
    model = build(blank=blank)
    assert len(model.mesh.blocks[0].connectivity) == 9
    assert [s.node_set for s in model.supports] == ["symmetry_x", "symmetry_y"]
    assert len(model.mesh.node_sets["symmetry_x"]) == 4
    assert len(model.mesh.node_sets["edge"]) == 7
    text = (tmp_path / "blank.inp").read_text()
    triangles = [(i, i + 1, i + 5) for i in (1, 2, 3, 5, 6, 7, 9, 10, 11)]
    triangles += [(i, i + 5, i + 4) for i in (1, 2, 3, 5, 6, 7, 9, 10, 11)]
    rows = "\n".join(f"{k + 1}, {a}, {b}, {c}" for k, (a, b, c) in enumerate(triangles))
    (tmp_path / "blank.inp").write_text(f"{text.partition('*ELEMENT')[0]}*ELEMENT, TYPE=S3\n{rows}\n")
    for procedure, element in (("explicit", "shell3_1pt"), ("implicit", "shell3_mitc_plus")):
        (block,) = build(blank=blank, procedure=procedure).mesh.blocks
        assert (block.element, block.connectivity.shape) == (element, (18, 3))
    (tmp_path / "blank.inp").write_text(f"{text}*ELEMENT, TYPE=S3\n101, 1, 2, 6\n")
    with pytest.raises(CaseError, match=r"blank.path.*neither quadrilaterals alone nor triangles alone: quad4, tri3"):
        build(blank=blank)
    write_blank(tmp_path / "blank.inp", low=-3)
    with pytest.raises(CaseError, match=r"blank.symmetry.*symmetry plane x = 0: it reaches from -3 mm"):
        build(blank=blank)
    write_blank(tmp_path / "blank.inp", height=0.001)
    with pytest.raises(CaseError, match=r"tools.punch: the blank is not flat.*position"):
        build(blank=blank)


def test_the_implicit_procedure_takes_the_same_case_on_the_same_mesh() -> None:
    explicit = build_model(StampingCase.model_validate(CUP))
    implicit = build_model(StampingCase.model_validate({**CUP, "procedure": "implicit"}))
    np.testing.assert_array_equal(implicit.mesh.points, explicit.mesh.points)
    np.testing.assert_array_equal(implicit.mesh.blocks[0].connectivity, explicit.mesh.blocks[0].connectivity)
    assert implicit.mesh.blocks[0].element == "shell4_mitc"
    assert "cut back and grown" in describe(implicit)
    assert build_model(StampingCase.model_validate({**CUP, "procedure": "implicit", "springback": {}})).springback


LINE = {"shape": "polygon", "points": [[-30, -30], [30, -30], [30, 30], [-30, 30]]}


def test_a_trim_line_becomes_a_polygon(tmp_path: Path) -> None:
    """Area of each line against its formula, whatever it is drawn by."""
    (tmp_path / "line.csv").write_text("x, y\n-30, -30\n30, -30\n30, 30\n-30, 30\n")
    shapes = {
        "a": (LINE, 3600.0),
        "b": (LINE | {"corner_radius": 10}, 3600.0 - (4 - np.pi) * 100),
        "c": ({"shape": "rectangle", "size": [50, 30], "corner_radius": 5, "centre": [3, 4]}, 1500 - (4 - np.pi) * 25),
        "d": ({"shape": "circle", "diameter": 40, "centre": [1, 0]}, np.pi * 400),
        "e": ({"shape": "file", "path": str(tmp_path / "line.csv")}, 3600.0),
    }
    whole = CUP["blank"] | {"symmetry": []}
    for line in build(blank=whole, trim={name: shape for name, (shape, _) in shapes.items()}).trim:
        assert polygon_area(line.polygon) == pytest.approx(shapes[line.name][1], rel=1e-4)
        assert line.keep == "inside"
    words = describe(build(trim={"hole": {"shape": "circle", "diameter": 40, "keep": "outside"}}, springback={}))
    assert "then trim hole: what lies outside of a line over x -20 to 20 mm, y -20 to 20 mm stays" in words


def test_a_section_of_the_released_part_by_two_points_or_by_point_and_angle() -> None:
    sections = {"A": {"point": [10, 5], "to": [10, 45]}, "B": {"point": ["1 cm", 0], "angle": 30}}
    gauge = {"clamps": [[0, 0], [20, 0], [0, 20]], "points": {"P": [30, 0]}}
    found = build(springback={"sections": sections, "gauge": gauge, "tolerance": [-0.5, 0.3]})
    assert found.springback is not None
    one, other = found.springback.sections
    assert (one.name, one.start, one.length, other.start, other.length) == ("A", (10, 5), 40, (10, 0), np.inf)
    assert (one.angle, other.angle) == (pytest.approx(np.pi / 2), pytest.approx(np.pi / 6))
    words = describe(found)
    assert "section A: through (10, 5) mm at 90 degrees from x, over 40 mm" in words
    assert "section B: through (10, 0) mm at 30 degrees from x, as far as there is sheet" in words
    assert "gauge: 3 clamps, P" in words
    assert "tolerance: -0.5 to 0.3 mm off the shape in the tools" in words


@pytest.mark.parametrize(
    ("springback", "fault"),
    [
        ({"sections": {"A": {"point": [0, 0]}}}, r"springback\.sections\.A.*a second point or an angle"),
        ({"sections": {"A": {"point": [0, 0], "to": [1, 0], "angle": 3}}}, "a second point or an angle"),
        ({"sections": {"A": {"point": [1, 0], "to": [1, 0]}}}, "is where the section begins"),
        ({"gauge": {"clamps": [[0, 0], [1, 0]]}}, r"springback\.gauge\.clamps"),
        ({"gauge": {"clamps": [[0, 0], [1, 1], [3, 3]]}}, "in one line"),
        ({"tolerance": [0.5, -0.5]}, r"springback\.tolerance.*no band"),
    ],
)
def test_measures_of_springback_that_say_nothing_are_refused(springback: dict[str, Any], fault: str) -> None:
    with pytest.raises(CaseError, match=fault):
        build(springback=springback)


def test_a_trim_line_without_extent_is_refused() -> None:
    with pytest.raises(CaseError, match=r"trim\.hole: the line is only .* mm across"):
        build(trim={"hole": {"shape": "circle", "diameter": 1e-9}})


def test_a_trim_line_is_read_from_a_drawing(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new(units=5)  # cm
    space = drawing.modelspace()
    space.add_line((-3, -2), (3, -2), {"layer": "trim"})
    space.add_arc((3, 0), 2, -90, 90, dxfattribs={"layer": "trim"})
    space.add_line((3, 2), (-3, 2), {"layer": "trim"})
    space.add_circle((0, 0), 1, {"layer": "hole"})
    path = tmp_path / "line.dxf"
    drawing.saveas(path)
    line = {"shape": "file", "path": str(path), "layer": "trim"}
    with pytest.raises(CaseError, match=r"trim.t.path.*the line is open, from \(-30, -20\) to \(-30, 20\)"):
        build(trim={"t": line})
    space.add_line((-3, 2), (-3, -2), {"layer": "trim"})
    drawing.saveas(path)
    whole = CUP["blank"] | {"symmetry": []}
    trim = build(blank=whole, trim={"t": line, "hole": line | {"layer": "hole", "keep": "outside"}}).trim
    assert polygon_area(trim[0].polygon) == pytest.approx(60 * 40 + 0.5 * np.pi * 400, rel=1e-4)
    assert abs(polygon_area(trim[1].polygon)) == pytest.approx(np.pi * 100, rel=1e-4)


@pytest.mark.parametrize(("line", "fragments"), [
    ({"shape": "circle", "diameter": 0}, ["trim.t.diameter", "> 0"]),
    ({"shape": "circle", "diameter": 102}, ["trim.t", "cuts nothing off", "runs round all of the blank", "0 to 50"]),
    ({"shape": "circle", "diameter": 102, "keep": "outside"}, ["trim.t", "nothing is left outside of the line"]),
    ({"shape": "circle", "diameter": 20, "centre": [80, 0]}, ["nothing is left inside", "beside the blank"]),
    ({"shape": "circle", "diameter": 20, "centre": [80, 0], "keep": "outside"}, ["nothing off", "beside the blank"]),
    ({"shape": "circle", "diameter": 2, "centre": [3, 3], "keep": "outside"}, ["nothing off", "within one element"]),
    ({"shape": "rectangle", "size": [20, 0]}, ["trim.t.size", "two values > 0"]),
    ({"shape": "rectangle", "size": [20, 30], "corner_radius": 11}, ["corner_radius", "at most 10 fits"]),
    ({"shape": "polygon", "points": [[0, 0], [1, 1]]}, ["trim.t.points", "3"]),
    ({"shape": "polygon", "points": [[0, 0], [30, 30], [30, 0], [0, 30]]}, ["trim.t", "crosses", "(15, 15)"]),
    ({"shape": "polygon", "points": [[0, 0], [0, 0], [30, 0], [0, 30]]}, ["trim.t.points.1", "coincides"]),
    (LINE | {"corner_radius": 31}, ["trim.t.points", "at most 30 mm fits"]),
    ({"shape": "file", "path": "nothing.dxf"}, ["trim.t.path = \"nothing.dxf\"", "no such file"]),
    ({"shape": "file", "path": "nothing.dxf", "unit": "kg"}, ["trim.t.unit", "unit of length"]),
    (LINE | {"keep": "left"}, ["trim.t.keep", "inside"]),
])  # fmt: skip
def test_bad_trim_lines_are_named_before_computing(line, fragments) -> None:
    with pytest.raises(CaseError) as caught:
        build(trim={"t": line})
    for fragment in fragments:
        assert fragment in str(caught.value)


def test_a_blank_is_meshed_inside_an_outline(tmp_path: Path) -> None:
    """An octagon: its area, quarter of it, and triangles alone."""
    corners = [(35, -15), (35, 15), (15, 35), (-15, 35), (-35, 15), (-35, -15), (-15, -35), (15, -35)]
    path = tmp_path / "blank.csv"
    path.write_text("\n".join(f"{x}, {y}" for x, y in corners))
    blank = {k: v for k, v in CUP["blank"].items() if k != "diameter"}
    blank |= {"shape": "outline", "path": str(path), "element_size": 3}
    for cells, kinds in (("quadrilaterals", [4]), ("triangles", [3])):
        model = build(blank=blank | {"cells": cells})
        assert [b.connectivity.shape[1] for b in model.mesh.blocks] == kinds
        assert model.cells.shape[1] == 4
        corners_of_cells = model.mesh.points[model.cells][..., :2]
        x, y = np.moveaxis(corners_of_cells, -1, 0)
        area = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum()
        assert area == pytest.approx((70 * 70 - 2 * 20 * 20) / 4, rel=1e-9)
        assert [s.node_set for s in model.supports] == ["symmetry_x", "symmetry_y"]
        assert (np.abs(model.mesh.points[model.mesh.node_sets["symmetry_x"], 0]) < 1e-9).all()
    path.write_text("0, 0\n-10, 0\n-10, -10")
    with pytest.raises(CaseError, match=r"blank.path.*does not reach the symmetry plane"):
        build(blank=blank)
    path.write_text("0, 0\n10, 10\n10, 0\n0, 10")
    with pytest.raises(CaseError, match=r"blank.path.*crosses"):
        build(blank=blank)
    path.write_text("0, 0\n10, 0\n0, 10")
    with pytest.raises(CaseError, match=r"blank.element_size = 0.001.*more than memory"):
        build(blank=blank | {"element_size": 0.001})


@pytest.mark.parametrize(("changes", "fragments"), [
    ({"procedure": "implicit", "gradients": {"of": ["punch.force"], "by": ["tools.punch.mu"]}},
     ["gradients", "have no derivatives", "leave gradients out"]),
    ({"blank.refine": {"levels": 1}}, ["self_contact", "cannot be split", "leave blank.refine out"]),
])  # fmt: skip
def test_contact_of_the_sheet_with_itself_is_refused_where_it_is_not_computed(changes, fragments) -> None:
    with pytest.raises(CaseError) as error:
        build(self_contact={}, **changes)
    for fragment in fragments:
        assert fragment in str(error.value)


def test_a_drawn_tool_goes_aslant_only_with_its_mirror_image() -> None:
    with pytest.raises(CaseError, match="cannot go along x"):
        build(**{"tools.punch.direction": [1, 0, -1], "tools.punch.position": [0, 0, 5]})


def test_direction_turns_strokes() -> None:
    model = build(
        **{"tools.punch.direction": [0, 0, -2], "tools.punch.position": [0, 0, 5], "self_contact": {"mu": 0.2}}
    )
    assert model.stages[0].tool_motion["punch"].move == (0.0, 0.0, -20.0)
    assert model.self_contact is not None
    assert model.self_contact.mu == 0.2


def test_a_tool_that_works_its_usual_way_needs_no_position() -> None:
    usual, told = build(), build(**{"tools.punch.direction": [0, 0, -2], "tools.die.direction": [0, 0, 1]})
    for one, other in zip(usual.tools, told.tools, strict=True):
        assert np.array_equal(one.position, other.position)
    with pytest.raises(CaseError, match="give its position"):
        build(**{"tools.punch.direction": [0, 0, 1]})


SECTION = {"kind": "punch", "shape": "section", "corners": [[0, 0], [20, 0], [20, 9], [0, 9]]}


@pytest.mark.parametrize(("change", "fragments"), [
    ({"corners": [[0, 0], [20, 0]]}, ["tools.punch.corners", "at least 3"]),
    ({"corners": [[0, 0], [20, 9], [20, 0], [0, 14]]}, ["tools.punch.corners", "cross each other"]),
    ({"radius": [1, 2]}, ["tools.punch.radius", "one for each corner"]),
    ({"radius": 12}, ["tools.punch.corners", "the radii of a side"]),
    ({"direction": [0, 0, 0], "position": [0, 0, 9]}, ["tools.punch.direction", "no length"]),
])  # fmt: skip
def test_bad_sections_are_named(change, fragments) -> None:
    with pytest.raises(CaseError) as error:
        build(**{"tools.punch": {**SECTION, **change}})
    for fragment in fragments:
        assert fragment in str(error.value)


def test_a_hem_needs_a_direction() -> None:
    with pytest.raises(CaseError, match="has no length"):
        build(hem={"outward": [0, 0]})
    hem = build(hem={"outward": [0, 2]}).hem
    assert hem is not None
    assert hem.outward == (0.0, 2.0)
