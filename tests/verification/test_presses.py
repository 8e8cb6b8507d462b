# SPDX-License-Identifier: Apache-2.0
"""Presses against closed forms: blows on a rigid, perfectly plastic cylinder; times of cranks; limits of force."""

import math
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.case.stamping.schema import StampingCase
from presswork.post.verdict import judge_result
from presswork.recorder import Outcome, run_model
from tests.regression.whole_runs import assert_same_bits, stop_after

RADIUS, HEIGHT, YIELD = 20.0, 60.0, 100.0
VOLUME = math.pi * RADIUS**2 * HEIGHT
CASE: dict[str, Any] = {
    "title": "blows",
    "analysis": "axisymmetric",
    "workpiece": {"material": "metal", "mesh": {"size": [RADIUS, HEIGHT / 2], "cells": [3, 4]}},
    "materials": {
        "metal": {
            "magnitudes": "any",
            "young": "2000 GPa",
            "poisson": 0.3,
            "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": 0},
        }
    },
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "tools": {"die": {"profile": [[0, HEIGHT / 2], [60, HEIGHT / 2]], "contact": "frictionless"}},
    "presses": {
        "hammer": {"kind": "hammer", "energy": 2.0, "velocity": "5 m/s", "efficiency": 0.8},
        "maxi": {"kind": "crank", "stroke": 200, "rpm": 60, "rod_ratio": 0.2},
    },
    "stages": [{"name": "forge", "press": "hammer", "tools": {"die": {"stroke": 12, "direction": [0, -1]}}}],
    "output": {"steps": 2},
}
TAKEN = 0.8 * 2.0e6
"""By the workpiece in a blow [N mm]."""
STRAIN = TAKEN / (YIELD * VOLUME)
"""Of a blow: sigma V ln(h0/h) = eta E."""


def run(folder: Path, case: dict[str, Any] | None = None, **stage: Any) -> Outcome:
    """Compute the case with changes of its stage."""
    data = deepcopy(CASE if case is None else case)
    data["stages"][0] |= stage
    return run_model(build_model(Case.model_validate(data)), folder / "out", threads=1)


def heights(history: dict[str, Any]) -> list[float]:
    """Return the height of the billet after each blow [mm]: the die moves by half of what is lost."""
    blows = range(1, int(history["blow"].max()) + 1)
    return [HEIGHT - 2.0 * float(history["die.stroke"][history["blow"] == n][-1]) for n in blows]


def test_blows_leave_the_height_that_their_energy_gives(tmp_path: Path) -> None:
    done = run(tmp_path, press={"name": "hammer", "blows": 3})
    assert done.status == "completed"
    history = done.result.history
    expected = [HEIGHT * math.exp(-n * STRAIN) for n in (1, 2, 3)]
    assert heights(history) == pytest.approx(expected, rel=4e-4)
    for number, blow in enumerate(done.result.summary["press"], start=1):
        assert blow["blow"] == number
        assert blow["energy_spent_kJ"] == pytest.approx(1e-6 * TAKEN, rel=2e-5)
        assert blow["final_speed_mm_s"] == 0.0
    energy = done.result.summary["energy"]
    # half of the billet is modelled; between the blows the die takes the elastic energy back
    spent = history["energy_spent"][-1]
    assert 2.0 * energy["external_work"] == pytest.approx(spent, rel=1e-3)
    assert 2.0 * energy["plastic_work"] == pytest.approx(3.0 * TAKEN, rel=1e-3)


def test_a_blow_in_plane_strain_is_shared_by_four_quarters(tmp_path: Path) -> None:
    data = deepcopy(CASE) | {"analysis": "plane_strain", "depth": 50}
    data["presses"]["hammer"]["energy"] = 3.0
    history = run(tmp_path, data).result.history
    volume = 2 * RADIUS * HEIGHT * 50.0
    height = HEIGHT * math.exp(-0.8 * 3.0e6 / (2.0 / math.sqrt(3.0) * YIELD * volume))
    assert HEIGHT - 2.0 * history["die.stroke"][-1] == pytest.approx(height, rel=4e-4)
    # force on both halves of the die; the elastic work at the end is small
    width = 2 * RADIUS * HEIGHT / height
    assert history["ram_force"][-1] == pytest.approx(2.0 / math.sqrt(3.0) * YIELD * width * 50.0, rel=1e-3)


