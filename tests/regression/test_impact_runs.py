# SPDX-License-Identifier: Apache-2.0
"""Impacts from case files: the Taylor bar of Pantale, momentum, moving tools, resume to the same bits, pictures."""

from __future__ import annotations

import copy
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import Case, CaseError, build_model
from presswork.examples import copy_example
from presswork.explicit.solids import ExplicitSolids
from presswork.model import Model
from presswork.process.begin import check_start
from presswork.process.explicit.begin_forming import begin_explicit_forming
from presswork.recorder import StartError, run_model
from presswork.results import OutputError, Result
from presswork.view import plot_all
from presswork.view.all_plots import default_fields
from tests.regression.whole_runs import assert_same_bits, run_to_end, stop_after, stop_within_a_row

DENSITY = 7.83e-9


@pytest.fixture(scope="module")
def taylor_bar(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The packaged example on 5 x 50 cells, with less output."""
    path = copy_example("taylor_bar", tmp_path_factory.mktemp("case"))
    case = tomllib.loads(path.read_text())
    case["workpiece"]["mesh"]["cells"] = [5, 50]
    case["output"] = {"steps": 4, "rows": 40}
    return case


def build(case: dict[str, Any], **changes: Any) -> Model:
    model = build_model(Case.model_validate({**copy.deepcopy(case), **changes}))
    assert isinstance(model, Model)
    return model


@pytest.fixture(scope="module")
def bounced(taylor_bar: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Result:
    return run_to_end(build(taylor_bar), tmp_path_factory.mktemp("run") / "out")


def test_taylor_bar_with_a_held_foot_from_a_case(taylor_bar: dict[str, Any], tmp_path: Path) -> None:
    """As in Pantale (2020), by DynELA and Abaqus there: length 26.52, 26.56; diameter 11.15, 11.16."""
    held = {**taylor_bar["boundary"], "foot": {"set": "bottom", "fix": ["y"]}}
    result = run_model(build(taylor_bar, boundary=held, tools={}), tmp_path / "out", threads=1).result
    end = {name: float(column[-1]) for name, column in result.history.items() if name != "stage"}
    assert end["y_max"] - end["y_min"] == pytest.approx(26.54, abs=0.03)
    assert 2 * end["x_max"] == pytest.approx(11.155, rel=0.006)
    assert result.field("temperature").max() == pytest.approx(586.6, rel=0.02)
    assert result.field("eqps").max() == pytest.approx(1.795, rel=0.02)
    assert abs(end["energy_error_percent"]) < 0.02


def test_impulse_of_the_anvil_is_the_change_of_momentum(bounced: Result) -> None:
    """The mean forces of the rows add up to m (v_end - v_0); afterwards the bar flies."""
    history = bounced.history
    mass = DENSITY * np.pi * 3.2**2 * 32.4
    speed = bounced.summary["centre_velocity_mm_s"]
    impulse = -(history["anvil.force_y"] * np.diff(history["time"], prepend=0.0)).sum()
    assert impulse == pytest.approx(mass * (speed[1] + 287e3), rel=1e-9)
    assert bounced.summary["mass"]["workpiece_t"] == pytest.approx(mass, rel=1e-9)
    assert speed[0] == 0.0
    assert speed[1] > 1e4
    assert (history["anvil.force"][-10:] == 0.0).all()
    assert history["y_min"][-1] > 0.5
    assert (np.diff(history["cycles"]) > 0).all()
    assert bounced.summary["warnings"] == []


def test_the_case_gives_the_bits_of_the_arrays(taylor_bar: dict[str, Any], bounced: Result) -> None:
    """A run from Python to the same times ends with the same positions."""

    model = build(taylor_bar)
    start = begin_explicit_forming(model, threads=1).solids
    for row in range(40):
        start.run_to(model.stages[0].duration * (row + 1) / 40)
    np.testing.assert_array_equal(bounced.points(-1)[:, :2], model.mesh.points + (start.position - model.mesh.points))


def test_a_resumed_run_and_one_with_two_threads_give_the_same_bits(
    taylor_bar: dict[str, Any], bounced: Result, tmp_path: Path
) -> None:
    """Stopped between rows, and within one."""
    model = build(taylor_bar)
    run_model(model, tmp_path / "two", threads=2)
    assert run_model(model, tmp_path / "part", threads=1, on_increment=stop_after(18)).status == "interrupted"
    with pytest.raises(OutputError, match=r"a run with output.rows = 40, on which its steps depend; use --overwrite"):
        run_model(build(taylor_bar, output={"steps": 4, "rows": 80}), tmp_path / "part", resume=True)
    assert run_model(model, tmp_path / "part", threads=1, resume=True).status == "completed"
    for other in ("two", "part"):
        assert_same_bits(tmp_path / other, bounced.folder)


def test_ctrl_c_within_a_row_goes_back_to_its_beginning(
    taylor_bar: dict[str, Any], bounced: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = build(taylor_bar)
    outcome = stop_within_a_row(model, tmp_path / "out", monkeypatch, ExplicitSolids, 158)
    assert outcome.status == "interrupted"
    assert 0 < len(outcome.result.history["time"]) < 40
    assert run_model(model, tmp_path / "out", threads=1, resume=True).status == "completed"
    assert (tmp_path / "out" / "history.csv").read_bytes() == (bounced.folder / "history.csv").read_bytes()


BLOCK: dict[str, Any] = {
    "title": "a hammer on a block", "analysis": "plane_strain", "procedure": "explicit", "depth": 10,
    "workpiece": {"material": "steel", "element": "tri3", "mesh": {"size": [5, 5], "cells": [4, 4]}},
    "materials": {"steel": {"young": 210e3, "poisson": 0.3, "density": 7.85e-9,
                            "hardening": {"law": "linear", "yield_stress": 500, "modulus": 100}}},
    "tools": {"hammer": {"profile": [[0, 5], [20, 5]], "contact": "frictionless"},
              "anvil": {"profile": [[0, 0], [20, 0]], "contact": "frictionless"}},
    "boundary": {"middle": {"set": "left", "fix": ["x"]}},
    "stages": [{"name": "blow", "duration": 5e-5, "ramp": 0,
                "tools": {"hammer": {"stroke": 0.5, "direction": [0, -1]}}},
               {"name": "back", "duration": 1e-5, "tools": {"hammer": {"stroke": 1, "direction": [0, 1]}}}],
    "output": {"rows": 20, "steps": 2},
}  # fmt: skip


def test_a_hammer_upsets_a_block_between_tools(tmp_path: Path) -> None:
    """Plane strain, half of a block: 2/sqrt(3) of the flow stress over the whole of it, anvil and hammer alike."""
    result = run_model(build(BLOCK), tmp_path / "out", threads=1).result
    history = result.history
    blow = np.flatnonzero(history["stage"] == "blow")
    assert history["hammer.stroke"][blow[-1]] == pytest.approx(0.5, rel=1e-9)
    assert history["hammer.stroke"][-1] == pytest.approx(-0.5, rel=1e-9)
    late = blow[-8:]
    height = 5 - (history["hammer.stroke"][late] - 0.0125)  # in the middle of the row
    flow = 500 + 100 * 2 / np.sqrt(3) * np.log(5 / height)
    expected = 2 / np.sqrt(3) * flow * 2 * 5.0 * 5.0 / height * 10
    force = history["hammer.force"][late].mean()
    assert force == pytest.approx(expected.mean(), rel=0.005)
    assert history["anvil.force"][late].mean() == pytest.approx(force, rel=0.005)
    assert history["y_max"][blow[-1]] == pytest.approx(4.5, abs=1e-6)
    assert history["hammer.force"][-1] == 0.0
    work = history["external_energy"][blow[-1]]
    assert work == pytest.approx(0.5 * (history["hammer.force"][blow] * 0.5 / 20).sum(), rel=0.005)  # of the half
    assert abs(history["energy_error_percent"]).max() < 0.5


def test_tools_start_and_stop_smoothly(tmp_path: Path) -> None:
    """The stroke is that of half a cosine, straight, half a cosine; no shock at the start; the balance holds."""
    duration, ramp, way = 5e-5, 1e-5, 0.5
    press = {"name": "press", "duration": duration, "ramp": ramp, "tools": BLOCK["stages"][0]["tools"]}
    smooth = run_model(build(BLOCK, stages=[press]), tmp_path / "smooth", threads=1).result.history
    even = run_model(build(BLOCK, stages=[{**press, "ramp": 0}]), tmp_path / "even", threads=1).result.history
    t = smooth["time"]
    speed = way / (duration - ramp)
    rising = 0.5 * speed * (t - ramp / np.pi * np.sin(np.pi * t / ramp))
    falling = way - 0.5 * speed * (duration - t - ramp / np.pi * np.sin(np.pi * (duration - t) / ramp))
    straight = 0.5 * speed * ramp + speed * (t - ramp)
    expected = np.where(t < ramp, rising, np.where(t > duration - ramp, falling, straight))
    np.testing.assert_allclose(smooth["hammer.stroke"], expected, atol=1e-9)
    np.testing.assert_allclose(even["hammer.stroke"], way * even["time"] / duration, atol=1e-9)
    # a blow strikes the top row of nodes at once
    assert smooth["contact_energy"][-1] < 0.05 * even["contact_energy"][-1]
    # in the first row the force goes with the velocity, which is then 1/16 of the even one
    assert smooth["hammer.force"][0] < 0.07 * even["hammer.force"][0]
    for history in (smooth, even):
        assert history["hammer.stroke"][-1] == pytest.approx(way, rel=1e-9)
        assert abs(history["energy_error_percent"]).max() < 0.2
    work = 0.5 * (smooth["hammer.force"] * np.diff(smooth["hammer.stroke"], prepend=0.0)).sum()  # of the half
    assert smooth["external_energy"][-1] == pytest.approx(work, rel=0.005)


def test_prescribed_displacements_start_smoothly_too(tmp_path: Path) -> None:
    """Half of the way at half of the time, 1/20 of the stage's ramp gone at a tenth; resumed to the same bits."""
    pull = {"name": "pull", "duration": 5e-5, "displacement": [{"set": "top", "component": "y", "value": 0.2}]}
    model = build(BLOCK, stages=[pull], tools={}, boundary={"foot": {"set": "bottom", "fix": ["x", "y"]}})
    assert model.stages[0].ramp == pytest.approx(5e-6)
    whole = run_model(model, tmp_path / "whole", threads=1).result
    height = whole.history["y_max"] - 5.0
    assert height[9] == pytest.approx(0.1, rel=1e-9)
    assert height[1] == pytest.approx(0.5 * 0.2 / 0.9 * 0.1, rel=1e-9)  # the end of the ramp: half of its time at speed
    assert height[-1] == pytest.approx(0.2, rel=1e-9)
    rows = iter(range(100))

    def stop(_: object) -> None:
        if next(rows) == 2:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "part", threads=1, on_increment=stop).status == "interrupted"
    assert run_model(model, tmp_path / "part", threads=1, resume=True).status == "completed"
    assert (tmp_path / "part" / "history.csv").read_bytes() == (tmp_path / "whole" / "history.csv").read_bytes()


