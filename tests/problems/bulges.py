# SPDX-License-Identifier: Apache-2.0
"""Free bulging of a clamped round membrane, and the table that it is compared with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork import Result
from tests.unit.case.round_cup import changed

Array = npt.NDArray[np.float64]
TABLE = Path(__file__).parents[1] / "data/bulge_membrane.csv"
RADIUS, THICKNESS, K = 50.0, 0.2, 500.0
"""Of the membrane [mm], its thickness [mm], and its flow stress at a strain of 1 [MPa]."""
BULGE: dict[str, Any] = {
    "title": "bulge",
    "analysis": "stamping",
    "procedure": "implicit",
    "blank": {"shape": "circle", "diameter": 2 * RADIUS, "thickness": THICKNESS, "element_size": 3.5,
              "material": "sheet", "symmetry": ["x", "y"]},
    "materials": {"sheet": {"young": "200 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
                            "hardening": {"law": "swift", "K": K, "e0": 1e-4, "n": 0.5}}},
    "pressure": {"oil": {"face": "bottom"}},
    "boundary": {"clamp": {"set": "edge", "hold": "hinged"}},
    "stages": [{"name": "bulge", "duration": 0.01, "pressure": {"oil": {"p": 1.5}}}],
    "output": {"steps": 2, "rows": 100},
}  # fmt: skip


OIL = {"face": "bottom", "fluid": {"stiffness": "2 GPa", "room": "200 cm^3"}}
"""A fluid that fills a space below the membrane."""


def vary_bulge(*changes: tuple[str, object]) -> dict[str, Any]:
    """Return the case with values at dotted paths put in."""
    return changed(BULGE, *changes)


@dataclass(frozen=True)
class Membrane:
    """Rising pole of a membrane without elasticity or bending."""

    height: Array
    """Over the radius (n,)."""
    pressure: Array
    """p a/(K t0) (n,)."""
    pole: Array
    """Thickness of the pole over that at the start (n,)."""


def read_membrane(n: float) -> Membrane:
    """Return the rows of the table for a hardening exponent, without rate."""
    table = np.loadtxt(TABLE, delimiter=",", skiprows=2)
    own = table[(table[:, 0] == 0.0) & (table[:, 1] == n)]
    return Membrane(own[:, 2], own[:, 5], own[:, 3])


def measure_bulge(result: Result, heights: Array) -> tuple[Array, Array]:
    """Return p a/(K t0) and the pole's thickness over the first where a bulge has heights over the radius (n,)."""
    history = result.history
    height = history["pressure.oil.height"] / RADIUS
    pressure = history["pressure.oil.p"] * RADIUS / (K * THICKNESS)
    return (
        np.interp(heights, height, pressure),
        np.interp(heights, height, history["pressure.oil.thickness"] / THICKNESS),
    )
