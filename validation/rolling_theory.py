# SPDX-License-Identifier: Apache-2.0
"""Published theory of cold strip rolling: slab equations of von Karman and Orowan, and Bland & Ford's closed form.

Plane strain, rolls that keep their radius, no tension unless given. phi is the angle from the exit [rad], h(phi) =
h1 + 2 R (1 - cos phi) the thickness, s the pressure on the roll, k the shear flow stress (2k = 2 sigma0 / sqrt(3)).
The horizontal force f = h * (horizontal stress) obeys (Orowan 1943, Proc. Inst. Mech. Eng. 150, 140; von Karman 1925)

    df/dphi = 2 R s (sin phi + or - mu cos phi)      + from the exit to the neutral angle, - from there to the entry

with a limit m k on the friction stress. von Karman takes f = h (s - 2k); Orowan's inhomogeneous field lowers 2k to
2k w(a), a = tau / k (the mean over the section of a shear stress that falls from the surface to the middle plane).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.optimize import brentq

SQRT3 = np.sqrt(3.0)


@dataclass(frozen=True)
class RollGap:
    """The pass: roll radius, thickness before and after [mm], friction, flow stress [MPa] by equivalent strain."""

    radius: float
    entry: float
    exit_: float
    mu: float
    flow_stress: Callable[[float], float]
    m: float = 1.0
    """Largest friction stress over k; 1 is sticking friction."""
    back_tension: float = 0.0
    """[MPa], on the strip before the roll."""
    front_tension: float = 0.0
    """[MPa], behind it."""

    @property
    def bite(self) -> float:
        """Angle of contact [rad]."""
        return float(np.arccos(1.0 - 0.5 * (self.entry - self.exit_) / self.radius))

    def thickness(self, phi: float) -> float:
        """Return the strip's thickness at an angle [mm]."""
        return float(self.exit_ + 2.0 * self.radius * (1.0 - np.cos(phi)))

    def plane_strain_flow(self, phi: float) -> float:
        """Return 2k at an angle [MPa]; the equivalent strain is 2/sqrt(3) ln(entry / h)."""
        return 2.0 / SQRT3 * self.flow_stress(2.0 / SQRT3 * float(np.log(self.entry / self.thickness(phi))))


@dataclass(frozen=True)
class Rolling:
    """What a theory gives, for one roll."""

    phi: np.ndarray
    pressure: np.ndarray
    """[MPa]"""
    friction: np.ndarray
    """On the strip, positive where it draws the strip in, that is before the neutral point [MPa]."""
    neutral_angle: float
    """[rad]"""
    force: float
    """Roll force per width [N/mm]."""
    torque: float
    """Of one roll per width, from the friction [N mm/mm]."""


def inhomogeneity(a: float) -> float:
    """Return Orowan's w(a), the mean over the section of sqrt(1 - (a t)^2), t from 0 to 1: 1 at a = 0, pi/4 at 1."""
    a = min(abs(a), 1.0)
    return 1.0 if a < 1e-6 else float(0.5 * (np.sqrt(1.0 - a * a) + np.arcsin(a) / a))


def _roll_pressure(gap: RollGap, horizontal: float, phi: float, sign: float, orowan: bool) -> tuple[float, float]:
    """Return pressure and friction stress [MPa] from the horizontal force per width, pressing positive [N/mm].

    sign: +1 between exit and neutral point. The vertical stress on a slab is taken as the roll pressure.
    """
    flow, mean = gap.plane_strain_flow(phi), horizontal / gap.thickness(phi)
    limit = 0.5 * gap.m * flow
    if not orowan:
        pressure = mean + flow
        return pressure, min(gap.mu * pressure, limit)

    def miss(pressure: float) -> float:
        tau = min(gap.mu * pressure, limit)
        return pressure - mean - flow * inhomogeneity(2.0 * tau / flow)

    pressure = brentq(miss, mean + 0.7 * flow, mean + 1.01 * flow)
    return pressure, min(gap.mu * pressure, limit)


