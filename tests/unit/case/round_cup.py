# SPDX-License-Identifier: Apache-2.0
"""A stamping that the tests of stamping cases share, as data, and how to change it."""

from __future__ import annotations

import copy
from typing import Any

CUP: dict[str, Any] = {
    "title": "cup",
    "analysis": "stamping",
    "blank": {"shape": "circle", "diameter": 100, "thickness": 0.8, "element_size": 6, "material": "steel",
              "symmetry": ["x", "y"]},
    "materials": {"steel": {"young": "206 GPa", "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 200,
                                                                                "modulus": 1000}}},
    "tools": {
        "punch": {"kind": "punch", "shape": "round", "diameter": 50, "edge_radius": 5},
        "die": {"kind": "die", "shape": "round", "diameter": 52.5, "edge_radius": 6},
        "holder": {"kind": "holder", "shape": "round", "diameter": 54, "edge_radius": 1},
    },
    "stages": [{"name": "draw", "tools": {"punch": {"stroke": 20}, "holder": {"force": "10 kN"}}}],
}  # fmt: skip


def changed(data: dict[str, Any], *changes: tuple[str, object]) -> dict[str, Any]:
    """Return a copy with values at dotted paths put in; a number in a path counts along a list."""
    copied = copy.deepcopy(data)
    for path, value in changes:
        *keys, last = path.split(".")
        here: Any = copied
        for key in keys:
            here = here[int(key)] if key.isdigit() else here[key]
        here[int(last) if last.isdigit() else last] = copy.deepcopy(value)
    return copied
