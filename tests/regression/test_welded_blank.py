# SPDX-License-Identifier: Apache-2.0
"""Runs of welded blanks: who holds what, weld lines, trimming, springback, operations, refinement, resumed runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.stamping.schema import StampingCase
from presswork.mesh.files.dynain import read_dynain
from presswork.post import judge_result
from presswork.post.formability import judge_cells, judge_part, list_other_limits
from presswork.post.weld_lines import find_welds
from presswork.process.begin import begin
from presswork.recorder import run_model
from presswork.results import Result
from presswork.view.plots.forming_limit_plot import plot_forming_limit
from presswork.view.plots.shell_plot import plot_shell

STEEL = {
    "young": "210 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
    "hardening": {"law": "swift", "K": 500, "n": 0.2, "e0": 0.002}, "forming_limit": {"law": "keeler", "n": 0.2},
}  # fmt: skip
OPENING = {"shape": "rectangular", "size": [56, 56], "corner_radius": 12, "edge_radius": 6, "mu": 0.05}
TOOLS = {
    "punch": {"kind": "punch", "shape": "rectangular", "size": [51, 51], "corner_radius": 10, "edge_radius": 6},
    "die": {"kind": "die", **OPENING},
    "holder": {"kind": "holder", **OPENING},
}
THICK = {"name": "thick", "line": [[5, -50], [5, 50]], "side": "right", "thickness": 1.4}


def cup(*, stroke: float = 4.0, **changes: Any) -> dict[str, Any]:
    """Return a half of a square cup of a welded blank, on a coarse mesh."""
    blank = {"shape": "rectangle", "size": [100, 100], "element_size": 7, "thickness": 1.0, "material": "steel",
             "symmetry": ["y"], "zones": [THICK]}  # fmt: skip
    draw = {"punch": {"stroke": stroke}, "holder": {"force": "20 kN"}}
    case = {
        "title": "welded", "analysis": "stamping", "materials": {"steel": STEEL}, "tools": TOOLS,
        "stages": [{"name": "draw", "velocity": "4 m/s", "tools": draw}],
        "implicit": {"max_increment": 0.2, "initial_increment": 0.01}, "output": {"steps": 1, "rows": 10},
    }  # fmt: skip
    return case | {"blank": blank | changes.pop("blank", {})} | changes


def record(case: dict[str, Any], folder: Path) -> Result:
    """Run a case and return its results."""
    run_model(build_model(StampingCase.model_validate(case)), folder, threads=1)
    return Result(folder)


@pytest.mark.parametrize("procedure", ["explicit", "implicit"])
@pytest.mark.parametrize("relief", [True, False])
def test_thin_zone_lies_level_with_the_thick_one_on_a_relieved_die_and_lower_on_a_plain_one(procedure, relief) -> None:
    """A fluid presses the blank on the die: its middle is half of what the die finds as thickness above the face."""
    case = cup(
        procedure=procedure, tools={"die": TOOLS["die"]}, blank={"relief": relief},
        pressure={"water": {"face": "top"}}, explicit={"damping": 2000},
        implicit={"max_increment": 0.1, "initial_increment": 0.001, "inertia": 1, "damping": 2000},
        stages=[{"name": "press", "duration": 4e-3, "pressure": {"water": {"p": "0.02 MPa"}}}],
    )  # fmt: skip
    run = begin(build_model(StampingCase.model_validate(case)), threads=1)
    for _ in run.advance():
        pass
    x, _, z = (run.positions() - [0.0, 0.0, -0.7]).T  # above the die's face
    assert z[x > 42.0] == pytest.approx(0.7, abs=0.015 if relief else 0.1)  # the step at the weld lifts its edge
    assert z[x < -42.0] == pytest.approx(0.7 if relief else 0.5, abs=0.015)


def test_weld_line_moves_into_the_thick_half_on_the_punch_and_its_fields_are_saved(tmp_path: Path) -> None:
    result = record(cup(stroke=8.0), tmp_path)
    weld = json.loads((tmp_path / "summary.json").read_text("utf-8"))["weld_lines"]["thick"]
    assert weld["into_zone"]["mm"] > 0.1
    assert weld["into_zone"]["place"][2] < -6.0  # on the punch
    assert result.history["thick.weld_movement"][-1] == pytest.approx(weld["movement_mm"])
    assert abs(result.history["thick.weld_movement"][0]) < 0.01
    zone = result.field("zone")
    assert set(zone.tolist()) == {0.0, 1.0}
    assert result.zones == ["", "thick"]
    x = result.mesh.points[find_welds(result)][..., 0]
    assert x == pytest.approx(5.0)
    lines = {line.name: line.figure for line in judge_result(result).lines}
    assert lines["weld line of thick"].startswith("moved by ")
    assert len(list_other_limits(result)) == 1
    # the page and pictures judge each zone by its own curve, as the run does
    assert judge_cells(result)["forming_limit_margin"] == pytest.approx(result.field("forming_limit_margin"))
    assert judge_part(result).forming_limit.count("Keeler") == 2


def test_welded_part_is_trimmed_and_springs_back_with_its_zones(tmp_path: Path) -> None:
    trim = {"rim": {"shape": "rectangle", "size": [88, 88], "corner_radius": 10}}
    result = record(cup(trim=trim, springback={}), tmp_path)
    thickness, zone = result.field("thickness"), result.field("zone")
    assert thickness[zone == 0].mean() == pytest.approx(1.0, abs=0.05)
    assert thickness[zone == 1].mean() == pytest.approx(1.4, abs=0.05)
    assert np.abs(result.mesh_at(-1).points[:, :2]).max() < 47.0
    assert np.abs(result.field("thickness_strain")).max() < 0.1
    assert np.linalg.norm(result.field("springback"), axis=1).max() > 1e-3


def test_operations_hand_over_zones_and_refinement_splits_them(tmp_path: Path) -> None:
    """The second operation begins with the thickness that the first has left."""
    first = {"tools": TOOLS, "stages": cup()["stages"], "name": "draw"}
    case = cup(blank={"refine": {"levels": 1, "angle": 15}})
    case["operations"] = [
        first,
        {
            **first,
            "name": "again",
            "stages": [
                {"name": "draw", "velocity": "4 m/s", "tools": {"punch": {"stroke": 6.0}, "holder": {"force": "20 kN"}}}
            ],
        },
    ]
    del case["tools"], case["stages"]
    result = record(case, tmp_path)
    thickness, zone = result.field("thickness"), result.field("zone")
    assert len(zone) > len(result.field("zone", 0))
    assert thickness[zone == 0].max() < 1.15 < 1.25 < thickness[zone == 1].min()
    assert result.field("thinning")[zone == 1].max() < 20.0


def test_resumed_run_of_a_welded_blank_has_the_same_bits(tmp_path: Path) -> None:
    """The checkpoint after half of the rows is taken up; rows beyond it are computed anew."""
    case = cup()
    case["output"] = {"steps": 1, "rows": 10, "checkpoint_every": 5}
    model = build_model(StampingCase.model_validate(case))
    whole, half = begin(model, threads=1), begin(model, threads=1)
    arrays: dict[str, Any] = {}
    for report in whole.advance():
        if report.number == 5:
            arrays = {name: np.array(values) for name, values in whole.to_arrays().items()}
    half.load_arrays(arrays)
    for _ in half.advance():
        pass
    assert np.array_equal(half.positions(), whole.positions())  # type: ignore[attr-defined]


def test_zone_without_a_forming_limit_is_drawn_as_not_judged(tmp_path: Path) -> None:
    plain = {key: value for key, value in STEEL.items() if key != "forming_limit"}
    zone = {key: value for key, value in THICK.items() if key != "thickness"} | {"material": "plain"}
    case = cup(stroke=2.0, blank={"zones": [zone]})
    case["materials"] = {"steel": STEEL, "plain": plain}
    result = record(case, tmp_path)
    zones = result.field("formability_zone")
    assert np.isnan(zones[result.field("zone") == 1]).all()
    assert np.isfinite(zones[result.field("zone") == 0]).all()
    for figure in (plot_shell(result, "formability_zone"), plot_forming_limit(result)):
        legends = [*figure.legends, *(found for ax in figure.axes if (found := ax.get_legend()))]
        texts = [text.get_text() for legend in legends for text in legend.get_texts()]
        assert any("safe" in text for text in texts)
        assert any("not judged" in text for text in texts)


def test_part_of_a_welded_blank_is_written_as_dynain_and_takes_no_zones_when_read(tmp_path: Path) -> None:
    """The file has each element's own thickness; which zone it was of is not in it."""
    case = cup(stroke=2.0, output={"steps": 1, "rows": 10, "dynain": True})
    result = record(case, tmp_path / "first")
    part = read_dynain(tmp_path / "first" / "part.dynain")
    assert part.thickness == pytest.approx(result.field("thickness"), rel=1e-3)
    again = cup(blank={"shape": "file", "path": str(tmp_path / "first" / "part.dynain")})
    del again["blank"]["size"], again["blank"]["element_size"]
    with pytest.raises(CaseError, match=r"blank\.zones: a formed sheet has the thickness of each element"):
        build_model(StampingCase.model_validate(again))
