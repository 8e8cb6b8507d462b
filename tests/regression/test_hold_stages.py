# SPDX-License-Identifier: Apache-2.0
"""Stages in which nothing moves and time passes, in the plane, in space and of shells."""

from __future__ import annotations

from typing import Any

import pytest

from presswork import build_model
from presswork.case import Case
from presswork.case.space.schema import SpaceCase
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure

HOT: dict[str, Any] = {
    "young": 100000.0,
    "poisson": 0.3,
    "heating": {"start": 1000.0},
    "hardening": {
        "law": "norton_hoff",
        "K": 200.0,
        "m": 0.2,
        "strain_window": [0.0, 5.0],
        "rate_window": [1e-9, 1000.0],
        "temperature_window": [900.0, 1100.0],
    },
}
STAGES = [
    {"name": "draw", "duration": 0.02, "displacement": [{"set": "top", "component": "y", "value": 0.01}]},
    {"name": "hold", "duration": 100.0, "displacement": [{"set": "top", "component": "y", "value": 0.0}]},
]


def bar(analysis: str) -> dict[str, Any]:
    """A bar of one cell that is drawn by 1 % and held."""
    space = analysis == "solid"
    held = {"across": ("left", "x"), "middle": ("bottom", "y")} | ({"back": ("back", "z")} if space else {})
    return {
        "title": "a bar that relaxes",
        "analysis": analysis,
        "workpiece": {
            "material": "hot",
            "mesh": {"size": [1.0] * (2 + space), "cells": [1] * (2 + space)},
        },
        "materials": {"hot": HOT},
        "boundary": {name: {"set": node_set, "fix": [axis]} for name, (node_set, axis) in held.items()},
        "stages": STAGES,
        "solver": {"max_increment": 0.01},
    }


@pytest.mark.parametrize(("kind", "analysis", "area"), [(Case, "axisymmetric", 3.14159), (SpaceCase, "solid", 1.0)])
def test_a_bar_that_is_held_relaxes_by_norton_s_law(kind: Any, analysis: str, area: float) -> None:
    """Plastic rate (s / K)^n, n = 1 / m, takes the elastic strain up: ds/dt = -E (s / K)^n, from K when it begins."""
    procedure = ImplicitProcedure(build_model(kind.model_validate(bar(analysis))), threads=1)
    for _ in procedure.advance():
        pass
    top, n = procedure.model.mesh.node_sets["top"], 1.0 / 0.2
    stress = float(procedure.state.nodes.reaction[top, 1].sum()) / (0.99 * area)  # drawn by 1 % at constant volume
    start = 200.0 * 0.5**0.2
    relaxed = (start ** (1.0 - n) + (n - 1.0) * 1e5 / 200.0**n * 100.0) ** (1.0 / (1.0 - n))
    assert procedure.state[Progress].time == pytest.approx(100.02)
    assert stress == pytest.approx(relaxed, rel=0.025)