def roll_by_slab(gap: RollGap, *, orowan: bool = False, points: int = 801) -> Rolling:
    """Integrate the slab equation from both ends to the neutral angle, where the pressures meet.

    Raises ValueError where they do not meet: the friction is too small to draw the strip in.
    """
    phi = np.linspace(0.0, gap.bite, points)

    def branch(sign: float, start: float, stop: float, force: float) -> tuple[np.ndarray, np.ndarray]:
        def slope(angle: float, f: np.ndarray) -> list[float]:
            pressure, tau = _roll_pressure(gap, float(f[0]), angle, sign, orowan)
            return [2.0 * gap.radius * (pressure * np.sin(angle) + sign * tau * np.cos(angle))]

        at = phi if stop > start else phi[::-1]
        solution = solve_ivp(slope, (start, stop), [force], t_eval=at, rtol=1e-8, atol=1e-8, max_step=gap.bite / 50)
        found = [_roll_pressure(gap, float(f), float(a), sign, orowan) for a, f in zip(at, solution.y[0], strict=True)]
        pressure, tau = np.array(found).T
        return (pressure, tau) if stop > start else (pressure[::-1], tau[::-1])

    behind, tau_behind = branch(1.0, 0.0, gap.bite, -gap.front_tension * gap.exit_)
    before, tau_before = branch(-1.0, gap.bite, 0.0, -gap.back_tension * gap.entry)
    difference = before - behind
    if difference[0] < 0 or difference[-1] > 0:
        raise ValueError(
            f"no neutral point in the arc: mu = {gap.mu:g} does not roll {gap.entry:g} to {gap.exit_:g} mm"
        )
    last = int(np.nonzero(difference >= 0)[0][-1])
    share = difference[last] / (difference[last] - difference[last + 1])
    neutral = float(phi[last] + share * (phi[last + 1] - phi[last]))
    pressure = np.minimum(before, behind)
    friction = np.where(phi < neutral, -tau_behind, tau_before)
    return _collect(gap, phi, pressure, friction, neutral)


def _collect(gap: RollGap, phi: np.ndarray, pressure: np.ndarray, friction: np.ndarray, neutral: float) -> Rolling:
    """Sum pressure and friction over the arc; the step of the friction at the neutral angle counts exactly."""
    vertical = pressure * np.cos(phi) - friction * np.sin(phi)
    force = gap.radius * float(np.trapezoid(vertical, phi))
    size = cumulative_trapezoid(np.abs(friction), phi, initial=0.0)
    behind = float(np.interp(neutral, phi, size))
    torque = gap.radius**2 * (float(size[-1]) - 2.0 * behind)
    return Rolling(phi, pressure, friction, neutral, force, torque)


def bland_ford(gap: RollGap) -> Rolling:
    """Return Bland & Ford's closed form (1948, Proc. Inst. Mech. Eng. 159, 144), for small angles and Coulomb's law.

    s+ = 2k (h/h1) exp(mu H), s- = 2k (h/h0) exp(mu (H0 - H)), H = 2 sqrt(R/h1) atan(sqrt(R/h1) phi), less the tensions.
    """
    ratio = np.sqrt(gap.radius / gap.exit_)
    phi = np.linspace(0.0, np.sqrt((gap.entry - gap.exit_) / gap.radius), 801)
    thickness = gap.exit_ + gap.radius * phi**2
    H = 2.0 * ratio * np.arctan(ratio * phi)
    flow = np.array([gap.plane_strain_flow(p) for p in phi])
    behind = flow * thickness / gap.exit_ * (1 - gap.front_tension / flow[0]) * np.exp(gap.mu * H)
    before = flow * thickness / gap.entry * (1 - gap.back_tension / flow[-1]) * np.exp(gap.mu * (H[-1] - H))
    tension = np.log((1 - gap.front_tension / flow[0]) / (1 - gap.back_tension / flow[-1]))
    H_neutral = 0.5 * H[-1] - (np.log(gap.entry / gap.exit_) + tension) / (2 * gap.mu)
    neutral = float(np.tan(0.5 * H_neutral / ratio) / ratio)
    pressure = np.minimum(behind, before)
    friction = gap.mu * pressure * np.where(phi < neutral, -1.0, 1.0)
    force = gap.radius * float(np.trapezoid(pressure, phi))
    size = gap.mu * cumulative_trapezoid(pressure, phi, initial=0.0)
    torque = gap.radius**2 * float(size[-1] - 2.0 * np.interp(neutral, phi, size))
    return Rolling(phi, pressure, friction, neutral, force, torque)


def mean_pressure_force(gap: RollGap) -> float:
    """Return the simple estimate of the roll force per width, L 2k (exp Q - 1)/Q, Q = mu L / mean thickness [N/mm]."""
    length = np.sqrt(gap.radius * (gap.entry - gap.exit_))
    Q = gap.mu * length / (0.5 * (gap.entry + gap.exit_))
    flow = 0.5 * (gap.plane_strain_flow(0.0) + gap.plane_strain_flow(gap.bite))
    return float(length * flow * (np.exp(Q) - 1) / Q)
