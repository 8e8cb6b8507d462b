# SPDX-License-Identifier: Apache-2.0
"""A stamping that is trimmed: from case file to results and pictures, stopped and resumed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.model import Model
from presswork.post import cut_sheet, judge_part, measure_draw_in, trace_outline
from presswork.recorder import run_model
from presswork.view.all_plots import plot_all
from presswork.view.style import describe_step
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end

TOOL = {"shape": "rectangular", "mu": 0.1}


def cup(**changes: Any) -> Model:
    """A shallow square pan, its flange trimmed to a circle and its bottom pierced."""
    return build_model(StampingCase.model_validate({
        "title": "pan",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [64, 64], "thickness": 1, "element_size": 4, "material": "steel",
                  "symmetry": ["x", "y"], "points": 3},
        "materials": {"steel": {"young": 207e3, "poisson": 0.3, "forming_limit": {"law": "swift_hill"},
                                "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}},
        "tools": {
            "punch": {"kind": "punch", "size": [30, 30], "corner_radius": 8, "edge_radius": 6, **TOOL},
            "die": {"kind": "die", "size": [34, 34], "corner_radius": 10, "edge_radius": 6, **TOOL},
            "holder": {"kind": "holder", "size": [34, 34], "corner_radius": 10, "edge_radius": 1, **TOOL},
        },
        "stages": [{"name": "draw", "velocity": "8 m/s", "tools": {"punch": {"stroke": 3}, "holder": {"force": 5e3}}}],
        "trim": {"flange": {"shape": "circle", "diameter": 57},
                 "hole": {"shape": "rectangle", "size": [14, 10], "corner_radius": 2, "keep": "outside"}},
        "springback": {"increments": 2},
        "output": {"rows": 4, "steps": 1, "checkpoint_every": 1},
        **changes,
    }))  # fmt: skip


@pytest.fixture(scope="module")
def explicit_pan(tmp_path_factory) -> Result:
    return run_to_end(cup(procedure="explicit"), tmp_path_factory.mktemp("explicit") / "out")


@pytest.fixture(scope="module")
def implicit_pan(tmp_path_factory) -> Result:
    return run_to_end(cup(procedure="implicit"), tmp_path_factory.mktemp("implicit") / "out")


@pytest.fixture(params=["explicit_pan", "implicit_pan"])
def pan(request) -> Result:
    result: Result = request.getfixturevalue(request.param)
    return result


def plan_area(result: Result, step: int) -> float:
    """Area of the sheet seen along z."""
    total = 0.0
    for block in result.mesh_at(step).blocks:
        x, y = np.moveaxis(result.points(step)[block.connectivity][..., :2], -1, 0)
        total += 0.5 * float((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum())
    return total


def test_the_trimmed_step_follows_forming_on_a_mesh_of_its_own(pan) -> None:
    """Steps: blank, drawn, trimmed, sprung back."""
    assert len(pan.times) == 4
    assert pan.mesh_at(1) is pan.mesh
    assert pan.mesh_at(2) is pan.mesh_at(3)
    cells = [sum(len(b.connectivity) for b in pan.mesh_at(step).blocks) for step in range(4)]
    assert cells[0] == 64 > cells[2] == pan.summary["trim"]["cells"]
    exact = np.pi * 28.5**2 / 4 - (14 * 10 - (4 - np.pi) * 2**2) / 4
    assert plan_area(pan, 2) == pytest.approx(exact, rel=0.012)
    assert pan.summary["trim"]["off_line_mm"] < 1.0
    assert list(pan.history["stage"][-3:]) == ["trim", "springback", "springback"]
    assert (np.diff(pan.history["increment"]) == 1).all()
    for name, kind in pan.field_names.items():
        assert len(pan.field(name, 3)) == (len(pan.mesh_at(3).points) if kind == "point" else cells[3])


def test_trimming_leaves_strains_and_springback_ends_without_forces(pan) -> None:
    assert pan.field("thickness_strain", 2).min() == pytest.approx(pan.field("thickness_strain", 1).min(), abs=1e-3)
    assert not pan.field("springback", 2).any()
    moved = pan.field("springback", 3)
    np.testing.assert_allclose(moved, pan.field("displacement", 3) - pan.field("displacement", 2), atol=1e-12)
    assert 0.001 < np.linalg.norm(moved, axis=1).max() < 1.0
    held = pan.field("reaction_force", 3)
    on_planes = (np.abs(pan.mesh_at(3).points[:, :2]) < 1e-9).any(axis=1)
    assert np.abs(held[~on_planes]).max() < 1e-3 * np.abs(pan.field("reaction_force", 2)).max()


def test_lines_verdicts_and_pictures_are_those_of_the_trimmed_part(pan, tmp_path) -> None:
    outer, hole = trace_outline(pan, 2)
    assert np.linalg.norm(outer[:, :2], axis=1).max() == pytest.approx(28.5, abs=1e-9)
    np.testing.assert_allclose(np.abs(hole[:, :2]).max(axis=0), [7, 5], atol=1e-9)
    section = cut_sheet(pan, 0.0, 3)
    assert section.line[:, :, 0].max() == pytest.approx(28.5, abs=0.1)
    assert section.line[:, :, 0].min() == pytest.approx(7.0, abs=0.1)
    assert 0 < measure_draw_in(pan, 0.0, 3) < 3
    zones = judge_part(pan, 3).zones
    assert sum(zones.values()) == pan.summary["trim"]["cells"]
    written = [path.name for path in plot_all(pan, tmp_path, fields=["springback"])]
    assert {"shell_springback_003.png", "section_003.png", "forming_limit_003.png", "draw_in.png"} <= set(written)
    assert describe_step(pan, 3) == f"{describe_step(pan, 2)}, after springback"


@pytest.mark.parametrize("reports", [4, 5, 6])
def test_a_run_stopped_round_the_trimming_resumes_to_the_same_bits(explicit_pan, tmp_path: Path, reports: int) -> None:
    run_in_two_parts(cup(), tmp_path / "out", reports)
    assert_same_bits(tmp_path / "out", explicit_pan.folder)
    assert Result(tmp_path / "out").summary["trim"] == explicit_pan.summary["trim"]


def test_a_part_may_be_trimmed_and_stay_in_its_tools(tmp_path: Path) -> None:
    result = run_model(cup(springback=None), tmp_path / "out", threads=1).result
    assert len(result.times) == 3
    assert "springback" not in result.field_names
    assert result.mesh_at(2) is not result.mesh


def test_a_line_that_misses_the_formed_part_ends_the_run_with_its_reason(tmp_path: Path) -> None:
    """The blank reaches beyond the line when the case is read, the part drawn from it does not."""
    line = {"shape": "rectangle", "size": [63.9, 63.9]}
    outcome = run_model(cup(trim={"edge": line}), tmp_path / "out", threads=1)
    assert outcome.status == "gave_up"
    assert "trim.edge: the line cuts nothing off, for it runs round all of the sheet" in outcome.reason
    assert len(outcome.result.times) == 3, "the formed part is there, and the state at the end"
