# SPDX-License-Identifier: Apache-2.0
"""Two square shells of mild steel, side by side, for the tests of what an explicit run refuses."""

import numpy as np

from presswork import _core

LAW = _core.SheetLaw(
    207e3,
    0.3,
    _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5]),
    _core.HardeningLaw.linear,
    [200.0, 500.0],
)
POINTS = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], dtype=float)
CELLS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
STEEL = 7.85e-9
"""Density [t/mm3]."""
