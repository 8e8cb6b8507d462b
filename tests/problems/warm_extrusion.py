# SPDX-License-Identifier: Apache-2.0
"""What the example warm_extrusion gives: temperature of the product, pressure of the ram, heat of the metal."""

import numpy as np
from numpy.typing import NDArray

from presswork.case.plane.schema import Case
from presswork.results import Result

BEARING_END = -11.33
"""Where the product leaves the bearing [mm]."""


def find_exit_temperatures(result: Result, length: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return temperature and volume over 2 pi of the cells within a length below the bearing."""
    cells = result.mesh.blocks[0].connectivity
    x, y = result.points(-1)[cells].transpose(2, 0, 1)
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
    out = (y.mean(axis=1) < BEARING_END) & (y.mean(axis=1) > BEARING_END - length)
    return result.field("nodal_temperature", -1)[cells].mean(axis=1)[out], (area * x.mean(axis=1))[out]


def find_pressure(result: Result) -> float:
    """Return the ram's pressure in the steady part, the mean over the stroke from 8 mm on [MPa]."""
    stroke, force = result.history["ram.stroke"], result.history["ram.force"]
    steady = stroke > 8
    return float(np.trapezoid(force[steady], stroke[steady]) / np.ptp(stroke[steady]) / (100 * np.pi))


def find_enthalpy(case: Case, temperature: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the heat of a unit of volume above 600 degrees C [N/mm2], from the case's specific heat and 7890 kg/m3."""
    rows = np.array(case.materials["steel"].thermal.specific_heat)
    fine = np.linspace(200, 690, 4901)
    specific = np.interp(fine, rows[:, 0], rows[:, 1])
    heat = np.concatenate([[0], np.cumsum(0.5 * (specific[1:] + specific[:-1]) * np.diff(fine))])
    return 7890e-12 * (np.interp(temperature, fine, heat) - np.interp(600, fine, heat))
