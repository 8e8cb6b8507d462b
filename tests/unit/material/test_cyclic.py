# SPDX-License-Identifier: Apache-2.0
"""Identification from tests with reversals: made by explicit integration of the rate equations, and read from files."""

from __future__ import annotations

import itertools
import re
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import Case, run
from presswork.case.errors import CaseError
from presswork.case.material.sheet import check_sheet_material
from presswork.cli import app
from presswork.material.cyclic import find_turns, is_cyclic, read_cyclic
from presswork.material.cyclic_laws import CYCLIC_LAWS
from presswork.material.identify_cyclic import CyclicFit, fit_cyclic
from presswork.server.material_fit import fit_test
from tests.problems.sheet_paths import integrate_yoshida_uemori, pull

YOUNG = 70e3
TURNS = (0.05, -0.04, 0.05, -0.05)
VOCE = {"yield_stress": 120.0, "saturation_stress": 180.0, "rate": 15.0}
BACK = {"C1": 12e3, "gamma1": 300.0, "C2": 1.5e3, "gamma2": 20.0}
YOSHIDA = {"yield_stress": 150.0, "B": 190.0, "C": 500.0, "m": 12.0, "b": 40.0, "Rsat": 120.0, "h": 0.3}


def integrate_chaboche(given: dict[str, float], count: int, modulus: float = 0.0, dp: float = 1e-5) -> np.ndarray:
    """Integrate Voce's law, a straight line and back stresses by Euler's explicit rule; return strain and stress."""
    plastic = strain = stress = 0.0
    back, rows = [0.0] * count, [(0.0, 0.0)]
    top, low, rate = (given[name] for name in ("saturation_stress", "yield_stress", "rate"))

    def find_flow() -> float:
        return low + (top - low) * (1.0 - float(np.exp(-rate * plastic))) + modulus * plastic

    for target in TURNS:
        sense = 1.0 if target > strain else -1.0
        first = sense * find_flow() + sum(back)
        strain, stress = strain + (first - stress) / YOUNG, first
        while sense * (target - strain) > 0.0:
            rows.append((strain, stress))
            for k in range(count):
                back[k] += (given[f"C{k + 1}"] * sense - given[f"gamma{k + 1}"] * back[k]) * dp
            plastic += dp
            new = sense * find_flow() + sum(back)
            strain, stress = strain + (new - stress) / YOUNG + sense * dp, new
    return np.array(rows)


