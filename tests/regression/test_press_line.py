# SPDX-License-Identifier: Apache-2.0
"""Operations in a row: what is carried, what is recorded, checkpoint and resume, and cases that cannot be."""

from __future__ import annotations

import copy
import json
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.case.errors import CaseError
from presswork.post import cut_sheet, measure_draw_in
from presswork.recorder import run_model
from presswork.view import plot_history
from presswork.view.plots.section_plot import plot_draw_in, plot_section
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_stamping, run_to_end

FLAT = {"mu": 0.1, "shape": "ring", "outer_diameter": 24}
STEEL = {
    "young": 206e3,
    "poisson": 0.3,
    "density": "7850 kg/m^3",
    "hardening": {"law": "linear", "yield_stress": 200, "modulus": 500},
    "forming_limit": {"law": "points", "points": [[-0.3, 0.6], [0.0, 0.3], [0.3, 0.4]]},
}


def cup_line(**changes: Any) -> dict[str, Any]:
    """A small cup: drawn and trimmed; pierced; its flange bent down."""
    draw = {
        "name": "draw",
        "tools": {
            "punch": {"kind": "punch", "shape": "round", "diameter": 20, "edge_radius": 4},
            "die": {"kind": "die", "shape": "round", "diameter": 23, "edge_radius": 4},
            "holder": {"kind": "holder", "shape": "round", "diameter": 23, "edge_radius": 1},
        },
        "stages": [{"name": "form", "tools": {"punch": {"stroke": 4}, "holder": {"force": 4000}}}],
        "trim": {"rim": {"shape": "circle", "diameter": 41}},
        "springback": {"increments": 2},
    }
    pierce = {
        "name": "pierce",
        "tools": {"post": {"kind": "die", "shape": "ring", "outer_diameter": 12}},
        "stages": [{"name": "hold", "duration": "20 us"}],
        "trim": {"hole": {"shape": "circle", "diameter": 9, "keep": "outside"}},
    }
    flange = {
        "name": "flange",
        "tools": {
            "die": {
                "kind": "die", "shape": "ring", "inner_diameter": 24, "outer_diameter": 34, "inner_radius": 3,
                "outer_radius": 2,
            },
            "pad": {
                "kind": "holder", "shape": "ring", "inner_diameter": 24, "outer_diameter": 33, "inner_radius": 3,
                "outer_radius": 1,
            },
            "punch": {
                "kind": "punch", "shape": "ring", "inner_diameter": 37, "outer_diameter": 48, "inner_radius": 2
            },
        },
        "stages": [{"name": "down", "tools": {"punch": {"stroke": 3}, "pad": {"force": 3000}}}],
        "springback": {"increments": 2},
    }  # fmt: skip
    return {
        "title": "a small cup",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 46, "thickness": 1.0, "element_size": 2.5, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": STEEL},
        "operations": [draw, pierce, flange],
        "output": {"rows": 8, "steps": 2, "checkpoint_every": 1},
        **changes,
    }  # fmt: skip


@pytest.fixture(scope="module")
def formed(tmp_path_factory) -> Result:
    return run_stamping(cup_line(), tmp_path_factory.mktemp("line") / "out")


def test_history_and_steps_name_operations_and_show_tools_at_work_only(formed) -> None:
    stages = list(dict.fromkeys(formed.history["stage"]))
    assert stages == [
        "draw_form", "draw_trim", "draw_springback", "pierce_laid", "pierce_hold", "pierce_trim", "flange_laid",
        "flange_down", "flange_springback",
    ]  # fmt: skip
    np.testing.assert_array_equal(formed.history["increment"], np.arange(1, len(formed.history["time"]) + 1))
    assert (np.diff(formed.history["time"]) >= 0).all()
    assert sorted(formed.tools_at_work(1)) == ["draw_die", "draw_holder", "draw_punch"]
    assert sorted(formed.tools_at_work(-1)) == ["flange_die", "flange_pad", "flange_punch"]
    strokes = formed.history["flange_punch.stroke"]
    assert strokes[-1] == pytest.approx(3.0, rel=1e-9)
    assert not strokes[np.char.startswith(np.asarray(formed.history["stage"], dtype=str), "draw")].any()