def test_a_blow_takes_the_time_of_the_ram_s_deceleration(tmp_path: Path) -> None:
    def per_speed(u: float) -> float:  # v = v0 u, strain e = e_end (1 - u^2), ds = h0 exp(-e) de
        return HEIGHT * math.exp(-STRAIN * (1.0 - u * u)) * 2.0 * STRAIN / 5000.0

    expected, _ = quad(per_speed, 0.0, 1.0)
    data = deepcopy(CASE)
    for number, largest in enumerate((0.04, 0.02, 0.005)):
        data["solver"] = {"max_increment": largest}
        (tmp_path / str(number)).mkdir()
        done = run(tmp_path / str(number), data)
        assert done.result.summary["press"][0]["time_s"] == pytest.approx(expected, rel=6e-4)


def test_a_hammer_by_mass_and_fall_strikes_as_one_by_energy_and_velocity() -> None:
    data = deepcopy(CASE)
    fall, mass = 1000.0, 2e6 / (9806.65 * 1000.0) * 1e3  # E = m g h; t to kg
    data["presses"]["hammer"] = {"kind": "hammer", "mass": mass, "height": fall, "efficiency": 0.8}
    (stage,) = build_model(Case.model_validate(data)).stages
    assert stage.drive is not None
    motion = stage.drive.motion
    assert motion.energy == pytest.approx(TAKEN, rel=1e-12)  # type: ignore[union-attr]
    assert motion.velocity == pytest.approx(math.sqrt(2.0 * 9806.65 * fall), rel=1e-12)  # type: ignore[union-attr]


def test_a_crank_stage_takes_the_time_of_the_slider_crank(tmp_path: Path) -> None:
    history = run(tmp_path, press={"name": "maxi"}).result.history
    # the billet is cut in half: the ram goes 24 mm, to bottom dead centre
    radius, rod = 100.0, 500.0
    turned = [math.radians(a) for a in np.linspace(0.0, 90.0, 900001)]
    ways = radius + rod - radius * np.cos(turned) - np.sqrt(rod**2 - (radius * np.sin(turned)) ** 2)
    left = 24.0 - 2.0 * history["die.stroke"]
    angles = np.interp(left, ways, turned)
    start = float(np.interp(24.0, ways, turned))
    assert history["time"] == pytest.approx((start - angles) / (2.0 * math.pi), abs=2e-5)
    assert history["ram_speed"][-1] == pytest.approx(0.0, abs=1e-3)


def crank_time(way: float, travel: float, stroke: float, ratio: float, rpm: float) -> float:
    """Return the time of a ram that goes `travel` to bottom dead centre until it has gone `way` [s]."""
    radius, rod = 0.5 * stroke, 0.5 * stroke / ratio

    def angle(height: float) -> float:
        h = radius + rod - height
        return math.acos(min((radius**2 + h**2 - rod**2) / (2.0 * radius * h), 1.0))

    return (angle(travel) - angle(travel - way)) / (2.0 * math.pi * rpm / 60.0)