def write(path: Path, rows: np.ndarray, head: str = "strain,stress") -> Path:
    path.write_text("\n".join([head, *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n")
    return path


@cache
def make_rows(law: str) -> np.ndarray:
    """Points of four branches, elastic ones added: explicit steps go straight to the yield surface."""
    if law == "yoshida_uemori":
        given = {"Y": YOSHIDA["yield_stress"], **YOSHIDA, "Ea": YOUNG, "xi": 0.0}
        rows = integrate_yoshida_uemori(given, YOUNG, TURNS, dp=4e-6, every=1)
    else:
        count = CYCLIC_LAWS[law].parts
        rows = integrate_chaboche({**VOCE, **BACK}, count, 300.0 if law == "isotropic" else 0.0)
    steep = np.abs(np.diff(rows[:, 1], prepend=0.0)) > 5.0
    turning = np.isin(np.arange(len(rows)), [i - 1 for i in np.flatnonzero(steep)])
    rows = rows[steep | turning | (np.arange(len(rows)) % 20 == 0)]
    dense = [rows[:1]]
    for before, after in itertools.pairwise(rows):
        n = 1 + int(abs(after[1] - before[1]) / 10.0)
        dense.append(before + (after - before) * (np.arange(1, n + 1) / n)[:, None])
    return np.concatenate(dense)


@pytest.mark.parametrize(
    ("law", "made"),
    [
        ("isotropic", {**VOCE, "modulus": 300.0}),
        ("chaboche_1", {**VOCE, "C1": BACK["C1"], "gamma1": BACK["gamma1"]}),
        ("chaboche_2", {**VOCE, **BACK}),
        ("yoshida_uemori", YOSHIDA),
    ],
)
def test_parameters_come_back_from_a_test_that_was_integrated(law, made, tmp_path) -> None:
    test = read_cyclic(write(tmp_path / "t.csv", make_rows(law)))
    assert [branch.end for branch in test.branches] == pytest.approx(TURNS, abs=2e-4)
    (fit,) = fit_cyclic(test, law, YOUNG)
    print(law, fit.parameters, fit.find_error(fitted=True))
    assert fit.find_error(fitted=True) < 0.3
    for name, value in made.items():
        assert fit.parameters[name] == pytest.approx(value, rel=0.02), name


def test_parameters_that_the_fitted_part_does_not_determine_are_named(tmp_path) -> None:
    test = read_cyclic(write(tmp_path / "t.csv", make_rows("chaboche_2")))
    (early,) = fit_cyclic(test, "chaboche_2", YOUNG, 1.05)
    (late,) = fit_cyclic(test, "chaboche_2", YOUNG)
    assert late.loose == ()
    assert "gamma1" in early.loose, "the fast back stress shows once the flow has turned"


def test_branches_that_are_left_out_are_predicted(tmp_path) -> None:
    test = read_cyclic(write(tmp_path / "t.csv", make_rows("chaboche_1")))
    (fit,) = fit_cyclic(test, "chaboche_1", YOUNG, 1.5)
    assert [(e.branch, e.is_fitted) for e in fit.errors] == [(1, True), (2, True), (2, False), (3, False), (4, False)]
    assert fit.find_error(fitted=False) < 1.0
    (other,) = fit_cyclic(test, "isotropic", YOUNG, 1.5)
    assert other.find_error(fitted=False) > 20.0
    assert fit.criterion < other.criterion
    assert fit.fitted_path == pytest.approx(0.05 + 0.045, rel=0.03)


@pytest.mark.parametrize(
    ("law", "given"),
    [("isotropic", {**VOCE, "modulus": 300.0}), ("chaboche_2", {**VOCE, **BACK}), ("yoshida_uemori", YOSHIDA)],
)
def test_the_compiled_law_of_a_material_file_follows_the_fit(law, given) -> None:
    """Backward Euler in 80 and 320 increments a branch: errors of the first order."""
    fit = CyclicFit(law, given, YOUNG, 0.0, (), (), 0.0)
    material = check_sheet_material({"young": YOUNG, "poisson": 0.3, **fit.to_tables()})
    worst = []
    for n in (80, 320):
        strains = [np.linspace(start, end, n + 1)[1:] for start, end in itertools.pairwise((0.0, *TURNS))]
        own = pull(material.build_law(), np.concatenate(strains))[0].reshape(len(TURNS), n)
        sets = np.array([[given[key] for key in CYCLIC_LAWS[law].keys]])
        found = CYCLIC_LAWS[law].stress(sets, TURNS, strains, YOUNG)
        worst.append(max(float(np.abs(a - b[:, 0]).max()) for a, b in zip(own, found, strict=True)))
    assert worst[1] < 0.4 * worst[0] + 0.1
    assert worst[1] < 3.0, "MPa, of stresses to 300"


def test_turns_are_found_beside_noise_and_holds() -> None:
    strain = np.concatenate([np.linspace(0, 1, 50), np.full(5, 1.0), np.linspace(1, -0.5, 60), np.linspace(-0.5, 0, 9)])
    noisy = strain + 0.01 * np.sin(17.0 * np.arange(len(strain)))
    turns = find_turns(noisy)
    np.testing.assert_allclose(strain[turns], [0.0, 1.0, -0.5, 0.0], atol=0.03)


def test_true_columns_are_taken_where_engineering_ones_are_beside_them(tmp_path) -> None:
    e, s = make_rows("isotropic").T
    rows = np.column_stack([np.arange(len(e)), np.expm1(e), s * np.exp(-e), e, s])
    head = "time_s,eng_strain,eng_stress_MPa,true_strain,true_stress_MPa"
    both = read_cyclic(write(tmp_path / "both.csv", rows, head))
    eng = read_cyclic(write(tmp_path / "eng.csv", rows[:, 1:3], "engineering_strain,engineering_stress"))
    for one, other in zip(both.branches, eng.branches, strict=True):
        np.testing.assert_allclose(one.stress, other.stress, atol=1e-3)
    assert "true_stress_MPa" in both.how


def test_tension_alone_and_unloading_make_no_test_with_reversals(tmp_path) -> None:
    e, s = make_rows("isotropic").T
    first = int(np.argmax(e))
    path = write(tmp_path / "t.csv", np.column_stack([e, s])[: first + 1])
    assert not is_cyclic(path)
    unloaded = np.column_stack([[*e[:first], e[first] - s[first] / YOUNG], [*s[:first], 0.0]])
    assert not is_cyclic(write(tmp_path / "u.csv", unloaded))
    with pytest.raises(CaseError, match="the strain does not turn"):
        read_cyclic(path)
    assert not is_cyclic(write(tmp_path / "hot.csv", unloaded, "a,b"))


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--law", "swift"], "unknown law of tests with reversals"),
        (["--fit-branches", "1"], "--fit-branches: 1 branches do not show what a reversal does"),
        (["--fit-branches", "5"], "give a number from 1.05 to 4"),
    ],
)
def test_options_that_do_not_fit_are_refused_with_a_remedy(options, expected, tmp_path) -> None:
    path = write(tmp_path / "t.csv", make_rows("isotropic"))
    answer = CliRunner().invoke(app, ["material", "fit", str(path), "--young", "70 GPa", *options])
    assert answer.exit_code == 2
    assert expected in re.sub(r"\s+", " ", answer.output)


def test_the_command_writes_a_material_that_a_case_runs_with(tmp_path) -> None:
    """A bar under tension, then pushed back: its stress is the law's."""
    path = write(tmp_path / "t.csv", make_rows("chaboche_1"))
    options = ["--young", "70 GPa", "--law", "chaboche_1", "--fit-branches", "2"]
    answer = CliRunner().invoke(app, ["material", "fit", str(path), *options])
    assert "predicted, branch 3" in answer.output
    assert (tmp_path / "t.png").stat().st_size > 10_000
    assert tomllib.loads((tmp_path / "t.toml").read_text())["material"]["kinematic"]["law"] == "chaboche"
    ends = [np.exp(0.05), np.exp(-0.04)]
    case = Case(
        title="pulled and pushed", analysis="axisymmetric",
        workpiece={"material": str(tmp_path / "t.toml"), "mesh": {"size": [1, 1], "cells": [1, 1]}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
        solver={"max_increment": 0.02},
        stages=[{"name": name, "displacement": [{"set": "top", "component": "y", "value": value}]}
                for name, value in (("pull", ends[0] - 1.0), ("push", ends[1] - ends[0]))],
    )  # fmt: skip
    outcome = run(case, tmp_path / "run")
    assert outcome.status == "completed", outcome.reason
    stress = outcome.result.field("stress", -1)
    (fit,) = fit_cyclic(read_cyclic(path), "chaboche_1", YOUNG, 2.0)
    assert float(stress.reshape(-1, stress.shape[-1])[0, 1]) == pytest.approx(fit.stress[1][-1], abs=4.0)


def test_the_editor_fits_reversals_as_the_command_does(tmp_path) -> None:
    path = write(tmp_path / "t.csv", make_rows("chaboche_1")[:330])
    assert is_cyclic(path)
    found = fit_test(path, {"young": "70 GPa", "law": "chaboche_1"}, tmp_path / "saved.toml")
    assert found["kind"] == "tension and compression"
    assert found["laws"][0]["law"] == "chaboche_1"
    assert found["laws"][0]["relative"] < 0.002
    assert [curve["label"] for curve in found["curves"]][:2] == ["measured", "chaboche_1"]
    assert tomllib.loads((tmp_path / "saved.toml").read_text())["material"]["kinematic"]["law"] == "chaboche"
