# SPDX-License-Identifier: Apache-2.0
"""Runs of sheets under pressure: bits, restarts, split and triangular shells, regions, stages, release."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from presswork.examples import copy_example
from presswork.recorder import run_model
from tests.problems.bulges import OIL, RADIUS, vary_bulge
from tests.regression.whole_runs import compare_with_restart, run_stamping, run_to_end

SMALL = (("blank.element_size", 8), ("output.rows", 20), ("stages.0.pressure.oil.p", 0.6))
EXPLICIT = (*SMALL, ("procedure", "explicit"), ("stages.0.duration", 0.005), ("explicit", {"damping": 2000}))


FLUID = (("pressure.oil", OIL), ("stages.0.pressure.oil", {"inflow": "20 cm^3"}))
ALL = {
    "implicit": SMALL,
    "explicit": EXPLICIT,
    "implicit fluid": (*SMALL, *FLUID),
    "explicit fluid": (*EXPLICIT, *FLUID),
}


@pytest.mark.parametrize("changes", ALL.values(), ids=list(ALL))
def test_a_restart_on_other_threads_gives_the_same_bits(changes: tuple[tuple[str, object], ...]) -> None:
    model = build_model(StampingCase.model_validate(vary_bulge(*changes)))
    arrays = compare_with_restart(model, 10, threads=2)
    assert any("pressure" in name for name in arrays)


@pytest.mark.parametrize("change", [("blank.cells", "triangles"), ("blank.refine", {"levels": 1, "angle": 5})])
def test_triangles_and_split_shells_are_pressed_like_others(tmp_path: Path, change: tuple[str, object]) -> None:
    """Height and volume within 3 % of coarse quadrilaterals; the energies close within 0.2 %."""
    plain = run_stamping(vary_bulge(*EXPLICIT), tmp_path / "plain").history
    other = run_stamping(vary_bulge(*EXPLICIT, change), tmp_path / "other").history
    for quantity in ("height", "volume", "p"):
        name = f"pressure.oil.{quantity}"
        assert other[name][-1] == pytest.approx(plain[name][-1], rel=0.03), name
    assert np.abs(other["energy_error_percent"]).max() < 0.2
    if change[0] == "blank.refine":
        assert other["shells"][-1] > other["shells"][0]


def test_a_pressure_follows_its_table_and_stays_where_a_stage_does_not_name_it(tmp_path: Path) -> None:
    """Over time in both procedures alike; the sheet springs back where it falls."""
    stages = [
        {"name": "up", "duration": 0.004, "pressure": {"oil": {"p_over_time": [[0.001, 0.0], [0.004, 0.6]]}}},
        {"name": "hold", "duration": 0.001},
        {"name": "down", "duration": 0.003, "pressure": {"oil": {"p": 0.0}}},
    ]
    for changes in (SMALL, EXPLICIT):
        own = [change for change in changes if not change[0].startswith("stages")]
        history = run_stamping(vary_bulge(*own, ("stages", stages)), tmp_path / own[-1][0]).history
        p, height, time, stage = (history[name] for name in ("pressure.oil.p", "pressure.oil.height", "time", "stage"))
        table = np.interp(time[stage == "up"], [0.001, 0.004], [0.0, 0.6])
        np.testing.assert_allclose(p[stage == "up"], table, atol=2e-3)
        np.testing.assert_allclose(p[stage == "hold"], 0.6, atol=1e-12)
        assert p[-1] == pytest.approx(0.0, abs=1e-12)
        assert 0.9 * height.max() < height[-1] < height.max()


@pytest.mark.parametrize("changes", [SMALL, EXPLICIT], ids=["implicit", "explicit"])
def test_what_flows_in_may_flow_out_by_a_table(tmp_path: Path, changes: tuple[tuple[str, object], ...]) -> None:
    """The sheet takes the volume that has flowed in, less what the fluid is compressed; no pressure is left at last."""
    times = [[0.0, 0.0], [0.004, 60e3], [0.005, 60e3]]
    stages = [
        {"name": "in", "duration": 0.005, "pressure": {"oil": {"inflow_over_time": times}}},
        {"name": "out", "duration": 0.003, "pressure": {"oil": {"inflow": -5e3}}},
    ]
    own = [change for change in changes if not change[0].startswith("stages")]
    history = run_stamping(vary_bulge(*own, ("pressure.oil", OIL), ("stages", stages)), tmp_path / "out").history
    p, volume, stage = history["pressure.oil.p"], history["pressure.oil.volume"], history["stage"]
    filled = int(np.flatnonzero(stage == "in")[-1])
    assert 0.2 < p[filled] < 1.5
    assert volume[filled] == pytest.approx(260e3 * np.exp(-p[filled] / 2000.0) - 200e3, rel=1e-4)
    assert p[-1] == 0.0
    assert 55e3 < volume[-1] < volume[filled]


@pytest.mark.parametrize("changes", [SMALL, EXPLICIT], ids=["implicit", "explicit"])
def test_a_line_bounds_a_pressure_and_its_face_says_where_it_pushes(
    tmp_path: Path, changes: tuple[tuple[str, object], ...]
) -> None:
    line = {"shape": "circle", "diameter": 50}
    tables = {"inside": {"oil": {"face": "top", "inside": line}}, "outside": {"oil": {"face": "top", "outside": line}}}
    middle, heights = [], []
    for name, pressure in tables.items():
        run = run_stamping(vary_bulge(*changes, ("pressure", pressure)), tmp_path / name)
        moved, points = run.field("displacement")[:, 2], run.mesh.points
        assert moved.min() < -1.0
        assert moved.max() < 0.1
        middle.append(moved[np.argmin(np.hypot(*points[:, :2].T))])
        heights.append(run.history["pressure.oil.height"][-1])
        assert heights[-1] == pytest.approx(-moved.min(), rel=1e-6)
    assert middle[0] == pytest.approx(-heights[0], rel=1e-6)
    assert RADIUS > heights[0] > 0.0


def test_a_bulge_springs_back_once_the_pressure_is_gone(tmp_path: Path) -> None:
    """Released parts have no pressure: the last rows say 0, and the part keeps its shape but for springback."""
    case = vary_bulge(*SMALL, ("springback", {}))
    run = run_stamping(case, tmp_path / "out")
    assert run.history["pressure.oil.p"][-1] == 0.0
    assert run.history["pressure.oil.p"].max() == pytest.approx(0.6)
    assert 0.0 < run.summary["springback"]["largest_mm"] < 3.0


def test_the_example_of_a_bulge_test_passes_the_maximum_of_its_pressure(tmp_path: Path) -> None:
    """On coarse shells; the sheet lies on the die's radius alone, and the energies close within 0.5 %."""
    case = StampingCase.from_toml(copy_example("bulge_test", tmp_path), overrides=["blank.element_size=8"])
    history = run_to_end(build_model(case), tmp_path / "out").history
    p, height = history["pressure.oil.p"], history["pressure.oil.height"]
    assert 9.0 < p.max() < 10.5
    assert 30.0 < height[np.argmax(p)] < height[-1] < 45.0
    assert p[-1] < 0.995 * p.max()
    assert 0.4 < history["pressure.oil.thickness"][-1] < 0.5
    assert abs(history["energy_error_percent"][-1]) < 0.5


