# SPDX-License-Identifier: Apache-2.0
"""Superplastic forming of a round membrane and of a channel: stress K rate^m, without hardening."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from tests.problems.bulges import RADIUS, TABLE, THICKNESS, vary_bulge

Array = npt.NDArray[np.float64]
K, RATE = 200.0, 1e-3
"""Consistency [MPa s^m] and strain rate [1/s]."""


def make_sheet(m: float) -> dict[str, Any]:
    """Return a table of a material whose stress is K rate^m."""
    windows = {"strain_window": [0, 10], "rate_window": [1e-8, 1], "temperature_window": [0, 1000]}
    return {
        "magnitudes": "any", "young": "20 GPa", "poisson": 0.3, "density": "2700 kg/m^3", "heating": {"start": 500},
        "hardening": {"law": "norton_hoff", "K": K, "m": m, **windows},
    }  # fmt: skip


def make_dome(m: float, size: float, **rate: Any) -> dict[str, Any]:
    """Return the case of a membrane that gas blows to a hemisphere; rate: keys of the rate that it holds."""
    scale = K * RATE**m * THICKNESS / RADIUS
    goal = {"target": RATE, "least": 0.05 * scale, "most": 2.0 * scale, **rate}
    return vary_bulge(
        ("materials.sheet", make_sheet(m)),
        ("blank.element_size", size),
        ("stages.0", {"name": "blow", "duration": 3000, "pressure": {"oil": {"rate": goal}}}),
        ("limits", {"thinning": 0.9, "end": [{"column": "pressure.oil.height", "above": RADIUS}]}),
    )


def make_channel(m: float, **rate: Any) -> dict[str, Any]:
    """Return the case of a strip in plane strain, clamped at half a width of 50 mm, that gas blows to half a circle."""
    blank = {"shape": "rectangle", "size": [2.0 * RADIUS, 10.0], "element_size": [5.0, 5.0]}
    goal = {"target": RATE, "least": 0.001, "most": 5.0, **rate}
    return vary_bulge(
        ("materials.sheet", make_sheet(m)),
        ("blank", {**blank, "thickness": THICKNESS, "material": "sheet", "symmetry": ["x", "y"]}),
        ("boundary.clamp.set", "right"),
        ("boundary.sides", {"set": "top", "fix": ["y", "rx", "rz"]}),
        ("stages.0", {"name": "blow", "duration": 3000, "pressure": {"oil": {"rate": goal}}}),
        ("limits", {"thinning": 0.9, "end": [{"column": "pressure.oil.height", "above": RADIUS}]}),
    )


def read_dome(m: float) -> Array:
    """Return rows of height over radius, p a/(K t0 rate^m) at a constant rate, and pole over first thickness (n, 3)."""
    table = np.loadtxt(TABLE, delimiter=",", skiprows=2)
    return table[(table[:, 0] == m) & (table[:, 1] == 0.0)][:, [2, 5, 3]]


def find_time(strain: Array, pressure: Array, m: float) -> float:
    """Return the time in which a constant p takes a sheet along, over (K t0/(p a))^(1/m).

    strain: of its fastest part; pressure: p a/(K t0 rate^m) at that strain (n,). With K rate^m the stress, the rate
    under p is the one whose pressure is p.
    """
    slowness = pressure ** (1.0 / m)
    return float((np.diff(strain) * 0.5 * (slowness[1:] + slowness[:-1])).sum())
