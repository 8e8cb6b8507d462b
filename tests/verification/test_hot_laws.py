# SPDX-License-Identifier: Apache-2.0
"""A bar of hot steel pressed or drawn along its axis at a given speed and temperature, in every family of elements.

Its stress at the end is the formula's, at the plastic strain that Hooke's law leaves of the whole strain, and at the
rate of the last increment.
"""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.body.law_window import LawWindow
from presswork.case import Case, ShellCase, build_model
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.elastic_plastic import make_plane_law, make_sheet_law, make_solid_law
from presswork.recorder import run_model

YOUNG, TEMPERATURE, DURATION = 100e3, 1100.0, 0.1
K, E0, N, M, BETA = 0.8, 0.02, 0.15, 0.15, 6000.0
STEEL: dict[str, Any] = {
    "young": YOUNG,
    "poisson": 0.3,
    "hardening": {
        "law": "norton_hoff", "K": K, "e0": E0, "n": N, "m": M, "beta": BETA, "strain_window": [0, 2],
        "rate_window": [1e-3, 100], "temperature_window": [800, 1250],
    },
    "heating": {"start": TEMPERATURE},
}  # fmt: skip
SOLVER = {"initial_increment": 0.05, "max_increment": 0.05, "force_tolerance": 1e-10}


def flow_stress(p: float, rate: float) -> float:
    return float(K * (E0 + p) ** N * rate**M * np.exp(BETA / (TEMPERATURE + 273.15)))


def solid(strain: float) -> dict[str, Any]:
    stroke = 10.0 * np.expm1(strain)
    return {
        "title": "bar",
        "analysis": "axisymmetric",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 10], "cells": [1, 1]}},
        "materials": {"steel": STEEL},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "end": {"set": "bottom", "fix": ["y"]}},
        "stages": [
            {
                "name": "go", "duration": DURATION,
                "displacement": [{"set": "top", "component": "y", "value": stroke}],
            }
        ],
        "solver": SOLVER,
    }  # fmt: skip


def space(strain: float) -> dict[str, Any]:
    stage = solid(strain)["stages"][0] | {
        "displacement": [{"set": "right", "component": "x", "value": 10 * np.expm1(strain)}]
    }
    return solid(strain) | {
        "analysis": "solid",
        "workpiece": {"material": "steel", "element": "hex8_fbar", "mesh": {"size": [10] * 3, "cells": [1, 1, 1]}},
        "boundary": {
            "x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}, "z": {"set": "back", "fix": ["z"]}
        },
        "stages": [stage],
    }  # fmt: skip


def shell(strain: float) -> dict[str, Any]:
    stage = solid(strain)["stages"][0] | {
        "displacement": [{"set": "right", "component": "x", "value": 10 * np.expm1(strain)}]
    }
    return solid(strain) | {
        "analysis": "shell",
        "workpiece": {
            "material": "steel", "element": "shell4_mitc", "section": {"thickness": 1, "points": 3},
            "mesh": {"size": [10, 10], "cells": [1, 1]},
        },
        "boundary": {
            "x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}, "z": {"set": "all", "fix": ["z"]}
        },
        "stages": [stage],
    }  # fmt: skip


FAMILIES = {"axisymmetric": (Case, solid, 1), "space": (SpaceCase, space, 0), "shell": (ShellCase, shell, 0)}


@pytest.mark.parametrize("strain", [-0.4, 0.2])
@pytest.mark.parametrize("family", FAMILIES)
def test_a_hot_bar_bears_the_stress_of_its_strain_rate_and_temperature(family: str, strain: float) -> None:
    kind, make, axis = FAMILIES[family]
    procedure = ImplicitProcedure(build_model(kind.model_validate(make(strain))))
    reports = list(procedure.advance())
    cells = procedure.state.cells
    stress = float(cells.stress[0][..., axis].mean())
    assert np.ptp(cells.stress[0][..., axis]) < 1e-6 * abs(stress)
    p = abs(strain - stress / YOUNG)
    assert float(cells.eqps[0].max()) == pytest.approx(p, rel=1e-6)
    lengths = 1.0 + np.expm1(strain) * (1.0 - np.array([0.05, 0.0]))
    rate = float(abs(np.diff(np.log(lengths)))[0]) / (0.05 * DURATION)
    assert float(cells.rate[0].max()) == pytest.approx(rate, rel=2e-3)  # elastic strain grows besides
    assert abs(stress) == pytest.approx(flow_stress(p, float(cells.rate[0].max())), rel=1e-7)
    assert max(len(r.log) for r in reports[1:]) <= 6


@pytest.mark.parametrize("window", [[1e-10, 1e6], [1e-4, 100.0]])
@pytest.mark.parametrize("m", [0.05, 0.3])
@pytest.mark.parametrize(("make", "size"), [(make_sheet_law, 3), (make_plane_law, 4), (make_solid_law, 6)])
def test_a_power_of_the_rate_finds_its_stress_for_any_size_and_time_of_a_step(
    make: Any, size: int, m: float, window: list[float]
) -> None:
    """A flow stress that rises from next to nothing, or has corners at the ends of its window of rates.

    Strains of 1e-9 to 3 %, in 1e-8 to 1 s.
    """
    data = solid(0.1)
    data["materials"]["steel"] = copy.deepcopy(STEEL)
    data["materials"]["steel"]["hardening"] |= {"rate_window": window, "m": m}
    law = make(build_model(Case.model_validate(data)).materials[0])
    n, random = 100, np.random.default_rng(1)
    for dt in (1e-8, 1.2e-5, 1e-4, 1.0):
        stress, history = np.zeros((n, size)), np.zeros((n, law.history_size))
        for _ in range(20):
            change = 10 ** random.uniform(-9, -1.5, (n, 1)) * random.standard_normal((n, size))
            if size > 3:
                change[:, :3] -= 0.999 * change[:, :3].mean(axis=1, keepdims=True)
            stress, history, _, _, failed = law.update(
                change, stress, history, dt=dt, temperature=np.full(n, TEMPERATURE)
            )
            assert not failed.any()