def test_the_part_is_pierced_its_flange_points_down_and_strains_count_from_the_blank(formed) -> None:
    points = formed.points(-1)
    radius = np.hypot(points[:, 0], points[:, 1])
    assert radius.min() == pytest.approx(4.5, abs=0.25)  # chords of cells of 2.5 mm
    rim, die = radius > radius.max() - 0.6, formed.placed_surface("flange_die")
    assert points[rim, 2].max() < die[:, 2].max() - 0.5  # below the face that the flange lies on
    drawn = formed.field("equivalent_plastic_strain", 2).max()
    assert formed.field("equivalent_plastic_strain", -1).max() > 1.05 * drawn
    thickness = formed.field("thickness", -1)
    np.testing.assert_allclose(np.log(thickness), formed.field("thickness_strain", -1), atol=1e-6)  # of 1 mm


@pytest.mark.parametrize("place", [{"over": "x", "turn": 180}, {"over": "y"}])
def test_sections_and_cuts_of_a_part_that_was_turned_are_where_it_lies(tmp_path, place) -> None:
    """The hole of 9 mm begins at 4.5 mm along any ray; the rim stays where the first operation left it."""
    draw, pierce, _ = copy.deepcopy(cup_line()["operations"])
    upside_down = run_stamping(cup_line(operations=[draw, pierce | {"place": place}]), tmp_path / "out")
    assert not [text for text in upside_down.summary["warnings"] if "beside" in text]
    line = cut_sheet(upside_down, 0.3).line
    assert line[0, 0, 0] == pytest.approx(4.5, abs=0.25)  # chords of cells of 2.5 mm
    assert (np.diff(line[:, :, 0], axis=1) > 0).all()
    assert line[-1, 1, 0] == pytest.approx(20.5, abs=0.2)
    operations = [upside_down.operation_at(step) for step in range(len(upside_down.times))]
    laid = operations.index("pierce")
    assert measure_draw_in(upside_down, 0.0, laid) == pytest.approx(measure_draw_in(upside_down, 0.0, laid - 1))
    (axes,) = plot_draw_in(upside_down).axes
    assert axes.get_xlabel() == "draw_punch stroke [mm]"
    np.testing.assert_allclose(max(line.get_xdata().max() for line in axes.lines), 4.0, rtol=1e-3)


def test_pictures_of_a_line_show_holes_and_the_force_of_a_holder_over_the_stroke_of_its_punch(tmp_path) -> None:
    draw, pierce, _ = copy.deepcopy(cup_line()["operations"])
    pierce["trim"]["hole"] |= {"diameter": 5, "centre": [16, 0]}
    pierced = run_stamping(cup_line(operations=[draw, pierce]), tmp_path / "out")
    ((strain, *_),) = [axes.lines for axes in plot_section(pierced).axes[1:]]
    way = strain.get_xdata()
    (gap,) = np.flatnonzero(np.isnan(way))
    assert way[gap - 1] < 13.6
    assert way[gap + 1] > 18.4
    curves = {line.get_label(): line.get_xdata() for line in plot_history(pierced).lines}
    assert np.nanmax(curves["draw_holder"]) == pytest.approx(4.0, rel=1e-3)


def test_summary_tells_every_operation(formed) -> None:
    summary = json.loads((formed.folder / "summary.json").read_text())
    assert summary["operation"] == "flange"
    assert set(summary["operations"]) == {"draw", "pierce"}
    assert summary["operations"]["pierce"]["trim"]["off_line_mm"] < 0.3
    assert summary["operations"]["draw"]["springback"]["largest_mm"] > 0
    assert summary["increments"] == len(formed.history["time"])


