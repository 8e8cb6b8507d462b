# SPDX-License-Identifier: Apache-2.0
"""A die that is drawn where it closes, through the workpiece, is placed where its cavity touches the workpiece."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import build_model
from tests.unit.case.test_resistance import AXIS, QUARTER, plane_case, space_case
from tests.unit.case.test_space_tool_shapes import write_stl


@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("up", [1.0, -1.0])
def test_a_die_drawn_closed_is_placed_in_touch(up: float, turned: bool, analysis: str) -> None:
    """A billet of 20 mm between y = -5 and 15 stands in one cavity of depth 5 mm; the other one moves on it."""
    cavity = [[-1, 5 * up], [6, 5 * up], [6.5, up], [30, up]]
    other = [[-1, -5 * up], [6, -5 * up], [6.5, -up], [30, -up]]
    moving = {"profile": cavity[::-1] if turned else cavity, "contact": "sticking", "position": "touch"}
    mesh = {"size": [5, 20], "cells": [2, 8], "origin": [0, -5 if up > 0 else -15]}
    model = build_model(
        plane_case(
            {"moving": moving, "standing": {"profile": other, "contact": "sticking"}},
            AXIS,
            {"moving": {"stroke": 10, "direction": [0, -up]}},
            analysis=analysis,
            workpiece={"material": "steel", "mesh": mesh},
            limits={"stop": False},
        )
    )
    assert model.tools[0].position[:2] == pytest.approx((0.0, 10.0 * up), abs=1e-6)


def draw_out(line: list[list[float]], turned: bool) -> np.ndarray:
    """The facets (n, 3, 3) of a line in x and z that goes on along y."""
    facets = []
    for (x0, z0), (x1, z1) in itertools.pairwise(line):
        a, b, c, d = (x0, -60, z0), (x1, -60, z1), (x1, 60, z1), (x0, 60, z0)
        facets += [[a, b, c], [a, c, d]]
    return np.array(facets)[:, ::-1] if turned else np.array(facets)


@pytest.mark.parametrize("drawn_at", [0.0, -25.0, 40.0])
@pytest.mark.parametrize("shape", ["round", "straight", "file"])
@pytest.mark.parametrize("seed", range(2))
def test_a_die_in_space_is_placed_in_touch_wherever_it_is_drawn(
    seed: int, shape: str, drawn_at: float, tmp_path: Path
) -> None:
    """A billet stands on the floor of one cavity, in two steps; the floor of the other one comes onto it."""
    rng = np.random.default_rng(seed)
    up = float(rng.choice([1.0, -1.0]))
    half, depth, height = float(rng.uniform(3, 5)), float(rng.uniform(4, 8)), float(rng.uniform(20, 40))
    cavity = [[0, depth], [half + 0.5, depth], [half + 1, 0.5 * depth], [9, 0.5 * depth], [9.5, 1], [14, 1]]
    upper, lower = ([[float(r), side * z] for r, z in cavity] for side in (up, -up))
    if shape != "round":
        upper, lower = ([[-r, z] for r, z in line[:0:-1]] + line for line in (upper, lower))
    upper = [[r, z + drawn_at] for r, z in upper[:: int(rng.choice([1, -1]))]]
    moving: dict[str, Any] = {"shape": shape, "profile": upper}
    if shape == "file":
        write_stl(tmp_path / "die.stl", draw_out(upper, bool(rng.integers(2))))
        moving = {"shape": "file", "path": str(tmp_path / "die.stl")}
    low = -depth if up > 0 else depth - height
    mesh = {"size": [half, half, height], "cells": [2, 2, 4], "origin": [0, 0, low]}
    boundary: dict[str, Any] = QUARTER
    if shape == "round":
        mesh = {"kind": "cylinder", "radius": half, "height": height, "angle": 90, "cells": [2, 2, 4]}
        mesh["origin"] = [0, 0, low]
        boundary = {name: {"set": f"{name}_plane", "fix": ["normal"]} for name in ("first", "last")}
    tools = {
        "moving": moving | {"contact": "sticking", "position": "touch"},
        "standing": {"shape": "round" if shape == "round" else "straight", "profile": lower, "contact": "sticking"},
    }
    stroke = {"moving": {"stroke": 1, "direction": [0, 0, -up]}}
    model = build_model(space_case(mesh, tools, boundary, stroke, limits={"stop": False}))
    assert model.tools[0].position == pytest.approx((0.0, 0.0, up * (height - 2 * depth) - drawn_at), abs=1e-6)
