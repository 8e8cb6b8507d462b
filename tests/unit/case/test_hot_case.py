# SPDX-License-Identifier: Apache-2.0
"""Hot laws in a case: what is refused and what is warned of, each with its key."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from presswork.case import Case, CaseError, ShellCase, build_model, read_case
from presswork.case.description import describe
from presswork.case.space.schema import SpaceCase
from presswork.law.elastic_plastic import make_plane_law

WINDOWS = {"strain_window": [0.02, 0.8], "rate_window": [0.1, 50], "temperature_window": [850, 1250]}
LAW = {"law": "hensel_spittel", "A": 1500, "m1": -0.0027, "m2": -0.13, "m3": 0.14, "m4": -0.05, **WINDOWS}
NORTON_HOFF = {"law": "norton_hoff", "K": 0.8, "n": 0.1, "m": 0.15, "beta": 6000, **WINDOWS}
SINH = {"law": "sinh_arrhenius", "A": 1e12, "alpha": 0.012, "n": 5, "Q": "312 kJ/mol", **WINDOWS}
JOHNSON_COOK = {
    "law": "johnson_cook", "A": 300, "B": 400, "n": 0.3, "C": 0.02, "reference_rate": 1, "m": 1, "melting": 1480,
    **WINDOWS,
}  # fmt: skip


def case(hardening: dict[str, Any], **changes: Any) -> dict[str, Any]:
    steel = {"young": "100 GPa", "poisson": 0.3, "hardening": hardening, "heating": {"start": 1100}}
    return {
        "title": "billet",
        "analysis": "axisymmetric",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 10], "cells": [2, 2]}},
        "materials": {"steel": {**steel, **changes}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "stages": [
            {"name": "press", "duration": 1.0, "displacement": [{"set": "top", "component": "y", "value": -1.0}]}
        ],
    }


def problems(data: dict[str, Any]) -> str:
    with pytest.raises(CaseError) as caught:
        build_model(Case.model_validate(data))
    return str(caught.value)


@pytest.mark.parametrize("hardening", [LAW, NORTON_HOFF, SINH, JOHNSON_COOK])
def test_a_hot_law_goes_into_the_model_by_its_names(hardening: dict[str, Any]) -> None:
    material = build_model(Case.model_validate(case(hardening))).materials[0]
    assert material.hardening is not None
    assert material.hardening.is_hot
    named = material.hardening.named()
    for key, value in hardening.items():
        if key in named and not isinstance(value, str):
            assert named[key] == value
    assert named.get("Q", 312e3) == 312e3
    assert material.hardening.window is not None
    assert material.hardening.window.tolist() == [[0.02, 0.8], [0.1, 50.0], [850.0, 1250.0]]


@pytest.mark.parametrize(
    ("change", "key", "told"),
    [
        ({"strain_window": [0.0, 0.8]}, "strain_window", "no value at a strain of zero"),
        ({"strain_window": [-0.1, 0.8]}, "strain_window", "a plastic strain is not negative"),
        ({"strain_window": [1e-3, 0.8]}, "strain_window", "next to nothing of the"),
        ({"rate_window": [0, 50]}, "rate_window", "the lowest rate is not above zero"),
        ({"rate_window": [50, 0.1]}, "rate_window", "50 is not below 0.1"),
        ({"temperature_window": [1250, 850]}, "temperature_window", "1250 is not below 850"),
        ({"temperature_window": [-50, 850], "m9": 0.1}, "temperature_window", "T^m9 has no value"),
        ({"m3": -0.14}, "hardening", "the flow stress falls from"),
        ({"m1": 0.0027}, "temperature_window", "its isotherms cross"),
        ({"m8": 0.002, "m3": -1.5, "m1": -0.003}, "temperature_window", "at strain 0.02 and 10.6 1/s"),
        ({"m1": 1 / 300, "m9": -4.0, "A": 3e12}, "temperature_window", "from 1200 to 1212 degrees C"),
        ({"A": "0 MPa"}, "A", "expected a value > 0"),
        ({"A": 1500e6}, "hardening", "flow stress at a plastic strain"),
        ({"m1": 2.7}, "hardening", "not > 0"),
    ],
)
def test_a_hensel_spittel_law_that_cannot_be_is_refused(change: dict[str, Any], key: str, told: str) -> None:
    text = problems(case({**LAW, **change}))
    assert key in text
    assert told in text


@pytest.mark.parametrize(
    ("hardening", "told"),
    [
        ({**NORTON_HOFF, "strain_window": [0, 1]}, "the law is zero at a strain of zero"),
        ({**SINH, "Q": 312}, "Q"),
        ({**SINH, "Q": "312 kJ"}, "an energy per mole"),
        ({**JOHNSON_COOK, "melting": 10}, "not above reference = 20"),
        ({**JOHNSON_COOK, "temperature_window": [20, 1480]}, "reaches the melting temperature"),
        ({**JOHNSON_COOK, "C": 0.5, "rate_window": [1e-3, 1]}, "not > 0"),
        ({k: v for k, v in LAW.items() if k != "rate_window"}, "rate_window"),
    ],
)
def test_other_hot_laws_that_cannot_be_are_refused(hardening: dict[str, Any], told: str) -> None:
    assert told in problems(case(hardening))


CSV = """# compression tests
temperature, strain, rate, stress
900, 0.1, 0.1, 100
900, 0.5, 0.1, 120
900, 0.1, 10, 160
900, 0.5, 10, 190
1200, 0.1, 0.1, 40
1200, 0.5, 0.1, 45
1200, 0.1, 10, 70
1200, 0.5, 10, 78
"""


def table_case(folder: Path, text: str) -> Path:
    (folder / "curves.csv").write_text(text, encoding="utf-8")
    data = case({"law": "hot_table", "file": "curves.csv"})
    (folder / "case.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    return folder / "case.toml"


def test_a_table_is_read_beside_the_case_and_is_linear_in_the_logarithm_of_the_rate(tmp_path: Path) -> None:
    model = build_model(read_case(table_case(tmp_path, CSV)))
    assert "hot_table up to strain 0.5, 0.1 to 10 1/s, 900 to 1200 degrees C" in describe(model)
    law = make_plane_law(model.materials[0])

    def flow(e: float, r: float, t: float) -> tuple[float, float]:
        stress, slope = law.flow_stress(np.array([e]), np.array([r]), np.array([t]))
        return float(stress[0]), float(slope[0])

    assert flow(0.1, 0.1, 900) == (100.0, pytest.approx(50.0))
    assert flow(0.5, 10, 1200)[0] == pytest.approx(78)
    corners = [100, 120, 160, 190, 40, 45, 70, 78]
    assert flow(0.3, 1.0, 1050) == (pytest.approx(sum(corners) / 8), pytest.approx((20 + 30 + 5 + 8) / 4 / 0.4))
    assert flow(0.2, 10**0.5, 900)[0] == pytest.approx(0.25 * 105 + 0.75 * 167.5)
    assert flow(0.0, 1e-3, 20) == (100.0, 0.0)
    assert flow(2.0, 1e3, 1300) == (pytest.approx(78), 0.0)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (CSV.replace("1200, 0.1, 0.1, 40", "1200, 0.1, 0.1, 101"), "the flow stress rises with temperature, from 100"),
        (CSV.replace("900, 0.1, 10, 160", "900, 0.1, 10, 90"), "the flow stress falls as the rate rises"),
        (CSV + "900, 0.1, 10, 160\n", "line 11: the same strain, rate and temperature as in line 5"),
        (CSV.replace("1200, 0.5, 10, 78\n", ""), "1 of 8 combinations are missing, the first at strain 0.5, rate 10"),
        (CSV.replace("900, 0.5, 10, 190", "900, 0.5, 10, high"), "line 6: 900, 0.5, 10, high"),
        (CSV.replace("900, 0.5, 10, 190", "900, 0.5, 0, 190"), "line 6: rate = 0"),
        (CSV.replace("900, 0.5, 10, 190", "900, 0.5, 10, -190"), "line 6: stress = -190"),
        (CSV.replace("stress", "sigma"), "its first line is temperature, strain, rate, sigma"),
        ("", "an empty file"),
    ],
)
def test_a_table_that_cannot_be_is_refused_by_its_line(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(CaseError) as caught:
        build_model(read_case(table_case(tmp_path, text)))
    assert "materials.steel.hardening" in str(caught.value)
    assert told in str(caught.value)


def test_a_table_that_is_not_there_is_refused(tmp_path: Path) -> None:
    path = table_case(tmp_path, CSV)
    (tmp_path / "curves.csv").unlink()
    with pytest.raises(CaseError, match="no such file"):
        read_case(path)


@pytest.mark.parametrize(("start", "warned"), [(1100, False), (20, True), (1373, True)])
def test_a_start_outside_the_window_of_the_law_is_warned_of(
    caplog: pytest.LogCaptureFixture, start: float, warned: bool
) -> None:
    build_model(Case.model_validate(case(LAW, heating={"start": start})))
    assert ("its law was fitted from 850 to 1250" in caplog.text) == warned


@pytest.mark.parametrize(("die", "warned"), [(200, False), ("1500 °C", True)])
def test_a_die_hotter_than_the_workpiece_is_warned_of(
    caplog: pytest.LogCaptureFixture, die: float | str, warned: bool
) -> None:
    data = case(LAW, density="7850 kg/m^3", thermal={"conductivity": 28, "specific_heat": "650 J/(kg*K)"})
    del data["materials"]["steel"]["heating"]
    data["heat"] = {"initial_temperature": 1100}
    data["tools"] = {
        "die": {"profile": [[0, 10], [30, 10]], "contact": "frictionless",
                "heat": {"temperature": die, "conductance": "5 kW/(m^2*K)"}}
    }  # fmt: skip
    data["stages"] = [{"name": "press", "duration": 1.0, "tools": {"die": {"stroke": 1.0, "direction": [0, -1]}}}]
    build_model(Case.model_validate(data))
    assert ("tools.die.heat.temperature: at 1500" in caplog.text) == warned


def test_a_law_that_softens_by_itself_takes_no_other_softening() -> None:
    text = problems(case(LAW, heating={"start": 1100, "melting": 1480, "exponent": 1}))
    assert "materials.steel.heating.melting" in text
    assert "soften twice" in text


def test_a_law_that_depends_on_the_rate_takes_no_other_factor_of_rate() -> None:
    text = problems(case(LAW, rate={"law": "cowper_symonds", "D": 40, "q": 5}))
    assert "materials.steel.rate" in text
    assert "twice" in text


def test_a_cold_law_still_needs_melting_and_exponent() -> None:
    text = problems(case({"law": "linear", "yield_stress": 300}, heating={"start": 100}))
    assert "heating.melting" in text


def test_a_hot_law_without_a_temperature_is_refused() -> None:
    text = problems(case(LAW, heating=None))
    assert "materials.steel.heating.start" in text
    assert "hensel_spittel depends on temperature" in text


@pytest.mark.parametrize(
    "changes",
    [{}, {"hardening": {"law": "linear", "yield_stress": 300}, "rate": {"law": "cowper_symonds", "D": 40, "q": 5}}],
)
def test_a_law_of_rate_without_time_is_refused(changes: dict[str, Any]) -> None:
    data = case(**({"hardening": LAW} | changes))
    if changes:
        del data["materials"]["steel"]["heating"]
    del data["stages"][0]["duration"]
    text = problems(data)
    assert "stages.0.duration" in text
    assert "nothing times the stage" in text


def test_a_law_of_rate_without_time_is_refused_in_space_and_in_shells() -> None:
    data = case(LAW)
    stage = {"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 0.1}]}
    space = copy.deepcopy(data) | {
        "analysis": "solid",
        "workpiece": {"material": "steel", "element": "hex8_fbar", "mesh": {"size": [1, 1, 1], "cells": [1, 1, 1]}},
        "boundary": {"end": {"set": "left", "fix": ["x", "y", "z"]}},
        "stages": [stage],
    }
    shell = copy.deepcopy(data) | {
        "analysis": "shell",
        "workpiece": {
            "material": "steel", "element": "shell4_mitc", "section": {"thickness": 1},
            "mesh": {"size": [5, 5], "cells": [1, 1]},
        },
        "boundary": {"end": {"set": "left", "hold": "clamped"}},
        "stages": [stage],
    }  # fmt: skip
    for kind, own in ((SpaceCase, space), (ShellCase, shell)):
        with pytest.raises(CaseError, match="nothing times the stage"):
            build_model(kind.model_validate(own))