def test_the_least_margin_along_the_path_is_carried_from_operation_to_operation(formed) -> None:
    summary = json.loads((formed.folder / "summary.json").read_text())
    told = [*(summary["operations"][name]["formability"] for name in ("draw", "pierce")), summary["formability"]]
    draw, pierce, flange = (each["least_margin_polar"]["value"] for each in told)
    assert 0.0 < flange <= pierce < 1.0
    assert pierce >= draw  # what was pierced or trimmed is gone, with its margin


@pytest.mark.parametrize(
    "reports", [*(pytest.param(count, marks=pytest.mark.validation) for count in (5, 11, 15, 21, 25, 30)), 12]
)
def test_a_line_that_is_stopped_goes_on_with_the_same_bits(formed, tmp_path, reports) -> None:
    """Within an operation, at its end, and where the part has just been laid into the next one."""
    model = build_model(StampingCase.model_validate(cup_line()))
    assert_same_bits(run_in_two_parts(model, tmp_path / "out", reports).folder, formed.folder)


def refined_line() -> dict[str, Any]:
    data = cup_line()
    data["blank"]["refine"] = {"levels": 1, "angle": 12}
    del data["operations"][1]
    return data


@pytest.mark.validation
def test_a_blank_that_is_refined_is_split_no_further_by_later_operations(tmp_path) -> None:
    """After the first trimming there are triangles, too; a part once split to its levels stays as it is."""
    run = run_to_end(build_model(StampingCase.model_validate(refined_line())), tmp_path / "whole")
    shells = {stage: run.history["shells"][run.history["stage"] == stage] for stage in ("draw_trim", "flange_down")}
    assert shells["draw_trim"][0] == 4 * 72
    assert (shells["flange_down"] == shells["flange_down"][0]).all()


@pytest.mark.validation
def test_a_line_with_a_refined_blank_goes_on_with_the_same_bits(tmp_path) -> None:
    model = build_model(StampingCase.model_validate(refined_line()))
    whole = run_to_end(model, tmp_path / "whole")
    assert_same_bits(run_in_two_parts(model, tmp_path / "parts", 15).folder, whole.folder)


def change(keys: str, value: object) -> dict[str, Any]:
    """The line with a value put in, by its dotted key; None: taken out."""
    data: Any = copy.deepcopy(cup_line())
    at, *path = data, *keys.split(".")
    for key in path[:-1]:
        at = at[int(key)] if isinstance(at, list) else at.setdefault(key, {})
    if value is None:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return data


@pytest.mark.parametrize(
    ("keys", "value", "told"),
    [
        ("stages", [{"name": "more", "duration": 1e-4}], ": every operation has its own; move it into one of"),
        ("operations.1.stages", [], "operations.1.stages"),
        ("operations.2.stages.0.tools.ram", {"stroke": 1}, "operations.2.stages.0.tools.ram: no such tool"),
        ("operations.1.name", "draw", 'operations.1.name = "draw": two operations have this name'),
        ("operations.0.place", {"over": "x"}, "operations.0.place: the first operation takes the flat blank"),
        ("operations.2.place", {"turn": 90}, "operations.2.place.turn = 90.0: the part would be turned off its"),
        ("operations.2.place", {"move": [1, 0, 0]}, "operations.2.place.move"),
        ("operations.1.trim.hole.keep", "inside", None),
        ("operations.1.trim.hole.diameter", 60, "operations.1.trim.hole: nothing is left outside of the line"),
        ("operations.2.tools.die.outer_radius", 9, "operations.2.tools.die.outer_radius = 9: the radii of the edges"),
        ("operations.2.tools.pad.gap", 0.5, "operations.2.tools.pad.gap = 0.5: the gap is smaller than"),
        (
            "operations.2.stages.0.tools.punch",
            {"close": 1, "stroke": 1},
            "stroke and close are both given; leave stroke or close out",
        ),
        ("operations.0.stages.0.tools.punch", {"close": 400}, "tools.punch.close = 400.0: it stands so near already"),
        ("operations.2.stages.0.tools.die", {"close": 1}, "tools.die.close = 1.0: a die is what others close on"),
        ("operations.1.place", {"tip": True}, None),
        ("heat", {"surroundings": {"temperature": 20}}, "heat"),
        ("points", {"rim": [0, 0, 0]}, "points: points are not followed"),
    ],
)
def test_lines_that_cannot_be_are_refused(keys, value, told) -> None:
    if told is None:
        build_model(StampingCase.model_validate(change(keys, value)))
        return
    with pytest.raises(CaseError) as caught:
        build_model(StampingCase.model_validate(change(keys, value)))
    assert told in str(caught.value)


