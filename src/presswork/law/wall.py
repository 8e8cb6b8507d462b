# SPDX-License-Identifier: Apache-2.0
"""What the wall of a drawn part bears, and the limiting drawing ratio of a round cup, by a sheet's own laws.

Wall: plane-strain tension along the wall, Y(p) as the flow stress of the material: the force of a unit of width is
t0 max over e of w Y(w e) exp(-e), w the strength in plane strain over that in tension.

Flange: rings that keep their thickness (Whiteley 1960), so that a ring from radius R comes to r with r^2 = R^2 - (B^2 -
b^2), B and b the rim's radii before and now. With k the radial less the hoop stress over Y, p = k ln(R/r) and
d(sigma)/dr = -k Y(p)/r. Friction under the holder and over the die's radius, and bending over it, come as Siebel's
terms. w and k are means over the directions of the sheet, at each of which the laws find the state of stress.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.law.elastic_plastic import is_hot, make_sheet_law, make_yield_function
from presswork.model import FloatArray, Material

Flow = Callable[[FloatArray], FloatArray]
"""Flow stress [MPa] over plastic strain, shapes (n,)."""
DIRECTIONS = np.radians(np.arange(0.0, 91.0, 7.5))
"""Directions of the wall from the rolling direction."""
LARGEST_STRAIN = 1.0
RINGS = 60
DRAWS = 60
"""Places of the rim between start and end at which the force is found."""


@dataclass(frozen=True)
class Strengths:
    """Strengths of a sheet over its flow stress, means over the directions in its plane."""

    wall: float
    """Plane-strain tension."""
    flange: float
    """Radial less hoop stress where the thickness stays."""


@dataclass(frozen=True)
class Cup:
    """A round cup and what holds it back; lengths over the thickness of the sheet where they have no unit."""

    punch: float = 100.0
    """Diameter of the punch over the thickness."""
    die_radius: float = 8.0
    """Radius of the die over the thickness."""
    mu: float = 0.08
    holder_pressure: float = 2.0
    """[MPa]"""


def find_strengths(function: _core.YieldFunction) -> Strengths:
    """Find w and k of a yield function of plane stress."""
    wall, flange = [], []
    ratios = np.linspace(-1.5, 1.0, 1001)
    for angle in DIRECTIONS:
        c, s = math.cos(angle), math.sin(angle)
        along, across = np.array([c * c, s * s, s * c]), np.array([s * s, c * c, -s * c])
        value, gradient, _ = function.evaluate(np.ascontiguousarray(along + ratios[:, None] * across))
        rate, hoop = gradient @ along, gradient @ across
        wall.append(1.0 / value[int(np.argmin(np.abs(hoop)))])
        even = int(np.argmin(np.abs(rate + hoop)))
        flange.append((1.0 - ratios[even]) / value[even])
    return Strengths(float(np.mean(wall)), float(np.mean(flange)))


def find_wall_force(strengths: Strengths, flow_stress: Flow) -> float:
    """Return the force that a wall bears over its width and first thickness [MPa]."""
    strain = np.linspace(0.0, LARGEST_STRAIN, 501)
    return float((strengths.wall * flow_stress(strengths.wall * strain) * np.exp(-strain)).max())


def find_draw_force(strengths: Strengths, flow_stress: Flow, ratio: float, cup: Cup) -> float:
    """Return the largest force of a draw over the wall's circumference and the first thickness [MPa].

    ratio: diameter of the blank over that of the punch.
    """
    inner, rim = 0.5 * cup.punch, 0.5 * ratio * cup.punch
    outer = np.linspace(rim, inner * 1.001, DRAWS)[:, None]
    radius = inner + (outer - inner) * np.linspace(0.0, 1.0, RINGS)
    before = np.sqrt(radius**2 + rim**2 - outer**2)
    p = strengths.flange * np.log(before / radius)
    stress = np.asarray(flow_stress(p.ravel())).reshape(p.shape)
    slope = strengths.flange * stress / radius
    pull = (0.5 * (slope[:, 1:] + slope[:, :-1]) * np.diff(radius, axis=1)).sum(axis=1)
    holder = cup.holder_pressure * np.pi * (outer[:, 0] ** 2 - inner**2)
    pull = pull + 2.0 * cup.mu * holder / (2.0 * np.pi * inner)
    bending = stress[:, 0] / (2.0 * cup.die_radius + 1.0)
    return float((math.exp(0.5 * math.pi * cup.mu) * pull + bending).max())


def find_drawing_ratio(material: Material, cup: Cup | None = None) -> float:
    """Return the largest drawing ratio at which the wall of a round cup bears the force of its draw.

    material: elastic-plastic, of a sheet; without rate and temperature.
    """
    cup = cup or Cup()
    strengths, flow_stress = find_strengths(make_yield_function(material.yield_function)), find_flow_stress(material)
    bears = find_wall_force(strengths, flow_stress)
    low, high = 1.05, 4.0
    for _ in range(24):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if find_draw_force(strengths, flow_stress, middle, cup) < bears else (low, middle)
    return low


def find_flow_stress(material: Material) -> Flow:
    """Return a sheet's flow stress [MPa] over plastic strain (n,), at rest."""
    law = make_sheet_law(material)
    return lambda p: np.asarray(law.flow_stress(np.ascontiguousarray(p))[0])


def has_wall(material: Material) -> bool:
    """Return whether a material's wall can be judged: plastic, by a law of strain alone."""
    known = material.hardening is not None and material.umat is None and not material.is_elastic
    return known and not is_hot(material) and material.rate is None and material.heating is None
