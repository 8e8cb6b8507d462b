# SPDX-License-Identifier: Apache-2.0
"""The blank of a round cup, found by drawing it again and again, against the blank of constant area."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

from presswork.case import CaseError, StampingCase, build_model
from presswork.cli import app
from presswork.results import OutputError
from presswork.study import find_blank_shape, surround_opening

PUNCH, DIE, PUNCH_EDGE, DIE_EDGE, THICKNESS, STROKE = 25.0, 26.25, 5.0, 6.0, 0.8, 12.0
FLANGE = 36.0
"""Radii, sheet and depth of the cup, and the radius its flange is to have [mm]."""


def cup(**changes: Any) -> dict[str, Any]:
    return {
        "title": "round cup",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 96, "thickness": THICKNESS, "element_size": 4, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": {"young": "206 GPa", "poisson": 0.3,
                                "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
        "tools": {
            "punch": {"kind": "punch", "shape": "round", "diameter": 2 * PUNCH, "edge_radius": PUNCH_EDGE},
            "die": {"kind": "die", "shape": "round", "diameter": 2 * DIE, "edge_radius": DIE_EDGE},
            "holder": {"kind": "holder", "shape": "round", "diameter": 2 * DIE, "edge_radius": 1},
        },
        "stages": [{"name": "draw", "velocity": "10 m/s",
                    "tools": {"punch": {"stroke": STROKE}, "holder": {"force": "10 kN"}}}],
        "output": {"rows": 4, "steps": 1},
        **changes,
    }  # fmt: skip


def write(folder: Path, **changes: Any) -> Path:
    path = folder / "cup.toml"
    path.write_text(tomli_w.dumps(cup(**changes)))
    return path


def radius_of_constant_area() -> float:
    """Return the radius of the disc as large as the drawn mid-surface [mm]: flat, arc, tangent cone, arc, flat."""
    one, other = PUNCH_EDGE + THICKNESS / 2, DIE_EDGE + THICKNESS / 2
    first = np.array([PUNCH - PUNCH_EDGE, one - STROKE])
    last = np.array([DIE + DIE_EDGE, -other])
    way = last - first
    # the inner tangent of two circles
    steep = np.arctan2(way[1], way[0]) + np.arcsin((one + other) / np.linalg.norm(way))
    down = np.linspace(0.0, steep, 400)
    inner = first + one * np.stack([np.sin(down), -np.cos(down)], axis=1)
    outer = last + other * np.stack([-np.sin(down[::-1]), np.cos(down[::-1])], axis=1)
    line = np.concatenate([[[0.0, -STROKE]], inner, outer, [[FLANGE, 0.0]]])
    r, z = line.T
    return float(np.sqrt(((r[1:] + r[:-1]) * np.hypot(np.diff(r), np.diff(z))).sum()))


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cup")
    angle = np.radians(np.arange(0.0, 360.0, 2.0))
    target = FLANGE * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return find_blank_shape(write(folder), target, folder / "out", tolerance=0.1, threads=1)


def test_the_blank_has_constant_area(found) -> None:
    """The sheet's thickness, and so its area, changes by about a hundredth on the whole, the radius by half of that."""
    assert found.status == "completed"
    assert np.abs(np.linalg.norm(found.best.fit.drawn, axis=1) - FLANGE).max() <= 0.1
    radii = np.linalg.norm(found.best.fit.blank, axis=1)
    assert np.ptp(radii) < 0.3
    assert radii.mean() == pytest.approx(radius_of_constant_area(), rel=0.01)


def test_corrections_pulled_back_converge_fast(found) -> None:
    """The first blank is 8 mm too large; a correction by the deviation itself would leave 1.5 mm and more of it."""
    worst = [draw.fit.worst for draw in found.draws]
    assert worst[0] > 8.0
    assert worst[1] < 1.0
    assert len(worst) <= 4


