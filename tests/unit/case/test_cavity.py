# SPDX-License-Identifier: Apache-2.0
"""Tools of solids that leave the workpiece no room are refused, with the stroke at which they close."""

from __future__ import annotations

import re
from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import label

from presswork import Case
from presswork.case import CaseError, build_model, read_case
from presswork.case.tools.cavity import _flood
from presswork.examples import copy_example, list_examples

# A billet of radius 8 and height 10 mm, 2011 mm3, in a closed die of radius 10 mm: it fills it at a height of 6.4 mm.
CLOSED_DIE: dict[str, Any] = {
    "title": "closed die",
    "analysis": "axisymmetric",
    "workpiece": {"material": "steel", "element": "quad4_fbar",
                  "mesh": {"kind": "rectangle", "origin": [0, 0], "size": [8, 10], "cells": [4, 5], "pattern": "quad"}},
    "materials": {"steel": {"young": 210e3, "poisson": 0.3,
                            "hardening": {"law": "linear", "yield_stress": 300, "modulus": 10}}},
    "tools": {
        "die": {"profile": [[0, 0], [10, 0], [10, 30]], "contact": "frictionless"},
        "punch": {"profile": [[0, 10], [12, 10]], "contact": "frictionless"},
    },
    "boundary": {"axis": {"set": "left", "fix": ["x"]}},
    "stages": [{"name": "press", "tools": {"punch": {"stroke": 3.0, "direction": [0, -1]}}}],
}  # fmt: skip


def changed(**changes: Any) -> Case:
    data = deepcopy(CLOSED_DIE)
    for path, value in changes.items():
        at: Any = data
        *keys, last = path.split("__")
        for key in keys:
            at = at[int(key)] if key.isdigit() else at[key]
        at[last] = value
    return Case.model_validate(data)


def stroke(value: float) -> dict[str, Any]:
    return {"stages__0__tools__punch__stroke": value}


def refusal(case: Case) -> str:
    with pytest.raises(CaseError) as error:
        build_model(case)
    return str(error.value)


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_die_closed_beyond_the_volume_of_the_billet_is_refused(procedure) -> None:
    """The billet fills it after 3.6 mm; the grid's cell is 0.125 mm, and tools are taken smaller by most of one."""
    more: dict[str, Any] = {} if procedure == "implicit" else {
        "procedure": "explicit", "materials__steel__density": 7.85e-9, "workpiece__element": "quad4_1pt",
        "stages__0__duration": 1e-3,
    }  # fmt: skip
    build_model(changed(**stroke(3.5), **more))
    said = refusal(changed(**stroke(4.5), **more))
    assert "stages.0.tools.punch: after about" in said
    closes = float(re.search(r"after about ([\d.]+) of its 4.5 mm", said)[1])  # type: ignore[index]
    assert 3.6 <= closes <= 4.0
    part = float(re.search(r"room for ([\d.]+) %", said)[1])  # type: ignore[index]
    assert part == pytest.approx(100 * (5.5 * 100) / (10 * 64), abs=5.0)
    assert "limits.stop" in said


@pytest.mark.parametrize("height", [1e-7, 0.03])
def test_a_workpiece_thinner_than_a_cell_of_the_grid_is_left_to_the_run(height) -> None:
    """The grid's cell is 0.1 mm: it sees no cell of the sheet, or has no row of cells at all."""
    thin = {"size": [8, height], "cells": [4, 1], "kind": "rectangle"}
    punch = {"profile": [[0, height], [12, height]], "contact": "frictionless"}
    model = build_model(changed(**stroke(0.4 * height), workpiece__mesh=thin, tools__punch=punch))
    assert len(model.mesh.points) == 10


def test_tools_that_cross_are_refused_where_the_die_is_open() -> None:
    """Without its wall the die lets any volume out, until the punch goes through it."""
    flat = {"profile": [[0, 0], [30, 0]], "contact": "frictionless"}
    wide = {"profile": [[0, 10], [30, 10]], "contact": "frictionless"}
    build_model(changed(**stroke(9.0), tools__die=flat, tools__punch=wide))
    said = refusal(changed(**stroke(11.0), tools__die=flat, tools__punch=wide))
    assert "they leave no room" in said or "room for 0" in said
    assert 9.5 <= float(re.search(r"after about ([\d.]+) of its 11 mm", said)[1]) <= 10.5  # type: ignore[index]


def test_a_narrow_way_out_is_enough() -> None:
    """A flash gap of 0.5 mm, four cells of the grid, and one of 0.05 mm, which the grid does not see but counts."""
    for gap in (0.5, 0.05):
        low = {"profile": [[0, 0], [10, 0], [10, 5 - gap], [20, 5 - gap]], "contact": "frictionless"}
        high = {"profile": [[0, 10], [10, 10], [10.001, 9.4], [20, 9.4]], "contact": "frictionless"}
        build_model(changed(**stroke(4.4), tools__die=low, tools__punch=high))


def test_tools_whose_way_is_not_known_are_left_out() -> None:
    build_model(changed(**stroke(4.5), tools__die__spring={"stiffness": 1000, "direction": [0, -1]}))
    push = {"force": 1e5, "direction": [0, -1]}
    build_model(changed(stages__0__tools__punch=push))


def test_limits_that_do_not_stop_let_it_run_with_a_warning(caplog) -> None:
    build_model(changed(**stroke(4.5), limits={"stop": False}))
    assert "the tools close on the workpiece" in caplog.text


@pytest.mark.parametrize("name", list_examples())
def test_no_example_is_refused(name, tmp_path) -> None:
    build_model(read_case(copy_example(name, tmp_path)))


def test_flood_reaches_what_connected_components_join() -> None:
    rng = np.random.default_rng(1)
    for free_share in np.linspace(0.4, 0.9, 60):
        free = rng.random(rng.integers(1, 60, 2)) < free_share
        start = free & (rng.random(free.shape) < 0.01)
        regions, _ = label(free)
        np.testing.assert_array_equal(_flood(free, start), np.isin(regions, np.unique(regions[start])))
