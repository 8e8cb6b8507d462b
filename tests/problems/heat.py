# SPDX-License-Identifier: Apache-2.0
"""Problems of heat conduction with closed solutions, and the models that compute them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import erfc, j0, j1

from presswork.case import build_model
from presswork.case.heat.schema import HeatCase
from presswork.process.heat import HeatProcedure

STEEL = {"density": "7850 kg/m^3", "conductivity": "52 W/(m*K)", "specific_heat": "460 J/(kg*K)"}


def make_case(**changes: Any) -> HeatCase:
    """Return a case of heat alone in the plane."""
    return HeatCase.model_validate(
        {
            "title": "heat",
            "analysis": "heat",
            "geometry": "plane",
            "initial_temperature": 20,
            "materials": {"steel": STEEL},
            "output": {"steps": 1},
            **changes,
        }
    )


def compute(case: HeatCase) -> HeatProcedure:
    """Compute a case to its end."""
    procedure = HeatProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def temperature_at(procedure: HeatProcedure, *place: float) -> float:
    """Return the temperature [degrees C] of the node nearest to a place [mm]."""
    points = procedure.model.mesh.points
    nearest = int(np.argmin(np.linalg.norm(points - np.array(place), axis=1)))
    return float(procedure.state["temperature"][nearest])


def cool_slab(biot: float, fourier: float, x: float = 0.0) -> float:
    """Return (T - ambient) / (start - ambient) of a slab cooled on both sides (Carslaw & Jaeger 1959, 3.11).

    biot: h l / k with half the thickness l; fourier: alpha t / l^2; x: distance from the middle over l.
    """
    roots = [_root(lambda b: b * np.sin(b) - biot * np.cos(b), np.pi * i, np.pi * (i + 0.5)) for i in range(60)]
    return sum(2 * np.sin(b) / (b + np.sin(b) * np.cos(b)) * np.cos(b * x) * np.exp(-(b**2) * fourier) for b in roots)


def cool_cylinder(biot: float, fourier: float, r: float = 0.0) -> float:
    """Return the same of a long cylinder (Carslaw & Jaeger 1959, 7.7)."""
    grid = np.linspace(1e-9, 200.0, 200_000)
    values = grid * j1(grid) - biot * j0(grid)
    at = np.flatnonzero(values[1:] * values[:-1] < 0)
    roots = [_root(lambda b: b * j1(b) - biot * j0(b), grid[i], grid[i + 1]) for i in at]
    return sum(2 * biot * j0(b * r) / ((b**2 + biot**2) * j0(b)) * np.exp(-(b**2) * fourier) for b in roots)


def meet_half_spaces(hot: float, cold: float, effusivity: float, conductance: float, time: float) -> float:
    """Return the surface temperature of the hot one of two like half-spaces that touch with a conductance."""
    z = conductance * 2.0 / effusivity * np.sqrt(time)
    return float(hot - (hot - cold) * 0.5 * (1.0 - np.exp(z**2) * erfc(z)))


def radiate(start: float, ambient: float, rate: float) -> Callable[[float], float]:
    """Return the time [s] by temperature [K] of a lumped body with dT/dt = -rate (T^4 - ambient^4)."""
    return lambda t: (_integral(t, ambient) - _integral(start, ambient)) / rate


def _integral(t: float, a: float) -> float:
    """Return the integral of -1 / (t^4 - a^4)."""
    return float((np.log((t + a) / (t - a)) + 2 * np.arctan(t / a)) / (4 * a**3))


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    return float(brentq(f, low, high, xtol=1e-14))


def fit_order(sizes: list[float], errors: list[float]) -> NDArray[np.float64]:
    """Return the orders of convergence between neighbouring sizes."""
    return np.diff(np.log(errors)) / np.diff(np.log(sizes))
