# SPDX-License-Identifier: Apache-2.0
"""Two strips of unlike thickness, welded in series and pulled in plane strain."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.case.stamping.schema import StampingCase

N = 0.2
STEEL = {
    "young": "210 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
    "hardening": {"law": "swift", "K": 20, "n": N, "e0": 1e-6},
}  # fmt: skip
"""So soft that elastic strains are small beside plastic ones."""
HALF = 10.0
"""Length of a strip [mm]."""


def make_strips(procedure: str, thicker: float, stretch: float, **changes: Any) -> StampingCase:
    """Return strips of 1 mm and of `thicker` mm, pulled to a mean strain of 0.2 of the thin one and of `stretch`."""
    pull = HALF * (np.exp(N) - 1.0) + HALF * (np.exp(stretch) - 1.0)
    zone = {"name": "thick", "line": [[0, -1], [0, 1]], "side": "right", "thickness": thicker}
    case = {
        "title": "strips", "analysis": "stamping", "procedure": procedure,
        "blank": {"shape": "rectangle", "size": [2 * HALF, 4], "element_size": 2, "thickness": 1.0,
                  "material": "steel", "zones": [zone]},
        "materials": {"steel": STEEL},
        "boundary": {"wide": {"set": "all", "fix": ["y", "z"]}, "left": {"set": "left", "fix": ["x"]}},
        "stages": [{"name": "pull", "duration": 0.01,
                    "displacement": [{"set": "right", "component": "x", "value": pull}]}],
        "implicit": {"max_increment": 0.05, "initial_increment": 0.01},
        "output": {"steps": 1, "rows": 20},
    }  # fmt: skip
    return StampingCase.model_validate(case | changes)
