# SPDX-License-Identifier: Apache-2.0
"""Friction by pressure, speed, temperature and path: published tables, a belt on a roll, and a die that slides."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.law.friction import find_pressure_factor, find_wanheim_bay, limit_stress
from presswork.model import FloatArray, Friction, FrictionFactors
from presswork.recorder import run_model

BAY = Path(__file__).parents[1] / "data" / "wanheim_bay.csv"


def test_wanheim_bay_is_its_table() -> None:
    rows = list(csv.reader(line for line in BAY.read_text().splitlines() if not line.startswith("#")))
    f, pressure, shear = np.array(rows[1:], dtype=float).T
    found, slope = find_wanheim_bay(f, pressure)
    np.testing.assert_allclose(found, shear, atol=6e-7)  # of six digits
    step = 1e-6
    ahead, behind = (find_wanheim_bay(f, pressure + s * step)[0] for s in (1.0, -1.0))
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * step), atol=1e-5)


def test_levanov() -> None:
    pressure, one = np.array([0.5, 1.0, 2.0]) * 300.0, np.ones(3)
    shear_flow = 300.0 / np.sqrt(3.0)
    found, _ = limit_stress(Friction("levanov", m=1.0), one, 0.0 * one, pressure, shear_flow * one)
    np.testing.assert_allclose(found / shear_flow, [0.46474, 0.71350, 0.91792], atol=5e-6)


@pytest.mark.parametrize("law", ["coulomb", "coulomb_capped", "shear", "wanheim_bay", "levanov"])
def test_slope_by_pressure_is_the_derivative(law: Any) -> None:
    factors = FrictionFactors(pressure=np.array([[0.0, 1.0], [50.0, 0.7], [400.0, 0.9]]), exponent=0.8, reference=20.0)
    rng = np.random.default_rng(7)
    p, k = rng.uniform(1.0, 500.0, 200), rng.uniform(80.0, 120.0, 200)
    m, mu, step = np.full(200, 0.6), np.full(200, 0.15), 1e-5
    _, slope = limit_stress(Friction(law, m=0.6, mu=0.15, factors=factors), m, mu, p, k)
    ahead, behind = (limit_stress(Friction(law, factors=factors), m, mu, p + s * step, k)[0] for s in (1.0, -1.0))
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * step), rtol=1e-5, atol=1e-7)


def test_pressure_factor_beyond_its_table_and_near_zero() -> None:
    factors = FrictionFactors(pressure=np.array([[10.0, 1.0], [100.0, 0.5]]))
    np.testing.assert_array_equal(find_pressure_factor(factors, np.array([0.0, 1e4]))[0], [1.0, 0.5])
    power = FrictionFactors(exponent=0.5, reference=4.0)
    value, slope = find_pressure_factor(power, np.array([0.0, 4.0]))
    assert value[1] == 1.0
    assert np.isfinite(value[0])
    assert slope[0] == 0.0


# --- a belt of 0.1 mm round a quarter of a roll ----------------------------------------------------------------------

RADIUS, MIDDLE, PER_QUARTER, STRAIGHT = 10.0, 10.05, 40, 6


def write_belt(path: Path) -> None:
    """Write a strip that lies on a roll of 10 mm round a quarter turn, and goes straight on at both ends."""
    turn = np.linspace(0.0, 0.5 * np.pi, PER_QUARTER + 1)
    step = MIDDLE * turn[1]
    rows = []
    for r in (RADIUS, RADIUS + 0.1):
        arc = r * np.column_stack([np.cos(turn), np.sin(turn)])
        before = arc[0] - step * np.arange(STRAIGHT, 0, -1)[:, None] * [0.0, 1.0]
        after = arc[-1] - step * np.arange(1, STRAIGHT + 1)[:, None] * [1.0, 0.0]
        rows.append(np.concatenate([before, arc, after]))
    n = len(rows[0])
    nodes = [f"{i + 1}, {x!r}, {y!r}" for i, (x, y) in enumerate(np.concatenate(rows).tolist())]
    cells = [f"{i + 1}, {i + 1}, {i + n + 1}, {i + n + 2}, {i + 2}" for i in range(n - 1)]
    sets = [f"*NSET, NSET=anchor\n1, {n + 1}", f"*NSET, NSET=pulled\n{n}, {2 * n}"]
    path.write_text("\n".join(["*NODE", *nodes, "*ELEMENT, TYPE=CPE4, ELSET=belt", *cells, *sets, ""]))


def pull_belt(folder: Path, friction: Mapping[str, Any] | None) -> tuple[float, float]:
    """Return the tension at the anchor and at the pulled end of a belt that slides [N/mm]."""
    write_belt(folder / "belt.inp")
    roll: dict[str, Any] = {
        "profile": [[0, 10], {"to": [0, -10], "centre": [0, 0], "turn": "right"}, {"to": [0, 10], "centre": [0, 0],
        "turn": "right"}], "contact": "coulomb", "mu": 0.15, "free_side": "left",
    }  # fmt: skip
    if friction:
        roll["friction"] = friction
    case = {
        "title": "belt",
        "analysis": "plane_strain",
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "file", "path": str(folder / "belt.inp")},
        },
        "materials": {"steel": {"young": 200e3, "poisson": 0.0}},
        "boundary": {"anchor": {"set": "anchor", "fix": ["x", "y"]}, "line": {"set": "pulled", "fix": ["y"]}},
        "tools": {"roll": roll},
        "stages": [
            {"name": "pull", "duration": 1.0, "displacement": [{"set": "pulled", "component": "x", "value": -0.5}]}
        ],
        "solver": {"initial_increment": 0.02, "max_increment": 0.05},
        "output": {"steps": 1},
    }
    outcome = run_model(build_model(Case.model_validate(case)), folder / "run", threads=1)
    assert outcome.status == "completed", outcome.reason
    history = outcome.result.history
    return abs(float(history["anchor.force_y"][-1])), abs(float(history["pulled.force_x"][-1]))


@pytest.mark.parametrize(
    "friction",
    [
        pytest.param(None, id="constant"),
        pytest.param({"exponent": 0.9, "reference_pressure": 4}, id="power of the pressure"),
        pytest.param({"pressure": [[0, 1], [400, 0.6]]}, id="table of the pressure"),
    ],
)
def test_belt_on_a_roll(friction: Mapping[str, Any] | None, tmp_path: Path) -> None:
    """dT = mu(p) T dangle with p = T / R, integrated along the belt; the law by powers has it in closed form."""
    slack, taut = pull_belt(tmp_path, friction)
    assert taut == pytest.approx(integrate_belt(slack, friction), rel=2e-3)
    if friction and "exponent" in friction:
        e, scale = 0.9, (1 - 0.9) * 0.15 * (RADIUS * 4.0) ** 0.1 * 0.5 * np.pi
        assert integrate_belt(100.0, friction) == pytest.approx(123.703, abs=2e-3)
        assert integrate_belt(slack, friction) == pytest.approx((slack ** (1 - e) + scale) ** (1 / (1 - e)), rel=1e-6)


def integrate_belt(slack: float, friction: Mapping[str, Any] | None) -> float:
    """Return the tension after a quarter of a turn [N/mm]."""
    tension, steps = slack, 4000
    for _ in range(steps):
        half = tension * (1.0 + 0.5 * 0.15 * _factor(tension / RADIUS, friction) * 0.5 * np.pi / steps)
        tension += 0.15 * _factor(half / RADIUS, friction) * half * 0.5 * np.pi / steps
    return tension


def _factor(pressure: float, friction: Mapping[str, Any] | None) -> float:
    if friction is None:
        return 1.0
    if "exponent" in friction:
        return float((pressure / friction["reference_pressure"]) ** (friction["exponent"] - 1.0))
    at, factor = np.array(friction["pressure"]).T
    return float(np.interp(pressure, at, factor))


# --- a die that is pressed on a block, and then slides on it ----------------------------------------------------------


def describe_slide(friction: Mapping[str, Any] | None, *, in_space: bool = False) -> dict[str, Any]:
    """Return the case of a die that slides by 0.4 mm within 0.1 s, 4 mm/s, on a block that is held below."""
    die: dict[str, Any] = {"contact": "coulomb", "mu": 0.1}
    if friction:
        die["friction"] = friction
    mesh: dict[str, Any] = {"size": [10, 5], "cells": [6, 3]}
    held, moves, down, along = {"set": "bottom", "fix": ["x", "y"]}, {"profile": [[-40, 5], [40, 5]]}, [0, -1], [1, 0]
    if in_space:
        mesh = {"kind": "box", "size": [10, 5, 5], "cells": [4, 2, 2]}
        held, down, along = {"set": "back", "fix": ["x", "y", "z"]}, [0, 0, -1], [1, 0, 0]
        moves = {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 5]}
    return {
        "title": "slide",
        "analysis": "solid" if in_space else "plane_strain",
        "workpiece": {"material": "steel", "mesh": mesh} | ({"element": "hex8_fbar"} if in_space else {}),
        "materials": {
            "steel": {
                "young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 500, "modulus": 1000},
            }
        },
        "boundary": {"floor": held},
        "tools": {"die": die | moves},
        "stages": [
            {"name": "press", "duration": 1.0, "tools": {"die": {"stroke": 0.004, "direction": down}}},
            {"name": "slide", "duration": 0.1, "tools": {"die": {"stroke": 0.4, "direction": along}}},
        ],
        "solver": {"initial_increment": 0.05, "max_increment": 0.1},
        "output": {"steps": 2},
    }  # fmt: skip


def slide(case: dict[str, Any], folder: Path) -> FloatArray:
    """Return the friction over the normal force, row by row of the history."""
    kind = SpaceCase if case["analysis"] == "solid" else Case
    outcome = run_model(build_model(kind.model_validate(case)), folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    history = outcome.result.history
    normal = history["die.force_z" if case["analysis"] == "solid" else "die.force_y"]
    return np.abs(history["die.force_x"]) / np.maximum(np.abs(normal), 1e-9)


@pytest.mark.parametrize("in_space", [False, True], ids=["plane", "space"])
def test_friction_by_speed_and_path(in_space: bool, tmp_path: Path) -> None:
    """4 mm/s have a factor of 0.8; a path of 0.4 mm, less that of the last increment, one of 1.4."""
    speed = slide(describe_slide({"speed": [[0, 1], [10, 0.5]]}, in_space=in_space), tmp_path / "speed")
    assert speed[-1] == pytest.approx(0.08, rel=1e-3)
    path = slide(describe_slide({"path": [[0, 1], [1, 2]]}, in_space=in_space), tmp_path / "path")
    assert path[-1] == pytest.approx(0.1 * 1.36, rel=5e-3)
    assert (np.diff(path[-4:]) > 0.005 * path[-1]).all()


def test_friction_by_temperature(tmp_path: Path) -> None:
    case = describe_slide({"temperature": [[20, 1], [420, 3]]})
    case["heat"] = {"initial_temperature": 220}
    case["materials"]["steel"] |= {
        "density": 7.85e-9, "heating": {"melting": 1500, "exponent": 1.0},
        "thermal": {"conductivity": 45.0, "specific_heat": 4.6e8},
    }  # fmt: skip
    assert slide(case, tmp_path / "run")[-1] == pytest.approx(0.2, rel=1e-2)


def test_factor_of_one_changes_nothing(tmp_path: Path) -> None:
    plain = slide(describe_slide(None), tmp_path / "plain")
    one = slide(describe_slide({"pressure": [[0, 1], [1e4, 1]]}), tmp_path / "one")
    np.testing.assert_allclose(one, plain, rtol=1e-9, atol=1e-12)


# --- what is refused ---


@pytest.mark.parametrize(
    ("friction", "key", "words"),
    [
        ({}, "friction", "no factor is given"),
        ({"exponent": 0.9}, "friction.reference_pressure", "missing key"),
        ({"reference_pressure": 4}, "friction.reference_pressure", "without exponent"),
        ({"exponent": 1.2, "reference_pressure": 4}, "friction.exponent", "expected a value <= 1"),
        ({"pressure": [[0, 1]]}, "friction.pressure", "two rows"),
        ({"pressure": [[-1, 1], [5, 1]]}, "friction.pressure.0.0", ">= 0"),
        ({"speed": [[0, 1], [5, -1]]}, "friction.speed.1.1", "factor from 0 to 100"),
        ({"path": [[5, 1], [0, 2]]}, "friction.path", "does not increase"),
        ({"temperature": [[20, 1], [900, 2]]}, "friction.temperature", "no temperature is known"),
    ],
)
def test_bad_factors_are_refused(friction: dict[str, Any], key: str, words: str) -> None:
    case = describe_slide({"exponent": 0.9, "reference_pressure": 4})
    case["tools"]["die"]["friction"] = friction
    with pytest.raises(CaseError, match=words) as refused:
        build_model(Case.model_validate(case))
    assert any(f"tools.die.{key}" in problem.key for problem in refused.value.problems)


@pytest.mark.parametrize("law", ["shear", "wanheim_bay", "levanov"])
@pytest.mark.parametrize("in_space", [False, True], ids=["plane", "space"])
def test_friction_by_the_flow_stress_of_an_elastic_block_is_refused(law: str, in_space: bool) -> None:
    case = describe_slide(None, in_space=in_space)
    del case["materials"]["steel"]["hardening"], case["tools"]["die"]["mu"]
    case["tools"]["die"] |= {"contact": law, "m": 0.3}
    with pytest.raises(CaseError, match="it has no hardening"):
        build_model((SpaceCase if in_space else Case).model_validate(case))


def test_factors_without_friction_and_in_explicit_runs_are_refused() -> None:
    case = describe_slide({"exponent": 0.9, "reference_pressure": 4})
    case["tools"]["die"] |= {"contact": "sticking"}
    del case["tools"]["die"]["mu"]
    with pytest.raises(CaseError, match="choose a friction law"):
        build_model(Case.model_validate(case))
    for in_space, kind in ((False, Case), (True, SpaceCase)):
        explicit = describe_slide({"exponent": 0.9, "reference_pressure": 4}, in_space=in_space)
        explicit["procedure"] = "explicit"
        with pytest.raises(CaseError, match="for implicit runs"):
            build_model(kind.model_validate(explicit))
    law = describe_slide(None) | {"procedure": "explicit"}
    law["tools"]["die"] = {"profile": [[-40, 5], [40, 5]], "contact": "levanov", "m": 0.3}
    with pytest.raises(CaseError, match="the explicit procedure has no such law"):
        build_model(Case.model_validate(law))