def test_a_case_without_stages_and_operations_is_refused() -> None:
    data = cup_line()
    del data["operations"]
    with pytest.raises(CaseError, match="stages: expected at least one stage; add"):
        StampingCase.model_validate(data)


@pytest.mark.parametrize(
    ("keys", "value", "told"),
    [
        (
            "operations.2.tools.die.position", [0, 0, 2.0],
            "operations.flange.tools.die.position = [0, 0, 2]: the part does not fit the die: ",
        ),
        (
            "operations.1.trim.hole", {"shape": "circle", "diameter": 44, "keep": "outside"},
            "trim.pierce_hole: nothing is left outside of the line",
        ),
    ],
)  # fmt: skip
def test_a_part_that_does_not_fit_stops_the_run_and_leaves_what_was_computed(tmp_path, keys, value, told) -> None:
    model = build_model(StampingCase.model_validate(change(keys, value)))
    outcome = run_model(model, tmp_path / "out", threads=1)
    assert outcome.status == "gave_up"
    assert told in outcome.reason
    assert len(outcome.result.times) > 4


AT_ONCE = {"initial_increment": 0.5, "max_increment": 1.0}


def test_a_part_is_held_where_it_lies_not_where_its_blank_was(tmp_path) -> None:
    """By increments, an operation begins with tools that touch the part alone, 30 mm above the blank's place."""
    line = cup_line(procedure="implicit", implicit=AT_ONCE, blank={**cup_line()["blank"], "element_size": 6})
    post = {"kind": "die", "shape": "ring", "outer_diameter": 40}
    pad = {"kind": "holder", "shape": "ring", "outer_diameter": 30}
    press = [{"name": "press", "duration": "20 us", "tools": {"pad": {"force": 100}}}]
    line["operations"] = [
        {"name": "first", "tools": {"post": post, "pad": pad}, "stages": copy.deepcopy(press)},
        {"name": "second", "place": {"move": [0, 0, 30]}, "tools": {"post": post, "pad": pad}, "stages": press},
    ]
    run = run_stamping(line, tmp_path / "out")
    assert run.points(-1)[:, 2] == pytest.approx(30.0, abs=0.01)
    assert run.history["second_pad.force"][-1] == pytest.approx(100.0, rel=1e-6)


def test_a_part_that_no_tool_touches_is_refused_where_it_lies(tmp_path) -> None:
    """Its blank would touch the tool, which stands where that was."""
    line = cup_line(procedure="implicit", implicit=AT_ONCE, blank={**cup_line()["blank"], "element_size": 6})
    post = {"kind": "die", "shape": "ring", "outer_diameter": 40}
    stands = {**post, "position": [0, 0, -0.5]}
    pad = {"kind": "holder", "shape": "ring", "outer_diameter": 30}
    press = [{"name": "press", "duration": "20 us", "tools": {"pad": {"force": 100}}}]
    line["operations"] = [
        {"name": "first", "tools": {"post": post, "pad": pad}, "stages": press},
        {"name": "second", "place": {"move": [0, 0, 30]}, "tools": {"post": stands},
         "stages": [{"name": "wait", "duration": "20 us"}]},
    ]  # fmt: skip
    model = build_model(StampingCase.model_validate(line))
    outcome = run_model(model, tmp_path / "out", threads=1)
    assert "the operation second cannot begin: nothing holds the shell" in outcome.reason