def test_mass_scaling_from_a_case_is_reported(tmp_path: Path) -> None:
    plain = run_model(build(BLOCK), tmp_path / "plain", threads=1).result
    scaled = run_model(build(BLOCK, explicit={"target_step": 2e-7}), tmp_path / "scaled", threads=1).result
    assert scaled.history["cycles"][-1] < 0.7 * plain.history["cycles"][-1]
    added = scaled.summary["mass"]["added_percent"]
    assert added > 10
    assert scaled.history["added_mass_percent"][-1] == pytest.approx(added, rel=1e-12)
    assert plain.summary["mass"]["added_percent"] == 0.0


def test_a_run_that_breaks_down_keeps_its_last_row(tmp_path: Path) -> None:
    """The top driven through the bottom: a limit stops it; without limits cells are crushed. Both keep the last row."""
    crush = {"name": "crush", "duration": 2e-5, "displacement": [{"set": "top", "component": "y", "value": -7.0}]}
    foot = {"foot": {"set": "bottom", "fix": ["x", "y"]}}
    for stop, reason in ((True, "times the flow stress"), (False, "is crushed at")):
        model = build(BLOCK, stages=[crush], tools={}, boundary=foot, limits={"stop": stop})
        outcome = run_model(model, tmp_path / str(stop), threads=1)
        assert outcome.status == "gave_up"
        assert reason in outcome.reason
        assert len(outcome.result.history["time"]) > 3


