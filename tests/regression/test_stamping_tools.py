# SPDX-License-Identifier: Apache-2.0
"""A coarse round cup between punch, die and holder: forces, symmetry, section, resume, pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import CaseError, StampingCase, build_model, read_case
from presswork.examples import copy_example
from presswork.geometry.swept_tool import triangulate
from presswork.post.section import cut_sheet, cut_tool, measure_draw_in
from presswork.process.begin import check_start
from presswork.recorder import run_model
from presswork.view.all_plots import plot_all
from presswork.view.plots.shell_plot import plot_shell
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end, stop_after

STROKE = 8.0


def cup(*planes: str, **blank: Any) -> StampingCase:
    return StampingCase.model_validate({
        "title": "coarse cup",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 60, "thickness": 1, "element_size": 4, "material": "steel",
                  "symmetry": planes, **blank},
        "materials": {"steel": {"young": "206 GPa", "poisson": 0.3,
                                "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
        "tools": {
            "punch": {"kind": "punch", "shape": "round", "diameter": 30, "edge_radius": 5},
            "die": {"kind": "die", "shape": "round", "diameter": 33, "edge_radius": 5, "mu": 0.05},
            "holder": {"kind": "holder", "shape": "round", "diameter": 34, "edge_radius": 1, "mu": 0.05},
        },
        "stages": [{"name": "draw", "velocity": "5 m/s",
                    "tools": {"punch": {"stroke": STROKE}, "holder": {"force": [[0, 4000], [4, 8000]]}}}],
        "output": {"rows": 40, "steps": 2, "checkpoint_every": 9},
    })  # fmt: skip


@pytest.fixture(scope="module")
def drawn(tmp_path_factory) -> Result:
    return run_to_end(build_model(cup("x", "y")), tmp_path_factory.mktemp("cup") / "out")


def test_the_die_carries_punch_and_holder(drawn) -> None:
    """Equilibrium of the blank, whose inertia is small: die = punch + holder, on the whole part."""
    h = drawn.history
    formed = h["punch.stroke"] > 0.5 * STROKE
    sum_of_forces = h["punch.force"] + h["holder.force"]
    np.testing.assert_allclose(h["die.force"][formed], sum_of_forces[formed], rtol=0.02)
    assert h["punch.stroke"][-1] == pytest.approx(STROKE, rel=1e-12)
    assert h["holder.force"][-1] == pytest.approx(8000, rel=0.02)
    np.testing.assert_allclose(h["punch.force_z"], h["punch.force"])
    assert np.abs(h["energy_error_percent"]).max() < 1
    assert not [w for w in drawn.summary["warnings"] if "touched" in w]


def test_the_holder_follows_its_table_over_the_stroke(drawn) -> None:
    h = drawn.history
    late = h["punch.stroke"] > 0.3 * STROKE
    wanted = np.interp(h["punch.stroke"], [0, 4], [4000, 8000])
    np.testing.assert_allclose(h["holder.force"][late], wanted[late], rtol=0.1)


def test_a_half_gives_the_forces_of_a_quarter(drawn, tmp_path) -> None:
    """Both are those of the whole cup. The meshes are the same but for the mirror image."""
    half = run_model(build_model(cup("y")), tmp_path / "half", threads=1).result
    for column in ("punch.force", "die.force", "holder.force"):
        late = drawn.history["punch.stroke"] > 1
        np.testing.assert_allclose(half.history[column][late], drawn.history[column][late], rtol=0.05)
    assert np.abs(half.history["punch.force_y"]).max() == 0.0
    assert half.field("thickness_strain").min() == pytest.approx(drawn.field("thickness_strain").min(), rel=0.05)


def test_the_section_shows_the_sheet_between_its_tools(drawn) -> None:
    for angle in (0.0, np.pi / 4, np.pi / 2):
        sheet = cut_sheet(drawn, angle)
        np.testing.assert_array_equal(sheet.line[1:, 0], sheet.line[:-1, 1])
        assert sheet.line[0, 0] == pytest.approx([0.0, -STROKE], abs=0.3), "a bulge under the punch"
        assert 25 < sheet.line[-1, 1, 0] < 30
        assert sheet.line[-1, 1, 1] == pytest.approx(0.0, abs=0.1)
        assert measure_draw_in(drawn, angle) == pytest.approx(30 - sheet.line[-1, 1, 0], abs=0.1)
    bottom = cut_tool(drawn, "punch", np.pi / 4)
    assert bottom[:, :, 1].min() == pytest.approx(0.5 - STROKE)
    assert bottom[:, :, 0].max() == pytest.approx(15, abs=0.05)


def test_a_blank_that_keeps_its_volume_draws_in_alike_all_round(drawn) -> None:
    draw_in = [measure_draw_in(drawn, angle) for angle in np.radians([0, 30, 60, 90])]
    np.testing.assert_allclose(draw_in, np.mean(draw_in), rtol=0.05)
    area = np.pi * 30**2
    assert drawn.summary["mass"]["blank_t"] == pytest.approx(206e3 / 5.1e6**2 * area / 4, rel=0.01)


def test_a_resumed_run_and_one_with_two_threads_give_the_same_bits(drawn, tmp_path: Path) -> None:
    model = build_model(cup("x", "y"))
    run_model(model, tmp_path / "two", threads=2)
    assert run_model(model, tmp_path / "part", threads=1, on_increment=stop_after(22)).status == "interrupted"
    stopped = Result(tmp_path / "part")
    assert len(stopped.times) == 3, "the start, half of the stage, and where it stopped"
    assert run_model(model, tmp_path / "part", threads=1, resume=True).status == "completed"
    for other in ("two", "part"):
        assert_same_bits(tmp_path / other, drawn.folder)
        np.testing.assert_array_equal(
            Result(tmp_path / other).surface_displacement("holder"), drawn.surface_displacement("holder")
        )


def test_pictures_show_part_section_forces_and_energies(drawn, tmp_path) -> None:
    names = {p.name for p in plot_all(drawn, tmp_path)}
    assert names >= {
        "section_002.png",
        "draw_in.png",
        "outline_002.png",
        "force_stroke.png",
        "energies.png",
        "shell_thickness_strain_002.png",
    }
    assert all(p.stat().st_size > 10_000 for p in tmp_path.glob("*.png"))
    assert (tmp_path / "draw_in_002.csv").read_text().startswith("angle_degree,draw_in_mm")


def test_a_punch_that_goes_back_leaves_the_part(tmp_path) -> None:
    case = cup("x", "y").model_dump(exclude_none=True)
    case["stages"] = [{"name": "press", "tools": {"punch": {"stroke": 3}, "holder": {"force": 4000}}},
                      {"name": "lift", "tools": {"punch": {"stroke": -4}}}]  # fmt: skip
    result = run_model(build_model(StampingCase.model_validate(case)), tmp_path / "out", threads=1).result
    h = result.history
    assert set(h["stage"]) == {"press", "lift"}
    assert h["punch.stroke"].max() == pytest.approx(3, rel=1e-9)
    assert h["punch.stroke"][-1] == pytest.approx(-1, rel=1e-9)
    assert h["punch.force"][-10:] == pytest.approx(0.0, abs=1e-9)
    assert h["holder.force"][-1] == pytest.approx(4000, rel=0.005), "a holder that no stage names goes on pushing"
    assert -3.3 < result.points()[:, 2].min() < -2, "the part keeps its depth but for springback"


def test_a_tool_that_starts_in_the_blank_is_refused() -> None:
    case = cup("x", "y")
    punch = case.tools["punch"].model_copy(update={"position": (0.0, 0.0, 0.2)})
    with pytest.raises(CaseError, match=r"tools.punch.position.*starts in the blank.*0.3 mm"):
        build_model(case.model_copy(update={"tools": {**case.tools, "punch": punch}}))


@pytest.mark.parametrize(("name", "size"), [("square_cup", 8), ("hemispherical_punch", 8), ("draw_bending", 3)])
def test_examples_begin_well(name, size, tmp_path) -> None:
    """Coarse, for a few millimetres; a strip that springs back must still bend round its shoulders of 5 mm."""
    copy_example(name, tmp_path)
    fine = read_case(tmp_path / f"{name}.toml")
    check_start(build_model(fine))
    short = ["stages.0.tools.punch.stroke=6", f"blank.element_size={size}", "output.rows=20", "output.steps=1"]
    result = run_to_end(build_model(read_case(tmp_path / f"{name}.toml", short)), tmp_path / "out")
    assert result.history["punch.force"].max() > 50
    assert plot_shell(result).axes  # also where tools do not reach the planes that they are drawn in


def write_stl(path: Path, points: np.ndarray, triangles: np.ndarray) -> None:
    facets = (
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points[triangle])
        + "endloop\nendfacet\n"
        for triangle in triangles
    )
    path.write_text("solid tool\n" + "".join(facets) + "endsolid tool\n")


def test_a_punch_from_a_file_does_what_the_drawn_one_does(drawn, tmp_path) -> None:
    """Its STL file in inches, high above the blank: it is brought down to it, and forces differ by its facets alone."""
    case = cup("x", "y")
    model = build_model(case)
    points, triangles = triangulate(model.tools[0].shape, 0.02)
    write_stl(tmp_path / "punch.stl", (points + np.array([0, 0, 100])) / 25.4, triangles)
    file = {"kind": "punch", "shape": "file", "path": str(tmp_path / "punch.stl"), "unit": "inch"}
    data = case.model_dump(exclude_none=True)
    from_file = build_model(StampingCase.model_validate({**data, "tools": {**data["tools"], "punch": file}}))
    assert from_file.tools[0].position[2] == pytest.approx(0.5 - 100)
    result = run_model(from_file, tmp_path / "out", threads=1).result
    late = drawn.history["punch.stroke"] > 2
    np.testing.assert_allclose(result.history["punch.force"][late], drawn.history["punch.force"][late], rtol=0.05)


def test_a_tool_file_that_is_not_there_is_named(tmp_path) -> None:
    data = cup("x", "y").model_dump(exclude_none=True)
    data["tools"]["punch"] = {"kind": "punch", "shape": "file", "path": "punsch.stl"}
    with pytest.raises(CaseError, match=r"tools.punch.path = .punsch.stl.*no such file"):
        build_model(StampingCase.model_validate(data))


def close_draw_and_lift() -> StampingCase:
    """The holder is moved down to the blank, pushed, lifted, and at last stands still; likewise the punch."""
    case = cup("x", "y").model_dump(mode="json", exclude_none=True)
    case["tools"]["holder"]["position"] = [0, 0, 1.5]
    case["stages"] = [
        {"name": "close", "velocity": 4000, "tools": {"holder": {"stroke": 0.95}}},
        {"name": "draw", "velocity": 5000, "tools": {"punch": {"stroke": 3}, "holder": {"force": 4000}}},
        {"name": "open", "velocity": 5000, "tools": {"holder": {"stroke": -2}}},
        {"name": "eject", "velocity": 5000, "tools": {"punch": {"stroke": -4}}},
    ]
    case["output"] = {"rows": 10, "steps": 1, "checkpoint_every": 4}
    return StampingCase.model_validate(case)


def test_a_holder_is_moved_pushed_lifted_and_stands_still(tmp_path: Path) -> None:
    model = build_model(close_draw_and_lift())
    result = run_model(model, tmp_path / "whole", threads=1).result
    h = result.history
    close, pushed, opened, eject = (h["stage"] == name for name in ("close", "draw", "open", "eject"))
    assert h["holder.stroke"][close][-1] == pytest.approx(0.95, rel=1e-9)
    # the holder's own mass vibrates on the sheet: by 0.7 % at the end, less in the mean
    held = h["holder.force"][pushed]
    assert held[-1] == pytest.approx(4000, rel=0.02)
    assert held[len(held) // 2 :].mean() == pytest.approx(4000, rel=0.005)
    lifted = h["holder.stroke"][opened]
    assert lifted[-1] - h["holder.stroke"][pushed][-1] == pytest.approx(-2, abs=1e-9)
    np.testing.assert_allclose(h["holder.stroke"][eject], lifted[-1], atol=1e-12)
    assert np.abs(h["holder.force"][eject]).max() < 1e-9
    assert h["punch.stroke"][-1] == pytest.approx(-1, rel=1e-9)
    assert abs(h["energy_error_percent"][-1]) < 1
    run_in_two_parts(model, tmp_path / "part", 27)  # in the stage that lifts what was pushed
    assert_same_bits(tmp_path / "part", result.folder)


def test_the_holder_of_a_cup_drawn_through_comes_to_stand_on_the_die(tmp_path: Path) -> None:
    """It follows the last of the flange onto the shoulder with all its force; bare, it is a sheet's thickness lower."""
    case = cup("x", "y").model_dump(mode="json", exclude_none=True)
    case["stages"] = [{"name": "draw", "velocity": 10e3, "tools": {"punch": {"stroke": 34}, "holder": {"force": 6000}}}]
    outcome = run_model(build_model(StampingCase.model_validate(case)), tmp_path / "cup", threads=1)
    assert outcome.status == "completed", outcome.reason
    history, points = outcome.result.history, outcome.result.points(-1)
    assert history["holder.stroke"].max() == history["holder.stroke"][-1] == pytest.approx(1.0, abs=1e-9)
    assert np.abs(history["holder.force"][history["punch.stroke"] > 25]).max() == 0.0
    assert np.hypot(points[:, 0], points[:, 1]).max() < 16.5
    assert abs(history["energy_error_percent"][-1]) < 0.5


def test_the_implicit_procedure_refuses_a_tool_that_is_moved_and_pushed() -> None:
    case = close_draw_and_lift().model_copy(update={"procedure": "implicit"})
    with pytest.raises(CaseError, match="cannot move a tool in one stage and push it in another"):
        build_model(case)
