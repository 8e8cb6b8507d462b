# SPDX-License-Identifier: Apache-2.0
"""Data of cases: a body of random size is upset between two rough plates by explicit dynamics, and let go."""

from __future__ import annotations

from typing import Any

import numpy as np


def upset_at_random(analysis: str, rng: np.random.Generator, **given: Any) -> dict[str, Any]:
    """Return the data of a case of "axisymmetric", "plane_strain" or "solid".

    given: size (2,), cells (2,), press and mu, in place of what is drawn.
    """
    height = float(rng.uniform(6.0, 14.0))
    drawn = {
        "size": (float(rng.uniform(5.0, 10.0)), height),
        "cells": (int(rng.integers(4, 9)), int(rng.integers(4, 10))),
        "press": height * float(rng.uniform(0.05, 0.2)),
        "mu": float(rng.uniform(0.02, 0.15)),
    } | given
    hardening = {"law": "swift", "K": float(rng.uniform(400.0, 1000.0)), "e0": 0.01, "n": float(rng.uniform(0.1, 0.3))}
    steel = {"young": 210e3, "poisson": 0.3, "density": "7850 kg/m^3", "hardening": hardening}
    rows, duration = int(rng.integers(60, 200)), float(rng.uniform(2e-4, 5e-4))
    data: dict[str, Any] = {"title": "upset and let go", "analysis": analysis, "procedure": "explicit"}
    data |= {"materials": {"steel": steel}}
    if analysis == "solid":
        rows, duration = rows // 2, 0.5 * duration
    data |= _shape(analysis, drawn)
    ways = {"press": -drawn["press"], "lift": drawn["press"]}
    along = [0.0] * (2 if analysis == "solid" else 1)
    data["stages"] = [
        {"name": name, "duration": duration, "tools": {"punch": {"move": [*along, way]}}} for name, way in ways.items()
    ]
    return data | {"output": {"rows": rows, "steps": 1}}


def _shape(analysis: str, drawn: dict[str, Any]) -> dict[str, Any]:
    """Return workpiece, tools and what holds the body."""
    (width, height), (across, up), rough = drawn["size"], drawn["cells"], {"contact": "coulomb", "mu": drawn["mu"]}
    if analysis == "solid":
        mesh = {"size": [width, 0.8 * width, height], "cells": [min(across, 5), 4, min(up, 5)]}
        plane = {"shape": "plane", **rough}
        return {
            "workpiece": {"material": "steel", "element": "hex8_1pt", "mesh": mesh},
            "tools": {
                "punch": {**plane, "normal": [0, 0, -1], "position": [0, 0, height]},
                "anvil": {**plane, "normal": [0, 0, 1], "position": [0, 0, 0]},
            },
        }
    left = 0.0 if analysis == "axisymmetric" else -60.0
    return {
        "workpiece": {
            "material": "steel",
            "element": "quad4_1pt",
            "mesh": {"size": [width, height], "cells": [across, up]},
        },
        "tools": {
            "punch": {"profile": [[left, height], [60.0, height]], **rough},
            "anvil": {"profile": [[60.0, 0.0], [left, 0.0]], **rough},
        },
        "boundary": {"axis": {"set": "left", "fix": ["x"]}} if analysis == "axisymmetric" else {},
    }