def test_a_velocity_in_a_wrong_unit_is_refused_before_anything_is_written(taylor_bar: dict[str, Any]) -> None:
    """In the case, and in a Model that comes from elsewhere."""
    body = {**taylor_bar["workpiece"], "velocity": [0, "-287 km/s"]}
    with pytest.raises(CaseError, match=r"workpiece\.velocity.*faster than sound"):
        build(taylor_bar, workpiece=body)
    model = build(taylor_bar)
    assert model.explicit is not None
    with pytest.raises(StartError, match="beyond the material's sound"):
        check_start(replace(model, explicit=replace(model.explicit, velocity=(0.0, -287e6))))


def test_pictures_of_an_impact(bounced: Result, tmp_path: Path) -> None:
    assert default_fields(bounced) == ("effective_stress", "equivalent_plastic_strain", "temperature")
    names = {path.name for path in plot_all(bounced, tmp_path, ["temperature"])}
    assert names == {"energies.png", "contours_temperature_004.png", "mesh_temperature_004.png"}


def test_damping_that_holds_the_part_as_in_tar_is_refused(taylor_bar: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(StartError, match=r"explicit\.damping = 1e\+12 1/s: it would stop the part within 1e-12 s"):
        run_model(build(taylor_bar, explicit={"damping": 1e12}), tmp_path / "out")
