# SPDX-License-Identifier: Apache-2.0
"""A flat strip of hot steel between a holder and a die, and one that is bent."""

from __future__ import annotations

from typing import Any

from tests.unit.case.round_cup import changed

STRIP: dict[str, Any] = {
    "title": "hot strip",
    "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [40, 4], "thickness": 1.5, "element_size": 2, "points": 3,
              "material": "steel", "symmetry": ["x"]},
    "materials": {"steel": {
        "young": "150 GPa", "poisson": 0.3, "density": "7830 kg/m^3",
        "hardening": {"law": "linear", "yield_stress": 200, "modulus": 500},
        "heating": {"reference": 650, "melting": 1480, "exponent": 1},
        "thermal": {"conductivity": 25, "specific_heat": "650 J/(kg*K)"},
        "transformation": {"steel": "22MnB5"},
    }},
    "heat": {"initial_temperature": 950, "surroundings": {"ambient": 25, "emissivity": 0.8}},
    "boundary": {"slice": {"set": "all", "fix": ["y", "rx", "rz"]}},
    "tools": {
        "holder": {"kind": "holder", "shape": "strip", "width": 4, "edge_radius": 0,
                   "heat": {"temperature": 75, "conductance": "2000 W/(m^2*K)"}},
        "die": {"kind": "die", "shape": "strip", "width": 4, "edge_radius": 0.5,
                "heat": {"temperature": 75, "conductance": "2000 W/(m^2*K)", "gap": 0.1}},
    },
    "stages": [
        {"name": "transfer", "dwell": {"duration": 2}},
        {"name": "form", "process_time": 0.5, "duration": 0.005, "tools": {"holder": {"force": 1600}}},
        {"name": "quench", "dwell": {"duration": 4, "place": "tools", "pressure": 10}},
    ],
    "output": {"steps": 2, "rows": 20, "checkpoint_every": 5},
}  # fmt: skip

BEND = (
    ("blank.size", [16, 4]),
    ("tools.punch", {"kind": "punch", "shape": "strip", "width": 12, "edge_radius": 2,
                     "heat": {"temperature": 75, "conductance": "2000 W/(m^2*K)"}}),
    ("tools.die.width", 15.4),
    ("tools.die.edge_radius", 2),
    ("stages.1", {"name": "form", "process_time": 0.5, "velocity": 1000, "tools": {"punch": {"stroke": 2}}}),
)  # fmt: skip
"""Changes by which the strip is bent into the die."""


def hot_strip(*changes: tuple[str, object]) -> dict[str, Any]:
    """Return the case as data, with values at dotted paths put in."""
    return changed(STRIP, *changes)


def bent_strip(*changes: tuple[str, object]) -> dict[str, Any]:
    """Return the case of the strip that is bent."""
    case = hot_strip(*BEND, *changes)
    del case["tools"]["holder"]
    return case
