# SPDX-License-Identifier: Apache-2.0
"""A quarter of a hot billet between cold dies, as a case: what is compared with CalculiX."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from presswork.case.plane.schema import Case

RADIUS, HEIGHT, STROKE = 10.0, 15.0, 3.0
"""Of the billet, half of its height, and of the die [mm]."""
PLACES = {"middle": (0.0, 0.0), "side": (RADIUS, 0.0), "face": (0.0, HEIGHT), "rim": (RADIUS, HEIGHT)}
"""Where temperatures are compared, by their place at the start [mm]."""


def make_billet(
    cells: tuple[int, int],
    hardening: Mapping[str, Any],
    stages: Sequence[Mapping[str, Any]],
    largest: float,
    *,
    element: str = "quad4_fbar",
    heat: Mapping[str, Any] | None = None,
    heating: Mapping[str, Any] | None = None,
) -> Case:
    """Return the case. largest: increment, over the stage. heat, heating: more keys of these tables."""
    steel = {
        "young": "100 GPa",
        "poisson": 0.35,
        "density": "7800 kg/m^3",
        "hardening": dict(hardening),
        "thermal": {
            "conductivity": [[20, 53], [800, 27], [1300, 28]],
            "specific_heat": [[20, "440 J/(kg*K)"], [700, "800 J/(kg*K)"], [1300, "650 J/(kg*K)"]],
        },
    }
    return Case.model_validate(
        {
            "title": "hot billet",
            "analysis": "axisymmetric",
            "workpiece": {
                "material": "steel",
                "element": element,
                "mesh": {"size": [RADIUS, HEIGHT], "cells": cells},
            },
            "materials": {"steel": steel | ({"heating": dict(heating)} if heating else {})},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
            "tools": {
                "die": {
                    "profile": [[0, HEIGHT], [RADIUS, HEIGHT]],
                    "contact": "sticking",
                    "heat": {"temperature": 200, "conductance": "5 kW/(m^2*K)"},
                }
            },
            "heat": {
                "initial_temperature": 1200,
                "tolerance": 0.2,
                "surroundings": {"ambient": 20, "coefficient": "1 kW/(m^2*K)"},
                **(heat or {}),
            },
            "stages": list(stages),
            "solver": {"max_increment": largest},
        }
    )


def press(duration: float) -> dict[str, Any]:
    """Return the stage that upsets the billet in `duration` [s]."""
    return {"name": "upset", "duration": duration, "tools": {"die": {"stroke": STROKE, "direction": [0, -1]}}}