def test_explicit_solids_follow_the_crank(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["procedure"] = "explicit"
    data["materials"]["metal"] |= {"young": "200 GPa", "density": "7850 kg/m^3"}
    data["workpiece"]["element"] = "quad4_1pt"
    data["presses"]["maxi"]["rpm"] = 6000
    data["output"] = {"rows": 20, "steps": 2}
    done = run(tmp_path, data, press="maxi")
    history = done.result.history
    for row in (4, 11, 17):
        way = 2.0 * float(history["die.stroke"][row])
        assert history["time"][row] == pytest.approx(crank_time(way, 24.0, 200.0, 0.2, 6000.0), rel=1e-6)
    ways = np.diff(np.append(0.0, 2.0 * history["die.stroke"]))  # forces are means over the rows
    assert history["energy_spent"][-1] == pytest.approx(float(history["ram_force"] @ ways), rel=1e-9)
    # sigma V ln(h0/h), and what the ram's speed of up to 30 m/s adds to it
    assert YIELD * VOLUME * math.log(60 / 36) < history["energy_spent"][-1] < 1.2 * YIELD * VOLUME * math.log(60 / 36)
    assert 1e-6 * history["energy_spent"][-1] == pytest.approx(done.result.summary["press"][0]["energy_spent_kJ"])


def test_explicit_solids_take_the_energy_of_a_blow(tmp_path: Path) -> None:
    data = deepcopy(CASE) | {"procedure": "explicit", "output": {"rows": 100, "steps": 2}}
    data["materials"]["metal"] |= {"young": "200 GPa", "density": "7850 kg/m^3"}
    data["workpiece"]["element"] = "quad4_1pt"
    model = build_model(Case.model_validate(data))
    outcome = run_model(model, tmp_path / "whole", threads=1)
    history, summary = outcome.result.history, outcome.result.summary
    assert history["energy_spent"][-1] == pytest.approx(TAKEN, rel=2e-3)
    assert HEIGHT - 2.0 * history["die.stroke"][-1] == pytest.approx(HEIGHT * math.exp(-STRAIN), rel=5e-3)
    assert history["ram_speed"][0] < 5000.0
    assert history["ram_speed"][-1] == 0.0
    assert (np.diff(history["ram_speed"]) <= 0.0).all()
    assert summary["press"][0]["blow"] == 1
    assert not any("kJ are left" in warning for warning in summary["warnings"])
    assert run_model(model, tmp_path / "part", on_increment=stop_after(23), threads=1).status == "interrupted"
    assert run_model(model, tmp_path / "part", resume=True, threads=1).status == "completed"
    assert_same_bits(tmp_path / "part", tmp_path / "whole")


CUP: dict[str, Any] = {
    "title": "a cup under a crank press",
    "analysis": "stamping",
    "blank": {
        "shape": "circle",
        "diameter": 60,
        "thickness": 1,
        "element_size": 5,
        "material": "steel",
        "symmetry": ["x", "y"],
    },
    "materials": {
        "steel": {"young": "210 GPa", "poisson": 0.3, "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}
    },
    "tools": {
        "punch": {"kind": "punch", "shape": "round", "diameter": 30, "edge_radius": 5, "mu": 0.1},
        "die": {"kind": "die", "shape": "round", "diameter": 34, "edge_radius": 5, "mu": 0.1},
        "holder": {"kind": "holder", "shape": "round", "diameter": 34, "edge_radius": 1, "mu": 0.1},
    },
    "presses": {
        "maxi": {"kind": "crank", "stroke": 100, "rpm": 900, "rod_ratio": 0.2},
        "hammer": {"kind": "hammer", "energy": 0.02, "velocity": "5 m/s", "efficiency": 1},
        "weak": {"kind": "hydraulic", "velocity": 100, "force": "9 kN"},
    },
    "stages": [{"name": "draw", "press": "maxi", "tools": {"punch": {"stroke": 8}, "holder": {"force": "10 kN"}}}],
    "output": {"steps": 2, "rows": 40},
}


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_stampings_follow_the_crank(procedure: str, tmp_path: Path) -> None:
    data = CUP | {"procedure": procedure}
    done = run_model(build_model(StampingCase.model_validate(data)), tmp_path / "out", threads=1)
    assert done.status == "completed"
    history = done.result.history
    for row in (5, len(history["time"]) // 2, -3):
        way = float(history["punch.stroke"][row])
        assert history["time"][row] == pytest.approx(crank_time(way, 8.0, 100.0, 0.2, 900.0), rel=1e-6)
    assert history["ram_force"][-1] == pytest.approx(float(history["punch.force"][-1]), rel=1e-12)
    assert history["ram_speed"][-1] == pytest.approx(0.0, abs=1e-3)


def test_a_blow_draws_a_cup_as_deep_as_its_energy_goes(tmp_path: Path) -> None:
    data = deepcopy(CUP) | {"procedure": "implicit"}
    data["stages"][0]["press"] = "hammer"
    done = run_model(build_model(StampingCase.model_validate(data)), tmp_path / "out", threads=1)
    history = done.result.history
    stroke, force = (np.append(0.0, history[f"punch.{name}"]) for name in ("stroke", "force"))
    assert 1.0 < stroke[-1] < 8.0
    assert float(np.trapezoid(force, stroke)) == pytest.approx(0.02e6, rel=1e-4)
    assert history["energy_spent"][-1] == pytest.approx(0.02e6, rel=2e-5)
    assert done.result.summary["warnings"] == []


def test_a_stamping_stops_at_the_force_of_its_press(tmp_path: Path) -> None:
    data = deepcopy(CUP) | {"procedure": "implicit"}
    data["stages"][0]["press"] = "weak"
    history = run_model(build_model(StampingCase.model_validate(data)), tmp_path / "out", threads=1).result.history
    assert history["punch.force"][-1] == pytest.approx(9e3, rel=1e-4)
    assert history["time"][-1] == pytest.approx(history["punch.stroke"][-1] / 100.0, rel=1e-9)


def test_a_hydraulic_press_stops_at_its_limit_of_force(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["presses"] = {"slow": {"kind": "hydraulic", "velocity": 20, "force": "150 kN"}}
    history = run(tmp_path, data, press="slow").result.history
    # F = sigma V / h
    assert history["ram_force"][-1] == pytest.approx(150e3, rel=1e-4)
    assert HEIGHT - 2.0 * history["die.stroke"][-1] == pytest.approx(YIELD * VOLUME / 150e3, rel=1e-3)
    assert history["time"][-1] == pytest.approx(2.0 * history["die.stroke"][-1] / 20.0, rel=1e-9)


def test_a_hydraulic_press_slows_down_at_its_limit_of_power(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["presses"] = {"weak": {"kind": "hydraulic", "velocity": 20, "power": "2.8 kW"}}
    history = run(tmp_path, data, press="weak").result.history
    force, speed = history["ram_force"], history["ram_speed"]
    assert speed == pytest.approx(np.minimum(20.0, 2.8e6 / force), rel=1e-12)
    assert speed[-1] < 14.0
    # P dt = F ds wherever the limit holds: the time is the work over the power
    slowed = np.flatnonzero(force > 2.8e6 / 20.0)
    work = history["energy_spent"][slowed[-1]] - history["energy_spent"][slowed[0]]
    time = history["time"][slowed[-1]] - history["time"][slowed[0]]
    assert time == pytest.approx(work / 2.8e6, rel=1e-2)


@pytest.mark.validation
def test_a_blow_that_moves_no_metal_is_a_warning(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["presses"]["hammer"]["energy"] = 1e-7
    done = run(tmp_path, data)
    assert done.status == "completed"
    assert "ends within the elastic range, and moves no metal" in "".join(done.result.summary["warnings"])


def test_energy_left_at_the_end_of_the_way_is_a_warning(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["presses"]["hammer"]["energy"] = 20.0
    done = run(tmp_path, data)
    (warning,) = done.result.summary["warnings"]
    assert "kJ are left when the travel of the ram, 24 mm, is complete" in warning
    assert done.result.summary["press"][0]["final_speed_mm_s"] > 0.0


@pytest.mark.validation
def test_an_interrupted_forging_resumes_to_the_same_bits(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["stages"][0]["press"] = {"name": "hammer", "blows": 2}
    model = build_model(Case.model_validate(data))
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"
    part = run_model(model, tmp_path / "part", on_increment=stop_after(37), threads=1)
    assert part.status == "interrupted"
    assert run_model(model, tmp_path / "part", resume=True, threads=1).status == "completed"
    assert_same_bits(tmp_path / "part", tmp_path / "whole")


def crank_arm(angle: float) -> float:
    """Return dh/da of a crank of 200 mm, radius over rod 0.2, at an angle before bottom dead centre [mm/rad]."""
    return 100.0 * math.sin(angle) * (1.0 + 0.2 * math.cos(angle) / math.sqrt(1.0 - (0.2 * math.sin(angle)) ** 2))


def crank_height(angle: float) -> float:
    """Return its height above bottom dead centre [mm]."""
    return 100.0 * (1.0 - math.cos(angle)) + 500.0 - math.sqrt(500.0**2 - (100.0 * math.sin(angle)) ** 2)


@pytest.mark.parametrize("rated", [240.0, 180.0])
def test_a_crank_press_bears_the_force_that_its_torque_allows(tmp_path: Path, rated: float) -> None:
    """Force sigma V/h; torque F_rated dh/da at 20 degrees before bottom dead centre, the rated force from there on."""
    data = deepcopy(CASE)
    data["presses"]["maxi"] |= {"force": f"{rated} kN", "rated_angle": 20, "energy": 2.0}
    done = run(tmp_path, data, press="maxi")
    entry = done.result.summary["press"][0]
    near = entry["nearest_to_rating"]

    def ratio(angle: float) -> float:
        force = 1e-3 * YIELD * VOLUME / (HEIGHT - (24.0 - crank_height(angle)))
        return force / (rated * min(crank_arm(math.radians(20.0)) / crank_arm(angle), 1.0))

    angles = np.linspace(math.radians(0.1), math.radians(37.0), 2000)
    angles = angles[[crank_height(angle) <= 24.0 for angle in angles]]
    worst = angles[int(np.argmax([ratio(angle) for angle in angles]))]
    assert near["force_kN"] / near["rated_there_kN"] == pytest.approx(ratio(worst), rel=0.02)
    assert near["above_bottom_mm"] == pytest.approx(crank_height(worst), abs=1.0)
    texts = [text for text in done.result.summary["warnings"] if "the press maxi bears" in text]
    assert len(texts) == (rated < 200.0)
    lines = {line.name: line.state for line in judge_result(done.result).lines}
    assert lines["force of press maxi"] == ("fail" if texts else "ok")
    # sigma V ln(h0/h) is 3.85 kJ: more than the flywheel gives
    assert entry["energy_spent_kJ"] == pytest.approx(1e-6 * YIELD * VOLUME * math.log(60 / 36), rel=0.01)
    assert any("gives 2 kJ in one stroke, and forming takes 3.8" in text for text in done.result.summary["warnings"])
    assert lines["energy of press maxi"] == "fail"


def test_the_force_that_a_press_bears_is_a_column_of_explicit_runs_too(tmp_path: Path) -> None:
    data = deepcopy(CASE) | {"procedure": "explicit", "output": {"rows": 20, "steps": 2}}
    data["materials"]["metal"] |= {"young": "200 GPa", "density": "7850 kg/m^3"}
    data["workpiece"]["element"] = "quad4_1pt"
    data["presses"]["maxi"] |= {"rpm": 6000, "force": "150 kN", "rated_height": 6}
    history = run(tmp_path, data, press="maxi").result.history
    angles = np.linspace(1e-4, 0.7, 20001)
    heights = [crank_height(angle) for angle in angles]
    rated = crank_arm(float(np.interp(6.0, heights, angles)))
    for way, borne in zip(2.0 * history["die.stroke"], history["ram_force_borne"], strict=True):
        arm = crank_arm(float(np.interp(24.0 - way, heights, angles)))
        assert borne == pytest.approx(150e3 * min(rated / arm, 1.0), rel=1e-4)


def test_a_screw_press_whose_frame_bears_less_than_the_blow_warns(tmp_path: Path) -> None:
    data = deepcopy(CASE)
    data["presses"]["screw"] = {"kind": "screw", "energy": 2.0, "velocity": "0.5 m/s", "efficiency": 0.8, "force": 1e5}
    done = run(tmp_path, data, press="screw")
    found = [text for text in done.result.summary["warnings"] if "the press screw bears 100 kN" in text]
    force = 1e-3 * YIELD * math.pi * RADIUS**2 * math.exp(STRAIN)
    assert done.result.summary["press"][0]["nearest_to_rating"]["force_kN"] == pytest.approx(force, rel=0.01)
    assert len(found) == 1