def test_a_tool_that_comes_where_a_fluid_acts_is_warned_of(tmp_path: Path) -> None:
    """A punch that starts above the sheet goes on into the face that is pressed."""
    punch = {"kind": "punch", "shape": "hemispherical", "diameter": 40, "position": [0, 0, 4]}
    stage = {"name": "push", "tools": {"punch": {"stroke": 10}}, "pressure": {"oil": {"p": 0.05}}}
    case = vary_bulge(
        *EXPLICIT, ("pressure", {"oil": {"face": "top"}}), ("tools", {"punch": punch}), ("stages", [stage])
    )
    warnings = run_stamping(case, tmp_path / "out").summary["warnings"]
    assert any("tools push the top face" in text and "pressure.oil.inside" in text for text in warnings), warnings


def test_a_given_pressure_beyond_its_maximum_ends_with_the_remedy(tmp_path: Path) -> None:
    case = StampingCase.model_validate(
        vary_bulge(*SMALL, ("stages.0.pressure.oil.p", 6.0), ("limits", {"stop": False}))
    )
    outcome = run_model(build_model(StampingCase.model_validate(case)), tmp_path / "out", threads=1)
    assert outcome.status != "completed"
    assert "A given pressure does not pass its maximum: give pressure.NAME.fluid" in outcome.reason