def test_a_step_across_the_corner_at_the_end_of_the_window_of_rates_finds_its_stress() -> None:
    """Newton's method for all unknowns at once goes back and forth across this corner."""
    data = solid(0.1)
    hardening = {
        "law": "norton_hoff", "K": 20, "e0": 0.01, "n": 0.2, "m": 0.12, "beta": 3000,
        "rate_window": [1e-4, 100], "temperature_window": [500, 1100], "strain_window": [0, 1],
    }  # fmt: skip
    data["materials"]["steel"] = STEEL | {"hardening": hardening}
    law = make_sheet_law(build_model(Case.model_validate(data)).materials[0])
    change = np.array([[2.2169721272856995e-06, 3.0922620677912505e-06, 2.9292530978584857e-06]])
    stress_n = np.array([[-27.60680983448456, -30.592555186528703, -6.092681497798113]])
    history_n = np.array([[1.1222476132356686e-10]])
    stress, history, _, _, failed = law.update(change, stress_n, history_n, dt=1e-6, temperature=np.array([950.0]))
    assert not failed.any()
    growth = history[0, 0] - history_n[0, 0]
    x, y, xy = stress[0]
    expected = 20 * (0.01 + history[0, 0]) ** 0.2 * min(max(growth / 1e-6, 1e-4), 100) ** 0.12 * np.exp(3000 / 1223.15)
    assert np.sqrt(x * x - x * y + y * y + 3 * xy * xy) == pytest.approx(expected, rel=1e-9)


def test_a_bar_pressed_ten_times_as_fast_is_stronger_by_the_exponent_of_rate() -> None:
    found = []
    for duration in (1.0, 0.1):
        data = solid(-0.3)
        data["stages"][0]["duration"] = duration
        procedure = ImplicitProcedure(build_model(Case.model_validate(data)))
        list(procedure.advance())
        found.append(float(procedure.state.cells.stress[0][..., 1].mean()))
    assert found[1] / found[0] == pytest.approx(10**M, rel=1e-3)


def test_a_run_tells_how_far_and_how_often_metal_flowed_outside_the_window(tmp_path: Path) -> None:
    data = solid(-0.4)
    data["materials"]["steel"]["hardening"] = STEEL["hardening"] | {
        "strain_window": [0.01, 0.2], "rate_window": [1e-3, 2.0]
    }  # fmt: skip
    run_model(build_model(Case.model_validate(data)), tmp_path / "run")
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    told = summary["law_windows"]["steel"]
    assert told["strain"]["reached"][1] == pytest.approx(0.4, rel=1e-2)
    assert told["strain"]["share_above"] == pytest.approx(0.45, abs=0.1)
    assert told["rate"]["share_above"] == 1.0
    assert told["temperature"] == {
        "window": [800.0, 1250.0], "reached": [TEMPERATURE] * 2, "share_below": 0.0, "share_above": 0.0
    }  # fmt: skip
    warnings = [w for w in summary["warnings"] if "its law holds" in w]
    assert len(warnings) == 2
    assert "a strain from 0.01 to 0.2, and metal flowed up to 0.399" in warnings[0]


def test_an_explicit_run_tells_it_too_and_over_a_resume(tmp_path: Path) -> None:
    data = solid(-0.2) | {"procedure": "explicit"}
    del data["solver"]
    data["workpiece"] = data["workpiece"] | {"element": "quad4_1pt"}
    data["materials"]["steel"] = STEEL | {"density": "7850 kg/m^3"}
    data["stages"][0]["duration"] = 5e-4
    model = build_model(Case.model_validate(data))

    def stop(progress: Any) -> None:
        if progress.fraction > 0.5:
            raise KeyboardInterrupt

    run_model(model, tmp_path / "whole")
    run_model(model, tmp_path / "parts", on_increment=stop)
    run_model(model, tmp_path / "parts", resume=True)
    whole, parts = (json.loads((tmp_path / name / "summary.json").read_text()) for name in ("whole", "parts"))
    told = whole["law_windows"]["steel"]
    assert parts["law_windows"]["steel"] == told
    assert told["rate"]["reached"][1] == pytest.approx(1.1 * 0.2 / 5e-4, rel=0.3)
    assert told["rate"]["share_above"] > 0.5
    assert any("1/s, and metal flowed up to" in warning for warning in whole["warnings"])


def test_what_flowed_outside_the_window_is_counted_over_a_resumed_run_too() -> None:
    procedure = ImplicitProcedure(build_model(Case.model_validate(solid(-0.4))))
    increments = procedure.advance()
    for _ in range(5):
        next(increments)
    again = ImplicitProcedure(procedure.model)
    again.state.load_arrays(procedure.state.to_arrays())
    list(increments)
    list(again.advance())
    for name, values in procedure.state[LawWindow].to_arrays().items():
        np.testing.assert_array_equal(again.state[LawWindow].to_arrays()[name], values)
    assert procedure.state[LawWindow].flowed[0] > 0


def test_growth_of_a_point_by_round_off_is_no_flow() -> None:
    material = build_model(Case.model_validate(solid(-0.4))).materials[0]
    window, grown = LawWindow.at_rest([material]), np.array([1e-12, 1e-3])
    window.note(0, material, np.full(2, 0.1), grown, 0.1, np.full(2, TEMPERATURE))
    assert window.flowed[0] == 1
    assert window.warnings([material]) == []
    assert window.reached[0, 1] == pytest.approx(1e-2)
