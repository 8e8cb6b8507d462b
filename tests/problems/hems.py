# SPDX-License-Identifier: Apache-2.0
"""Cases of a rim that is flanged and hemmed, onto the panel itself or round an inner panel."""

from __future__ import annotations

from typing import Any

from presswork.study.vary import format_override

SHEET, INNER = 1.0, 0.8
ROOM = 2.04
"""That the steel leaves to both layers [mm]: 2 % more than their thickness."""
SIDES = {"top": {"set": "top", "hold": "symmetry_y"}, "bottom": {"set": "bottom", "hold": "symmetry_y"}}


def block(kind: str, x0: float, x1: float, z0: float, z1: float, **more: Any) -> dict[str, Any]:
    """A tool of a rectangular section."""
    return {"kind": kind, "shape": "section", "corners": [[x0, z0], [x1, z0], [x1, z1], [x0, z1]], **more}


def hem_line(inner: float) -> dict[str, Any]:
    """Half of a strip of 40 x 2 mm, flanged at 12 mm, bent in to 45 degrees, pressed flat; inner: 0 is none."""
    flange = {
        "name": "flange",
        "tools": {
            "anvil": block("die", 0, 11, 0, -5, radius=[0, 1, 0, 0]),
            "punch": block("punch", 0, 12, 0, 10, radius=[0, 1, 0, 0]),
            "die": block("die", 13.05, 25, 0, -10, radius=[2, 0, 0, 0]),
        },
        "boundary": SIDES,
        "stages": [{"name": "up", "tools": {"die": {"stroke": 9}}, "velocity": "3 m/s"}],
    }
    hem = {
        "name": "hem",
        "tools": {
            "anvil": block("die", 0, 20, 0, -5, position=[0, 0, -0.5 * SHEET]),
            "prehem": {
                "kind": "punch", "shape": "section", "corners": [[16.5, 3], [22, 8.5], [15, 15.5], [9.5, 10]],
                "radius": [1, 0, 0, 1], "direction": [-1, 0, -1], "position": [0, 0, 2.6],
            },
            "steel": block("punch", 0, 18, 0, 8, radius=[0, 1, 0, 0], position=[0, 0, 9.0]),
        },
        "boundary": SIDES,
        "stages": [
            {"name": "prehem", "tools": {"prehem": {"stroke": 6}}, "velocity": "3 m/s"},
            {"name": "press", "tools": {"prehem": {"stroke": -6}, "steel": {"close": ROOM + inner}},
             "duration": "3 ms"},
        ],
        "hem": {"outward": [1, 0]},
    }  # fmt: skip
    if inner:
        plate = block("holder", 0, 10.5, 0, inner, radius=[0, 0.2, 0.2, 0], position=[0, 0, 0.5 * SHEET])
        hem["tools"]["inner"] = plate
    return {
        "title": "hem",
        "analysis": "stamping",
        "blank": {
            "shape": "rectangle", "size": [40, 2], "thickness": SHEET, "element_size": [0.5, 1.0],
            "material": "steel", "symmetry": ["x"],
        },
        "materials": {"steel": {
            "young": 206e3, "poisson": 0.3, "density": "7850 kg/m^3",
            "hardening": {"law": "swift", "K": 560, "e0": 0.007, "n": 0.25},
        }},
        "self_contact": {"mu": 0.1},
        "explicit": {"target_step": "0.18 us"},
        "operations": [flange, hem],
        "output": {"steps": 2, "rows": 30, "checkpoint_every": 10},
    }  # fmt: skip


def describe_fast_hem() -> str:
    """Return the text of the hem onto the panel itself in a seventh of the cycles: inertia shapes it, too."""
    data = hem_line(0.0)
    flange, hem = data["operations"]
    flange["stages"][0]["velocity"] = hem["stages"][0]["velocity"] = "10 m/s"
    hem["stages"][1]["duration"] = "1 ms"
    data["output"]["rows"] = 16
    return "".join(f"{format_override(key, value)}\n" for key, value in data.items())
