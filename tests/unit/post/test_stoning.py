# SPDX-License-Identifier: Apache-2.0
"""Gaps under a stone: dents, hollows and bulges of closed forms; a panel that a run has left."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork.api import load, run
from presswork.cli.commands import app
from presswork.examples import copy_example
from presswork.post.stoning import find_gaps, find_heights, stone
from presswork.results import Result

STEP = 0.5
ALONG = np.arange(-150.0, 150.0 + 0.5 * STEP, STEP)


def gaps(height: np.ndarray, length: float) -> np.ndarray:
    return find_gaps(height[None], length, STEP)[0]


def test_a_dent_shorter_than_the_stone_has_its_depth_as_gap() -> None:
    dent = np.where(np.abs(ALONG) < 20.0, -0.05 * np.cos(np.pi * ALONG / 40.0) ** 2, 0.0)
    assert gaps(dent, 60.0).max() == pytest.approx(0.05, rel=1e-9)
    assert gaps(dent, 20.0).max() < 0.03
    assert gaps(-dent, 60.0)[np.abs(ALONG) < 1.0].max() < 1e-4, "on a bulge the stone touches"


def test_a_dent_in_a_cylinder_has_the_gap_of_its_closed_form() -> None:
    """R 3000, A exp(-s^2/(2 w^2)), A 0.05, w 10: 0.0031512 once the stone is longer than 18.01; none if A/w^2 < 1/R."""
    cylinder, dent = np.sqrt(3000.0**2 - ALONG**2), np.exp(-0.5 * (ALONG / 10.0) ** 2)
    for length in (18.5, 40.0, 100.0):
        assert gaps(cylinder - 0.05 * dent, length).max() == pytest.approx(0.0031512, abs=1e-6)
    assert gaps(cylinder - 0.05 * dent, 16.0).max() < 0.00309
    assert gaps(cylinder - 0.033 * dent, 100.0).max() == 0.0


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_a_hollow_radius_has_the_gap_of_the_stone_s_length(slope: float) -> None:
    """L^2/(8 R): 100 over 5000 is 0.25; what is added to a slope s is less curved by (1 + s^2)^1.5."""
    hollow = 5000.0 - np.sqrt(5000.0**2 - ALONG**2)
    found = gaps(hollow + slope * ALONG, 100.0)[len(ALONG) // 2]
    assert found == pytest.approx(0.25 / (1.0 + slope**2) ** 1.5, rel=0.01)


def test_heights_over_a_grid_are_those_of_the_upper_triangles() -> None:
    points = np.array([[0, 0, 0], [10, 0, 1], [10, 10, 3], [0, 10, 2], [0, 0, 5], [4, 0, 5], [0, 4, 5]], dtype=float)
    heights = find_heights(points, np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6]]), np.arange(0, 12.0), np.arange(0, 11.0))
    assert heights[10, 10] == pytest.approx(3.0)
    assert heights[8, 3] == pytest.approx(0.1 * 8 + 0.2 * 3)
    assert heights[1, 1] == 5.0
    assert np.isnan(heights[11]).all()


@pytest.fixture(scope="module")
def roof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run of a cylindrical roof of 25 mm radius."""
    folder = tmp_path_factory.mktemp("roof")
    case = copy_example("scordelis_lo_roof", folder)
    run(load(case), folder / "out", threads=1)
    return folder / "out"


def test_a_stone_is_drawn_over_a_run_from_the_command_line(roof: Path) -> None:
    """From below the roof is a hollow; along its axis, and from above, the stone touches."""
    pytest.importorskip("matplotlib")
    common = ["stone", str(roof), "--length", "10", "--spacing", "0.5", "--step", "0"]
    done = CliRunner().invoke(app, [*common, "--side", "bottom"])
    assert done.exit_code == 0, done.output
    with (roof / "stoning_x.csv").open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    assert max(row["gap_mm"] for row in rows) < 1e-9, "along its axis the roof is straight"
    with (roof / "stoning_y.csv").open() as file:
        across = [float(row["gap_mm"]) for row in csv.DictReader(file)]
    assert 0.45 < max(across) <= 25.0 - np.sqrt(25.0**2 - 5.0**2) + 1e-9, "the height of an arc over 10 mm"
    assert "stone of 10 mm along y, bottom: largest gap 0." in done.output
    above = CliRunner().invoke(app, [*common, "--side", "top", "--direction", "y"])
    assert "largest gap 0.0000 mm" in above.output, "from above it is a bulge"
    assert (roof / "plots" / "stoning_y.png").stat().st_size > 5_000


def test_a_stone_lies_over_the_images_of_a_part_that_symmetry_planes_cut(roof: Path) -> None:
    """A quarter of the roof, from below: at its crown, on a symmetry plane, the stone leaves the arc's height."""
    at_crown = []
    for mirror in ("", "y", "xy"):
        found = stone(Result(roof), length=10.0, spacing=0.5, direction="y", side="bottom", step=0, mirror=mirror)
        at_crown.append(float(np.nanmax(found.gap[:, np.abs(found.y) < 0.3])))
        assert np.ptp(found.x) == pytest.approx(50.0 if "x" in mirror else 25.0, abs=0.6)
    assert at_crown[0] < 0.02
    assert at_crown[1] == pytest.approx(25.0 - np.sqrt(25.0**2 - 5.0**2), rel=0.1)
    assert at_crown[2] == pytest.approx(at_crown[1], rel=1e-2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--length", "500", "--spacing", "5"], "the part measures 25.01 mm; take a shorter stone"),
        (["--length", "10", "--spacing", "3"], "give at most a tenth of the stone's length, 1 mm"),
        (["--length", "10", "--spacing", "0.01"], "give at most 200 times the spacing, 2 mm"),
        (["--shows", "0.2"], "give 0 < shows < refused"),
        (["--length", "10", "--spacing", "1", "--less-formed"], "no step before and after springback"),
    ],
)
def test_stones_that_do_not_fit_are_refused(roof: Path, given: list[str], message: str) -> None:
    done = CliRunner().invoke(app, ["stone", str(roof), *given])
    assert done.exit_code == 2
    assert message in " ".join(done.output.split())
