# SPDX-License-Identifier: Apache-2.0
"""Hot stamping from its case to the pictures: balance of heat, martensite, resume, threads, time of the press."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import run_model
from presswork.case import StampingCase, build_model
from presswork.results import Result
from presswork.view.all_plots import plot_all
from tests.problems.hot_strip import bent_strip, hot_strip

BALANCE = 1e-8


def run(folder: Path, *changes: tuple[str, object], **options: Any):
    return run_case(hot_strip(*changes), folder, **options)


def run_case(case: dict[str, Any], folder: Path, **options: Any):
    return run_model(build_model(StampingCase.model_validate(case)), folder, **{"threads": 1, **options})


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Result:
    outcome = run(tmp_path_factory.mktemp("hot") / "out")
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def test_heat_balances(result) -> None:
    assert result.summary["heat"]["balance_error"] < BALANCE
    history = result.history
    kinds = ("plastic", "friction", "tools", "convection", "radiation", "latent")
    incoming = sum(history[f"heat_{kind}"] for kind in kinds)
    assert incoming == pytest.approx(history["heat_stored"], rel=BALANCE)
    assert history["heat_latent"][-1] > 0.0


def test_time_is_that_of_the_press(result) -> None:
    history = result.history
    assert history["process_time"][-1] == pytest.approx(6.5)
    ends = [history["process_time"][history["stage"] == name][-1] for name in ("transfer", "form", "quench")]
    assert ends == pytest.approx([2.0, 2.5, 6.5])
    assert not np.diff(history["cycles"][history["stage"] == "quench"]).any()


def test_what_is_quenched_becomes_martensite(result) -> None:
    cells = {name: result.field(name, -1) for name in ("martensite", "hardness", "temperature", "cooling_rate")}
    pressed = cells["temperature"] < 225.0
    assert pressed.sum() > 10
    wanted = 1.0 - np.exp(-0.011 * (409.0 - cells["temperature"][pressed]))
    assert cells["martensite"][pressed] == pytest.approx(wanted, abs=0.02)
    assert 470 < cells["hardness"].min() < cells["hardness"].max() < 510
    assert cells["cooling_rate"].min() > 100.0
    top, bottom = (result.field(f"temperature_{face}", -1) for face in ("top", "bottom"))
    assert np.abs(top - bottom).max() < 20.0


def test_pictures_show_temperature_and_hardness(result, tmp_path) -> None:
    names = {path.name for path in plot_all(result, tmp_path)}
    last = len(result.times) - 1
    assert {"temperature_time.png", f"shell_hardness_{last:03d}.png", f"shell_temperature_{last:03d}.png"} <= names


def test_a_resumed_run_gives_the_same_bits(result, tmp_path) -> None:
    def interrupt(progress) -> None:
        if progress.fraction > 0.7:
            raise KeyboardInterrupt

    assert run(tmp_path / "cut", on_increment=interrupt).status == "interrupted"
    resumed = run(tmp_path / "cut", resume=True)
    assert resumed.status == "completed"
    assert (tmp_path / "cut/history.csv").read_bytes() == (result.folder / "history.csv").read_bytes()
    assert np.array_equal(resumed.result.field("hardness"), result.field("hardness"))


def test_two_threads_give_the_bits_of_one(result, tmp_path) -> None:
    run(tmp_path / "two", threads=2)
    assert (tmp_path / "two/history.csv").read_bytes() == (result.folder / "history.csv").read_bytes()


def test_tools_that_warm_up_take_less(result, tmp_path) -> None:
    steel = {"conductivity": 25, "specific_heat": "460 J/(kg*K)", "density": "7800 kg/m^3", "warms_up": True}
    changes = [(f"tools.{tool}.heat.{key}", value) for tool in ("holder", "die") for key, value in steel.items()]
    warm = run(tmp_path / "warm", *changes).result
    assert warm.summary["heat"]["balance_error"] < BALANCE
    assert warm.history["holder.temperature_max"][-1] > 80.0
    assert warm.history["temperature_mean"][-1] > result.history["temperature_mean"][-1]


def test_work_and_friction_heat_the_sheet(tmp_path) -> None:
    result = run_case(bent_strip(("tools.die.mu", 0.4)), tmp_path / "bent").result
    history = result.history
    assert result.summary["heat"]["balance_error"] < BALANCE
    assert history["heat_plastic"][-1] == pytest.approx(0.9 * history["internal_energy"][-1], rel=0.1)
    assert 0.2 < history["heat_friction"][-1] / history["friction_energy"][-1] < 1.0


def test_a_law_takes_its_rate_by_the_time_of_the_press(tmp_path) -> None:
    """Two speeds of the computation make the work of one press."""
    rate = ("materials.steel.rate", {"law": "cowper_symonds", "D": 10, "q": 2})
    works = []
    for velocity in (1000.0, 250.0):
        case = bent_strip(rate, ("stages.1.velocity", velocity), ("heat.surroundings", None))
        history = run_case(case, tmp_path / f"{velocity:g}").result.history
        works.append(float(history["internal_energy"][-1]))
    assert works[0] == pytest.approx(works[1], rel=0.03)


def test_both_procedures_agree(tmp_path) -> None:
    """The same case by rows of cycles and by increments: heat, work, temperatures."""
    found = {}
    for procedure in ("explicit", "implicit"):
        result = run_case(bent_strip(("procedure", procedure)), tmp_path / procedure).result
        assert result.summary["heat"]["balance_error"] < BALANCE
        history = result.history
        found[procedure] = {
            name: float(history[name][-1]) for name in ("temperature_mean", "heat_tools", "heat_plastic")
        }
    explicit, implicit = found["explicit"], found["implicit"]
    assert implicit["temperature_mean"] == pytest.approx(explicit["temperature_mean"], abs=10.0)
    assert implicit["heat_tools"] == pytest.approx(explicit["heat_tools"], rel=0.05)
    assert implicit["heat_plastic"] == pytest.approx(explicit["heat_plastic"], rel=0.08)


@pytest.mark.validation
def test_implicit_increments_follow_the_change_of_temperature(tmp_path) -> None:
    """The tools cool the strip by 200 K."""
    softens = ("materials.steel.heating", {"reference": 650, "melting": 1480, "exponent": 0.8})
    largest, counts = [], []
    for limit in (100.0, 10.0):
        changes = [("procedure", "implicit"), softens, ("stages.1.process_time", 2.0), ("heat.max_change", limit)]
        history = run_case(bent_strip(*changes), tmp_path / f"{limit:g}").result.history
        form = np.flatnonzero(history["stage"] == "form")
        counts.append(len(form))
        largest.append(float(np.abs(np.diff(history["temperature_min"][[form[0] - 1, *form]])).max()))
    assert largest[1] < 0.7 * largest[0]
    assert counts[1] > counts[0]


@pytest.mark.validation
def test_an_implicit_run_resumes_to_the_same_bits(tmp_path) -> None:
    case = bent_strip(("procedure", "implicit"))

    def interrupt(progress) -> None:
        if progress.fraction > 0.5:
            raise KeyboardInterrupt

    whole = run_case(case, tmp_path / "whole").result
    run_case(case, tmp_path / "cut", on_increment=interrupt)
    run_case(case, tmp_path / "cut", resume=True)
    assert (tmp_path / "cut/history.csv").read_bytes() == (whole.folder / "history.csv").read_bytes()


@pytest.mark.parametrize("procedure", ["explicit", "implicit"])
def test_a_quenched_part_is_trimmed_and_springs_back_cold(procedure, tmp_path) -> None:
    trim = {"edge": {"shape": "rectangle", "size": [12, 8], "corner_radius": 0}}
    case = bent_strip(("procedure", procedure), ("trim", trim), ("springback", {}))
    outcome = run_case(case, tmp_path / "out")
    assert outcome.status == "completed", outcome.reason
    result = outcome.result
    released, formed = result.field("temperature", -1), result.field("temperature", 6)
    assert len(released) < len(formed)
    assert formed.min() - 1.0 <= released.min() <= released.max() <= formed.max() + 1.0
    assert result.field("hardness", -1).min() > 400
    strain = [result.field("equivalent_plastic_strain", step).max() for step in (6, -1)]
    assert strain[1] <= strain[0] * (1 + 1e-6)


@pytest.mark.validation
def test_a_hot_law_takes_temperature_and_rate_of_the_press(tmp_path) -> None:
    law = {
        "law": "norton_hoff",
        "K": 40,
        "m": 0.1,
        "n": 0.1,
        "e0": 0.01,
        "beta": 1500,
        "strain_window": [0, 1],
        "rate_window": [1e-4, 100],
        "temperature_window": [600, 1000],
    }
    changes = [("procedure", "implicit"), ("materials.steel.hardening", law), ("materials.steel.heating", None)]
    works = []
    for time in (0.5, 50.0):
        case = bent_strip(*changes, ("stages.1.process_time", time), ("heat.surroundings", None))
        for tool in case["tools"].values():
            tool.pop("heat", None)
        outcome = run_case(case, tmp_path / f"{time:g}")
        assert outcome.status == "completed", outcome.reason
        works.append(float(outcome.result.history["heat_plastic"][-1]))
    assert works[0] / works[1] == pytest.approx(100.0**0.1, rel=0.03)
