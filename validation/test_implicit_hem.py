# SPDX-License-Identifier: Apache-2.0
"""A rim hemmed onto the panel itself by both procedures: the flange lies a thickness off it, in the same place.

With the fold left open, a rope hem, and by increments pressed flat, without an inner radius.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.model import FloatArray
from tests.problems.hems import ROOM, SHEET, block, hem_line
from tests.regression.whole_runs import run_stamping

pytestmark = pytest.mark.validation


def held_hem() -> dict[str, Any]:
    """Return the line of tests/regression with the panel held down and a longer face at 45 degrees."""
    data = hem_line(0.0)
    flange, hem = data["operations"]
    flange["springback"] = {}
    hem["tools"]["pad"] = block("holder", 0, 2, 0, 0.9, radius=[0, 0.3, 0.3, 0], position=[0, 0, 0.5 * SHEET])
    hem["tools"]["prehem"]["corners"] = [[16.5, 3], [22, 8.5], [10, 20.5], [4.5, 15]]
    return data


def rope_hem(procedure: str, folder: Path) -> Result:
    """Hem slowly and leave the fold open."""
    data = held_hem()
    flange, hem = data["operations"]
    hem["tools"]["steel"] = block("punch", 0, 8, 0, 8, radius=[0, 1, 0, 0], position=[0, 0, 9.0])
    flange["stages"][0]["velocity"] = hem["stages"][0]["velocity"] = "0.6 m/s"
    hem["stages"][1]["duration"] = "12 ms"
    return run_stamping(data, folder, procedure=procedure)


@pytest.fixture(scope="module")
def hems(tmp_path_factory: pytest.TempPathFactory) -> list[Result]:
    """By increments, and by explicit dynamics."""
    return [rope_hem(procedure, tmp_path_factory.mktemp(procedure)) for procedure in ("implicit", "explicit")]


def lie(hem: Result) -> tuple[FloatArray, FloatArray]:
    """Return the nodes as they lie at the end (n, 3) and on the flat blank (n, 3) [mm]."""
    step = len(hem.times) - 1
    blank = hem.mesh_at(step).points
    return blank + hem.field("displacement", step=step), blank


def force_at(hem: Result, tool: str, stage: str, strokes: list[float]) -> FloatArray:
    """Return the force of a tool in a stage at strokes [N]."""
    own = hem.history["stage"] == stage
    return np.interp(strokes, hem.history[f"{tool}.stroke"][own], np.abs(hem.history[f"{tool}.force"][own]))


def test_the_flange_lies_on_the_panel_two_half_thicknesses_off(hems) -> None:
    """No penetration beyond what contact gives; the steel leaves 4 % more room than two layers need."""
    for hem in hems:
        x, blank = lie(hem)
        flange, panel = (x[:, 0] < 7.0) & (blank[:, 0] > 12.0), blank[:, 0] < 9.0
        below = x[panel][np.argsort(x[panel, 0])]
        gap = x[flange, 2] - np.interp(x[flange, 0], below[:, 0], below[:, 2])
        assert len(gap) > 20
        assert gap.min() > 0.99 * SHEET
        assert gap.max() < 1.05 * SHEET
        assert hem.summary["overlap_mm"] < 0.01 * SHEET


def test_both_procedures_hem_alike(hems) -> None:
    implicit, explicit = hems
    (x, blank), (other, _) = lie(implicit), lie(explicit)
    np.testing.assert_allclose(x, other, atol=0.1 * SHEET)
    assert np.abs(x - blank).max() > 15.0
    ours, theirs = (force_at(hem, "hem_prehem", "hem_prehem", [1.0, 2.0, 3.0, 4.0]) for hem in hems)
    np.testing.assert_allclose(ours, theirs, rtol=0.02)
    assert abs(implicit.history["energy_error_percent"][-1]) < 1.0


@pytest.mark.xfail(strict=True, reason="7 and 18 %: half a thickness inside on shells that turn by 28 degrees")
@pytest.mark.parametrize(
    ("tool", "stage", "stroke", "tolerance"),
    [("hem_prehem", "hem_prehem", 6.0, 0.06), ("hem_steel", "hem_press", 7.46, 0.1)],
)
def test_forces_on_a_sharp_fold_are_alike(hems, tool, stage, stroke, tolerance) -> None:
    """There the moment of explicit shells, with linear strains, is 7 % above that of fibres, of these 5 % below."""
    ours, theirs = (force_at(hem, tool, stage, [stroke]) for hem in hems)
    np.testing.assert_allclose(ours, theirs, rtol=tolerance)


@pytest.mark.parametrize(("size", "overlap"), [(0.5, 0.01), (0.25, 0.03)])
def test_a_fold_is_pressed_flat_by_increments_without_an_inner_radius(size, overlap, tmp_path) -> None:
    """It stands up by less than a twentieth of the two layers, and its edge lies where the explicit one does.

    Shells turn inside out in such a fold if their inner face is 1 - t/2R as long as their middle.
    """
    data = held_hem()
    data["blank"]["element_size"] = [size, 1.0]
    hem = run_stamping(data, tmp_path, procedure="implicit")
    x, blank = lie(hem)
    flange, panel = (x[:, 0] < 7.0) & (blank[:, 0] > 12.0), blank[:, 0] < 9.0
    gap = x[flange, 2].mean() - x[panel, 2].mean()
    assert gap == pytest.approx(ROOM - SHEET, abs=0.04 * SHEET)
    assert x[:, 2].max() - x[panel, 2].mean() < ROOM - SHEET + 0.1 * SHEET
    assert x[:, 0].max() == pytest.approx(11.09, abs=0.15 * SHEET)
    assert hem.summary["overlap_mm"] < overlap * SHEET
