# SPDX-License-Identifier: Apache-2.0
"""Whether runs split or wrinkle: a strip in tension against its closed form, a deep cup, one that is held too hard."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import Result
from presswork.case import ShellCase, StampingCase, build_model
from presswork.cli import app
from presswork.formability import ZONES, Formability
from presswork.post import judge_cells, judge_part
from presswork.recorder import run_model
from presswork.results import ResultError
from presswork.view.all_plots import plot_all
from presswork.view.plots.shell_plot import plot_shell
from presswork.view.style import bare_figure

KEELER = {"law": "keeler", "thickness": 1, "n": 0.2589}
SHEET = {"young": "206 GPa", "poisson": 0.3,
         "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}  # fmt: skip


def cup(force: float, stroke: float, mu: float, **sheet: Any) -> StampingCase:
    return StampingCase.model_validate({
        "title": "coarse cup", "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 60, "thickness": 1, "element_size": 3, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": SHEET | sheet},
        "tools": {
            "punch": {"kind": "punch", "shape": "round", "diameter": 30, "edge_radius": 5, "mu": mu},
            "die": {"kind": "die", "shape": "round", "diameter": 33, "edge_radius": 5, "mu": mu},
            "holder": {"kind": "holder", "shape": "round", "diameter": 34, "edge_radius": 1, "mu": mu},
        },
        "stages": [{"name": "draw", "velocity": "5 m/s",
                    "tools": {"punch": {"stroke": stroke}, "holder": {"force": force}}}],
        "output": {"rows": 20, "steps": 1},
    })  # fmt: skip


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Result:
    folder = tmp_path_factory.mktemp("cup") / "drawn"
    return run_model(build_model(cup(8e3, 12, 0.05, forming_limit=KEELER)), folder, threads=1).result


@pytest.fixture(scope="module")
def torn(tmp_path_factory: pytest.TempPathFactory) -> Result:
    folder = tmp_path_factory.mktemp("cup") / "torn"
    return run_model(build_model(cup(2.5e5, 12, 0.3, forming_limit=KEELER)), folder, threads=1).result


def zones_of(result: Result, inside: float, outside: float) -> set[str]:
    """Zones of the cells whose middle lay between two radii of the blank."""
    (block,) = result.mesh.blocks
    radius = np.hypot(*result.mesh.points[block.connectivity].mean(axis=1).T[:2])
    chosen = result.field("formability_zone")[(radius > inside) & (radius < outside)]
    return {ZONES[int(zone)] for zone in chosen}


def test_a_deep_cup_wrinkles_in_its_flange_and_nowhere_cracks(drawn: Result) -> None:
    """The edge of a drawn flange is in compression alone: it thickens. The bottom is hardly stretched."""
    assert zones_of(drawn, 27.0, 30.0) == {"wrinkles unless held"}
    assert zones_of(drawn, 0.0, 10.0) <= {"safe", "insufficient stretch"}
    summary = drawn.summary
    assert summary["formability"]["failing_cells"] == 0
    assert summary["formability"]["folds"] == 0
    assert drawn.field("fold_ratio").max() == summary["formability"]["largest_fold_ratio"]["value"] < 0.3
    assert "no element lies above the forming limit" in summary["formability"]["verdict"]
    assert sum(summary["formability"]["zones"].values()) == len(drawn.mesh.blocks[0].connectivity)
    assert drawn.field("wrinkling_indicator")[drawn.field("formability_zone") == 5].min() > 0


def test_a_flange_that_is_held_fast_splits_the_cup_at_its_wall(torn: Result) -> None:
    """The flange stands still, so the wall is stretched: it cracks there, and the summary says so."""
    found = torn.summary["formability"]
    assert found["failing_cells"] > 0
    assert any("the part splits" in warning for warning in torn.summary["warnings"])
    assert np.hypot(*found["least_margin"]["place"][:2]) < 30 / 2 + 5
    cell = found["least_margin"]["cell"]
    assert torn.field("forming_limit_margin")[cell] == torn.field("forming_limit_margin").min() < 0
    assert ZONES[int(torn.field("formability_zone")[cell])] == "cracks"
    np.testing.assert_allclose(torn.field("thinning"), 100 * (1 - torn.field("thickness") / 1.0))


def test_the_saved_run_is_judged_alike_and_by_another_limit(drawn: Result) -> None:
    """Everything that is needed lies in the results; a limit a third as high finds cracks."""
    for name, values in judge_cells(drawn).items():
        np.testing.assert_array_equal(values, drawn.field(name))
    assert judge_part(drawn).to_summary()["zones"] == drawn.summary["formability"]["zones"]
    kept = drawn.formability
    assert kept.curve is not None
    low = Formability(type(kept.curve)(kept.curve.minor, kept.curve.major / 3, "a third"), 0.1, kept.r)
    assert judge_part(drawn, judged=low).failing > 0
    assert judge_part(drawn, step=0).thinning.value == pytest.approx(0.0, abs=1e-9)


def test_the_command_line_tells_it_and_writes_section_and_outline(torn: Result, tmp_path: Path) -> None:
    told = CliRunner().invoke(app, ["plot", str(torn.folder), "--out", str(tmp_path), "--field", "forming_limit_margin",
                                    "--section", "45", "--outline", str(tmp_path / "flange.csv")])  # fmt: skip
    assert told.exit_code == 0, told.output
    assert "at the end: the part splits" in told.output
    assert (tmp_path / "section_0_0_45_001.csv").is_file()
    assert (tmp_path / "flange.csv").is_file()
    wrong = CliRunner().invoke(app, ["plot", str(torn.folder), "--section", "north"])
    assert wrong.exit_code == 2
    assert "expected ANGLE, X,Y,ANGLE or X,Y,X,Y" in wrong.output


def pulled(**sheet: Any) -> StampingCase:
    return StampingCase.model_validate({
        "title": "strip", "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 2, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": SHEET | sheet},
        "stages": [{"name": "pull", "velocity": "1 m/s",
                    "displacement": [{"set": "right", "component": "x", "value": 1}]}],
        "output": {"rows": 10, "steps": 1},
    })  # fmt: skip


def test_the_margin_of_a_strip_in_tension_is_that_of_its_closed_form(tmp_path: Path) -> None:
    """Major strain ln 1.1 under a level limit of 0.12; plastic strain narrows it as much as it thins it."""
    limit = {"law": "points", "points": [[-0.3, 0.12], [0.1, 0.12]]}
    result = run_model(build_model(pulled(forming_limit=limit)), tmp_path / "out", threads=1).result
    np.testing.assert_allclose(result.field("forming_limit_margin"), 1 - np.log(1.1) / 0.12, rtol=0.02)
    np.testing.assert_allclose(result.field("wrinkling_indicator"), 0.0, atol=2e-4)
    np.testing.assert_allclose(result.field("thinning"), 100 * (1 - 1.1**-0.5), rtol=0.02)
    names = {path.name for path in plot_all(result, tmp_path)}
    assert {"forming_limit_001.png", "shell_formability_zone_001.png", "shell_thinning_001.png"} <= names


def test_a_material_without_a_limit_is_told_of(tmp_path: Path) -> None:
    result = run_model(build_model(pulled()), tmp_path / "out", threads=1).result
    assert "cracks are not judged" in result.summary["formability"]["verdict"]
    assert result.formability.curve is None
    with pytest.raises(ResultError, match=r"no field formability_zone \(the material has no forming_limit"):
        result.field("formability_zone")
    assert not [p for p in plot_all(result, tmp_path / "plots", []) if "forming_limit" in p.name]


def test_shells_under_loads_are_judged_too(tmp_path: Path) -> None:
    """The same tension by the implicit procedure."""
    case = ShellCase.model_validate({
        "title": "strip", "analysis": "shell",
        "workpiece": {"material": "steel", "element": "shell4_mitc", "section": {"thickness": 0.8},
                      "mesh": {"size": [10, 4], "cells": [2, 1]}},
        "materials": {"steel": SHEET | {"forming_limit": {"law": "points", "points": [[-0.3, 0.08], [0.0, 0.08]]}}},
        "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]},
                     "z": {"set": "all", "fix": ["z"]}},
        "stages": [{"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 1}]}],
    })  # fmt: skip
    result = run_model(build_model(case), tmp_path / "out", threads=1).result
    np.testing.assert_allclose(result.field("forming_limit_margin"), 1 - np.log(1.1) / 0.08, rtol=1e-6)
    assert result.summary["formability"]["failing_cells"] == 2
    assert any("2 of 2 elements lie above the forming limit" in warning for warning in result.summary["warnings"])


def test_pictures_of_limits_say_what_the_run_was_judged_to_be(drawn: Result, torn: Result) -> None:
    for result in (drawn, torn):
        verdict = result.summary["formability"]["verdict"].partition(";")[0]
        for field in ("formability_zone", "forming_limit_margin"):
            assert plot_shell(result, field, figure=bare_figure()).get_supxlabel().split("\n")[-1] == verdict
        assert verdict not in plot_shell(result, "forming_limit_margin", 0, figure=bare_figure()).get_supxlabel()
    assert plot_shell(drawn, "fold_ratio", figure=bare_figure()).get_supxlabel().endswith("of the whole part")
