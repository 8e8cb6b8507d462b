# SPDX-License-Identifier: Apache-2.0
"""Wear of tools against Archard's law by hand: a block that slides on a flat die."""

import csv
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.model import ToolWear
from presswork.observe.wear import find_hardness, pass_over
from presswork.post.verdict import judge_result
from presswork.recorder import run_model
from presswork.results import Result
from tests.regression.whole_runs import run_in_two_parts

K, HV, LENGTH, SLID = 1e-4, 500 * 9.80665, 20.0, 45.0
"""Archard's coefficient; hardness [MPa]; length of the block and its path [mm]."""


def hold(name: str, components: str, **moves: float) -> list[dict[str, Any]]:
    """Return displacements of a set, zero unless given."""
    return [{"set": name, "component": c, "value": moves.get(c, 0)} for c in components]


PLANE: dict[str, Any] = {
    "title": "block",
    "analysis": "plane_strain",
    "workpiece": {"mesh": {"size": [LENGTH, 10], "cells": [10, 4]}, "material": "steel"},
    "materials": {"steel": {"young": 210000, "poisson": 0.3}},
    "tools": {
        "die": {
            "profile": [[90, 0], [-10, 0]],
            "contact": "coulomb",
            "mu": 0.1,
            "wear": {"coefficient": K, "hardness": "500 HV", "parts": 1000, "limit": 0.05},
        }
    },
    "stages": [
        {"name": "press", "displacement": hold("top", "xy", y=-0.01)},
        {"name": "slide", "displacement": hold("top", "xy", x=SLID)},
    ],
    "solver": {"initial_increment": 0.1, "max_increment": 0.1},
    "output": {"steps": 2},
}
SPACE: dict[str, Any] = {
    "title": "block",
    "analysis": "solid",
    "workpiece": {"mesh": {"kind": "box", "size": [8, 8, 4], "cells": [4, 4, 2]}, "material": "steel"},
    "materials": {"steel": {"young": 210000, "poisson": 0.3}},
    "tools": {"die": {"shape": "plane", "normal": [0, 0, 1], "contact": "coulomb", "mu": 0.1}},
    "stages": [
        {"name": "press", "displacement": hold("front", "xyz", z=-0.01)},
        {"name": "slide", "displacement": hold("front", "xyz", x=20)},
    ],
    "solver": {"initial_increment": 0.1, "max_increment": 0.1},
    "output": {"steps": 2},
}

UPSET: dict[str, Any] = {
    "title": "upset",
    "analysis": "axisymmetric",
    "workpiece": {"mesh": {"size": [10, 10], "cells": [6, 6]}, "material": "steel"},
    "materials": {
        "steel": {
            "young": 210000,
            "poisson": 0.3,
            "density": "7850 kg/m^3",
            "hardening": {"law": "swift", "K": 700, "e0": 0.01, "n": 0.2},
        }
    },
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "tools": {"die": {"profile": [[0, 10], [30, 10]], "contact": "coulomb", "mu": 0.1}},
    "stages": [{"name": "press", "tools": {"die": {"stroke": 3, "direction": [0, -1]}}}],
    "output": {"steps": 2},
}


def run(folder: Path, data: dict[str, Any], **wear: Any) -> tuple[dict[str, Any], Any, float]:
    """Return the summary of the wear, its table, and the force on the die while the block slides [N]."""
    data = deepcopy(data)
    data["tools"]["die"]["wear"] = data["tools"]["die"].get("wear", {"coefficient": K, "hardness": HV}) | wear
    kind = SpaceCase if data["analysis"] == "solid" else Case
    run_model(build_model(kind.model_validate(data)), folder / "out", threads=1)
    result = Result(folder / "out")
    axis = "y" if kind is Case else "z"
    force = abs(float(result.history[f"die.force_{axis}"][-1]))
    table = np.genfromtxt(folder / "out" / "wear_die.csv", delimiter=",", names=True)
    return result.summary["wear"]["die"], table, force


def test_a_place_that_a_block_passes_over_wears_by_its_force_over_the_hardness(tmp_path: Path) -> None:
    found, table, force = run(tmp_path, PLANE)
    passed = (table["x"] > LENGTH + 2.0) & (table["x"] < SLID - 2.0)  # by the whole block: the integral of p is F
    assert table["depth_per_part"][passed].mean() == pytest.approx(K * force / HV, rel=0.01)
    assert table["depth_per_part"][passed] == pytest.approx(K * force / HV, rel=0.05)  # edges pass in moves
    volume = np.trapezoid(table["depth_per_part"], -table["x"] if table["x"][0] > table["x"][-1] else table["x"])
    assert volume == pytest.approx(K * force * SLID / HV, rel=0.02)
    assert table["depth"] == pytest.approx(1000 * table["depth_per_part"], rel=1e-6)
    assert table["worn_y"] == pytest.approx(-table["depth"], rel=1e-6)  # into the metal of the die
    assert found["parts_until_limit"] == int(0.05 / (1e-3 * found["deepest_um_per_part"]))
    assert not table["depth"][table["x"] > LENGTH + SLID + 2.0].any()
    worn = next(line for line in judge_result(Result(tmp_path / "out")).lines if line.name == "wear of die")
    assert worn.state == "fail", "0.1 mm after 1,000 parts, and 0.05 mm are allowed"


