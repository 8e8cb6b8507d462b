# SPDX-License-Identifier: Apache-2.0
"""Vickers hardness by composition and cooling rate (Maynier, Dollet & Bastien 1978), a mixture of the phases."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from presswork.model import FloatArray

SLOWEST, FASTEST = 1.0, 1e7
"""Cooling rates at 700 degrees C that the formulas are used within [K/h]."""
PER_HOUR = 3600.0
HARDNESS_AT = 700.0
"""Temperature at which the cooling rate counts [degrees C]."""


def find_hardness(composition: Mapping[str, float], fractions: FloatArray, cooling_rate: FloatArray) -> FloatArray:
    """Return Vickers hardness (...) [HV] of fractions of PHASES (4, ...).

    composition: mass per cents. cooling_rate: at 700 degrees C (...) [K/s]. Austenite that is left counts as
    martensite: the formulas are for room temperature.

    >>> steel = {"C": 0.23, "Mn": 1.2, "Si": 0.25, "Cr": 0.2}
    >>> round(float(find_hardness(steel, np.array([0.0, 0.0, 0.0, 1.0]), np.array(30.0))))
    474
    """
    c, mn, si, ni, cr, mo = (composition.get(e, 0.0) for e in ("C", "Mn", "Si", "Ni", "Cr", "Mo"))
    rate = np.log10(np.clip(cooling_rate * PER_HOUR, SLOWEST, FASTEST))
    martensite = 127 + 949 * c + 27 * si + 11 * mn + 8 * ni + 16 * cr + 21 * rate
    bainite = (-323 + 185 * c + 330 * si + 153 * mn + 65 * ni + 144 * cr + 191 * mo) + (
        89 + 53 * c - 55 * si - 22 * mn - 10 * ni - 20 * cr - 33 * mo
    ) * rate
    soft = 42 + 223 * c + 53 * si + 30 * mn + 12.6 * ni + 7 * cr + 19 * mo + (10 - 19 * si + 4 * ni + 8 * cr) * rate
    hard = 1.0 - fractions[:3].sum(axis=0)
    return np.asarray((fractions[0] + fractions[1]) * soft + fractions[2] * bainite + hard * martensite)
