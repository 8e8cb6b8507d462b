# SPDX-License-Identifier: Apache-2.0
"""Tools in space that turn, or are turned at the start, are drawn where they stand: results, ParaView and page."""

from __future__ import annotations

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.report import write_report
from presswork.results import Result
from presswork.results.vtkhdf import truncate_steps
from presswork.view.style import describe_step
from tests.unit.report.test_write import read_page
from tests.unit.report.unpack import unpack

TEXT = """
title = "tools that turn beside a block"
analysis = "solid"
[workpiece]
material = "steel"
mesh = {size = [10, 10, 8], cells = [1, 1, 1]}
[materials.steel]
young = 200e3
poisson = 0.3
hardening = {law = "swift", K = 565, e0 = 0.007, n = 0.26}
[tools.cam]
shape = "straight"
contact = "frictionless"
profile = [[0, 20], [6, 20], [6, 30]]
centre = [1, 0, 24]
position = [3, 0, 2]
free_side = "right"
[tools.bar]
shape = "straight"
contact = "frictionless"
profile = [[2, 0], [8, 1]]
centre = [5, 0, 1]
position = [-2, -20, -30]
rotation = {axis = [0, 0, 1], angle = 90}
free_side = "left"
[tools.cone]
shape = "round"
contact = "frictionless"
profile = [[0, 0], [3, -2], [3, -6]]
position = [14, 0, -12]
rotation = {axis = [0, 1, 0], angle = 90}
[boundary]
left = {set = "left", fix = ["x"]}
bottom = {set = "bottom", fix = ["y"]}
back = {set = "back", fix = ["z"]}
[[stages]]
name = "turn"
tools.cam = {turn = 90}
tools.bar = {turn = 90, move = [1, 2, -3]}
[output]
steps = 2
"""
TURNED = ((1.0, 0.0), (np.sqrt(0.5), np.sqrt(0.5)), (0.0, 1.0))
"""Cosine and sine of what the tools have turned at each saved step."""


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Result:
    folder = tmp_path_factory.mktemp("turned")
    (folder / "case.toml").write_text(TEXT)
    outcome = run_model(build_model(read_case(folder / "case.toml")), folder / "out", threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def place_cam(points: np.ndarray, part: float) -> np.ndarray:
    """Points as drawn, turned about y through (1, 24): from z towards x."""
    c, s = TURNED[round(2 * part)]
    x, y, z = (points - [1, 0, 24]).T
    turned = np.column_stack([c * x + s * z, y, c * z - s * x])
    return turned + np.array([4, 0, 26])


def place_bar(points: np.ndarray, part: float) -> np.ndarray:
    """Drawn along y, by its rotation along -x; then it turns about that axis, from z towards y, and moves."""
    c, s = TURNED[round(2 * part)]
    along, across, up = -points[:, 1], points[:, 0] - 5, points[:, 2] - 1
    turned = np.column_stack([along, c * across + s * up, c * up - s * across])
    return turned + np.array([-2, -20 + 5, -30 + 1]) + part * np.array([1, 2, -3])


def draw(profile: list[list[float]], half: float) -> np.ndarray:
    """Points of a profile in x and z drawn along y to both sides."""
    return np.array([[x, y, z] for y in (-half, half) for x, z in profile])


CAM, BAR = [[0, 20], [6, 20], [6, 30]], [[2, 0], [8, 1]]
HALF = 5.0 * float(np.linalg.norm([10, 10, 8]))


def order(points: np.ndarray) -> np.ndarray:
    """Sort points, which tools keep in the order in which they are drawn or against it."""
    return points[np.lexsort(np.round(points, 3).T)]


@pytest.mark.parametrize("step", [0, 1, 2])
def test_surfaces_stand_where_closed_forms_place_them(result: Result, step: int) -> None:
    part = step / 2
    for name, profile, place in (("cam", CAM, place_cam), ("bar", BAR, place_bar)):
        expected = place(draw(profile, HALF), part)
        np.testing.assert_allclose(order(result.placed_surface(name, step)), order(expected), atol=1e-9)
        with h5py.File(result.folder / "results.vtkhdf") as file:
            block = file[f"VTKHDF/{name}"]
            start, n = block["Points"][()], len(block["Points"])
            moved = block["PointData/displacement"][n * step : n * (step + 1)]
        np.testing.assert_allclose(order(start + moved), order(expected), atol=1e-4)


def test_a_round_tool_turned_at_the_start_lies_on_its_side(result: Result) -> None:
    """Its axis z points along x: a cone of 3 mm over 2, then a cylinder."""
    x, y, z = result.placed_surface("cone").T
    radius = np.hypot(y, z + 12)
    np.testing.assert_allclose(radius, np.minimum(1.5 * (14 - x), 3.0), atol=1e-9)
    assert (x.min(), x.max()) == pytest.approx((8.0, 14.0), abs=1e-9)


def test_the_page_places_them_likewise(result: Result, tmp_path: Path) -> None:
    found, blocks = read_page(write_report(result, tmp_path / "report.html"))
    (run,) = found["runs"]
    for number, tool in enumerate(run["tools"]):
        start = unpack(tool["points"], blocks)
        np.testing.assert_allclose(start, result.surfaces[tool["name"]][0], atol=np.ptp(start, axis=0).max() / 65534)
        for saved, step in enumerate(run["steps"]):
            moved, turned = np.split(np.array(step["tools"][number]), 2)
            centre, angle = np.array(tool["centre"]), np.linalg.norm(turned)
            axis, arm = turned / (angle or 1.0), start - centre
            carried = arm * np.cos(angle) + np.cross(axis, arm) * np.sin(angle)
            carried += np.outer(arm @ axis, axis) * (1.0 - np.cos(angle)) + centre + moved
            np.testing.assert_allclose(carried, result.placed_surface(tool["name"], saved), atol=3e-3)


def test_a_step_is_named_by_the_tool_that_moves(result: Result) -> None:
    assert describe_step(result, 2) == f"bar stroke {np.sqrt(14):.2f} mm"


def test_steps_that_a_resumed_run_takes_anew_are_cut_off(result: Result, tmp_path: Path) -> None:
    shutil.copy(result.folder / "results.vtkhdf", tmp_path)
    truncate_steps(tmp_path / "results.vtkhdf", 2)
    np.testing.assert_array_equal(Result(tmp_path).placed_surface("bar"), result.placed_surface("bar", 1))