def test_powers_of_pressure_and_hardness_count(tmp_path: Path) -> None:
    flat = deepcopy(PLANE)
    flat["materials"]["steel"]["poisson"] = 0.0  # so that the pressure is the same everywhere
    flat["tools"]["die"]["contact"] = "frictionless"
    del flat["tools"]["die"]["mu"]
    _, table, force = run(tmp_path, flat, pressure_power=2, hardness_power=0.5, coefficient=1e-9)
    passed = (table["x"] > LENGTH + 2.0) & (table["x"] < SLID - 2.0)
    pressure = force / LENGTH
    assert pressure == pytest.approx(210000 * 0.01 / 10, rel=0.01)
    assert table["depth_per_part"][passed].mean() == pytest.approx(1e-9 * pressure**2 * LENGTH / HV**0.5, rel=0.01)


def test_a_block_in_space_wears_off_what_force_and_path_say(tmp_path: Path) -> None:
    _, table, force = run(tmp_path, SPACE)
    area = (np.ptp(table["x"]) * np.ptp(table["y"])) / (0.5 * len(table["x"]))  # two triangles a square
    volume = 0.5 * area * table["depth_per_part"].sum()
    assert volume == pytest.approx(K * force * 20.0 / HV, rel=0.05)


def test_explicit_and_implicit_runs_wear_alike(tmp_path: Path) -> None:
    quick = deepcopy(UPSET) | {"procedure": "explicit"}
    quick["workpiece"]["element"] = "quad4_1pt"
    quick["stages"][0]["duration"] = 3e-3
    depth = []
    for name, case in (("implicit", UPSET), ("explicit", quick)):
        (tmp_path / name).mkdir()
        table = run(tmp_path / name, case)[1]
        depth.append(np.interp([3.0, 5.0, 7.0], table["x"][::-1], table["depth_per_part"][::-1]))
    assert depth[1] == pytest.approx(depth[0], rel=0.05)


def test_a_stopped_run_goes_on_with_the_wear_so_far(tmp_path: Path) -> None:
    data = deepcopy(PLANE) | {"output": {"steps": 2, "checkpoint_every": 1}}
    model = build_model(Case.model_validate(data))
    run_model(model, tmp_path / "whole", threads=1)
    run_in_two_parts(model, tmp_path / "parts", 13)
    assert (tmp_path / "parts" / "wear_die.csv").read_text() == (tmp_path / "whole" / "wear_die.csv").read_text()


def test_the_hardness_follows_its_table_and_stays_beyond_its_ends() -> None:
    wear = ToolWear(coefficient=1.0, hardness=((20.0, 5000.0), (600.0, 2000.0)))
    assert find_hardness(wear, np.array([0.0, 310.0, 900.0])) == pytest.approx([5000.0, 3500.0, 2000.0])


def test_places_beside_a_surface_take_nothing() -> None:
    nodes = np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]])
    on, value = pass_over(np.array([[1.0, 0.01], [3.5, 0.0], [5.0, 0.0]]), nodes, np.array([1.0, 3.0, 7.0]),
                          np.array([[0, 1], [1, 2]]), 0.1)  # fmt: skip
    assert on.tolist() == [True, True, False]
    assert value[:2] == pytest.approx([2.0, 6.0])


@pytest.mark.parametrize(
    ("wear", "tool", "stage", "said"),
    [
        ({"hardness": [[20, "500 HV"], [500, "300 HV"]]}, {}, {}, "tools.die.wear.hardness: hardness by temperature"),
        ({"hardness": 52}, {}, {}, 'is the hardness of no tool; plain numbers are MPa; write for instance "560 HV"'),
        ({"coefficient": 3}, {}, {}, "wears a die out in a part"),
        ({}, {"centre": [0, 0]}, {"tools": {"die": {"turn": 10}}}, "the wear of tools that turn is not followed"),
    ],
)
def test_wear_that_means_nothing_is_refused(
    wear: dict[str, Any], tool: dict[str, Any], stage: dict[str, Any], said: str
) -> None:
    data = deepcopy(PLANE)
    data["tools"]["die"] |= tool
    data["tools"]["die"]["wear"] |= wear
    data["stages"][1] |= stage
    with pytest.raises(CaseError) as error:
        build_model(Case.model_validate(data))
    assert said in str(error.value), error.value


def test_the_history_has_the_deepest_wear(tmp_path: Path) -> None:
    found, _, _ = run(tmp_path, PLANE)
    with (tmp_path / "out" / "history.csv").open() as file:
        rows = list(csv.DictReader(file))
    depths = [float(row["die.wear"]) for row in rows]
    assert depths[-1] == pytest.approx(1e-3 * found["deepest_um_per_part"], rel=1e-6)
    assert depths == sorted(depths)