def test_what_it_leaves(found) -> None:
    with open(found.folder / "table.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["draw"]) for row in rows] == list(range(len(found.draws)))
    assert float(rows[-1]["largest_deviation_mm"]) == pytest.approx(found.best.fit.worst * np.sign(
        float(rows[-1]["largest_deviation_mm"])))  # fmt: skip
    assert float(rows[-1]["share_within_percent"]) == 100.0
    assert (found.folder / "outlines.png").is_file()
    assert (found.folder / "blank.dxf").is_file()
    checked = CliRunner().invoke(app, ["check", str(found.folder / "blank.toml")])
    assert checked.exit_code == 0, checked.output
    last = build_model(StampingCase.from_toml(found.folder / "blank.toml")).mesh.points
    assert np.abs(last).max() == pytest.approx(np.abs(found.best.fit.blank).max(), abs=1e-3)


@pytest.mark.validation
def test_a_search_that_was_stopped_goes_on(found, tmp_path) -> None:
    """Its first draw is kept, and the second, without a checkpoint, is drawn anew to the same bits."""
    folder = tmp_path / "out"
    shutil.copytree(found.folder, folder)
    for path in folder.glob("draw_0[1-9]/checkpoint*"):
        path.unlink()
    (folder / "table.csv").unlink()
    with pytest.raises(OutputError, match=r"already holds a search.*--resume"):
        find_blank_shape(write(tmp_path), found.target, folder, tolerance=1.0)
    first = (folder / "draw_00" / "summary.json").stat().st_mtime_ns
    again = find_blank_shape(write(tmp_path), found.target, folder, tolerance=1.0, threads=1, resume=True)
    assert (folder / "draw_00" / "summary.json").stat().st_mtime_ns == first
    assert [draw.fit.worst for draw in again.draws] == [draw.fit.worst for draw in found.draws[:2]]
    with pytest.raises(OutputError, match="draw_00 belongs to another case"):
        find_blank_shape(write(tmp_path), found.target, folder, tolerance=1.0, resume=True,
                         settings=["blank.thickness=0.9"])  # fmt: skip
    with pytest.raises(OutputError, match=r"no search in .* to resume"):
        find_blank_shape(write(tmp_path), found.target, tmp_path / "none", tolerance=1.0, resume=True)


@pytest.mark.validation
def test_a_draw_on_a_cluster_has_the_bits_of_one_here(found, tmp_path) -> None:
    drawn = find_blank_shape(write(tmp_path), found.target, tmp_path / "out", tolerance=0.1, most=1, cluster="local")
    assert (drawn.status, len(drawn.draws)) == ("gave_up", 1)
    assert drawn.draws[0].fit.worst == found.draws[0].fit.worst
    history = [shape.draws[0].folder / "history.csv" for shape in (drawn, found)]
    assert history[0].read_bytes() == history[1].read_bytes()


def test_the_target_round_an_opening(tmp_path) -> None:
    around = surround_opening(write(tmp_path), 9.75)
    assert np.linalg.norm(around, axis=1) == pytest.approx(np.full(len(around), FLANGE))
    tools = cup()["tools"]
    tools["die"] |= {"shape": "rectangular", "size": [60, 40], "corner_radius": 8}
    del tools["die"]["diameter"]
    square = surround_opening(write(tmp_path, tools=tools), 5.0)
    assert np.abs(square).max(axis=0) == pytest.approx([35.0, 25.0])
    centre = np.array([22.0, 12.0])
    corner = square[(square > centre).all(axis=1)]
    assert np.linalg.norm(corner - centre, axis=1) == pytest.approx(np.full(len(corner), 13.0))


def search(case: Path, *words: object):
    return CliRunner().invoke(
        app, ["blank", str(case), "--output", str(case.parent / "out"), "--threads", "1", *map(str, words)]
    )


@pytest.mark.validation
def test_a_search_that_does_not_arrive_says_how_far_it_is(tmp_path) -> None:
    stages = cup()["stages"]
    stages[0]["tools"]["punch"]["stroke"] = 1.0
    case = write(tmp_path, stages=stages)
    done = search(case, "--flange-width", 9.75, "--draws", 1)
    assert done.exit_code == 3
    assert "mm off after 1 draws, near (" in done.output
    again = search(case, "--flange-width", 9.75, "--draws", 1)
    assert again.exit_code == 2
    assert "--overwrite" in again.output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "either --target or --flange-width"),
        (["--flange-width", 5, "--target", "x.csv"], "either --target or --flange-width"),
        (["--target", "x.csv"], "no such file"),
        (["--flange-width", -30], "leaves no outline"),
        (["--flange-width", 5, "--tolerance", 0], "--tolerance"),
        (["--flange-width", 5, "--damping", 1.5], "--damping"),
        (["--flange-width", 5, "--set", "blank.thickness=-1"], "blank.thickness"),
        (["--flange-width", 5, "--set", "trim.t={shape='circle', diameter=80}"], "leave the trim lines out"),
        (["--flange-width", 5, "--overwrite", "--resume"], "exclude each other"),
        (["--flange-width", 5, "--set", "stages.0.tools.punch.force=5"], "stroke"),
    ],
)
def test_bad_input_is_refused(tmp_path, words, said) -> None:
    done = search(write(tmp_path), *words)
    assert done.exit_code == 2, done.output
    assert said in done.output
    assert not (tmp_path / "out" / "table.csv").exists()


def test_a_strip_die_has_no_opening_to_go_round(tmp_path) -> None:
    tools = cup()["tools"]
    tools["die"] = {"kind": "die", "shape": "strip", "width": 52.5, "edge_radius": 6}
    with pytest.raises(CaseError, match="--target"):
        surround_opening(write(tmp_path, tools=tools), 5.0)
