# SPDX-License-Identifier: Apache-2.0
"""Friction as one function of pressure, flow stress, speed, temperature and path, with its derivative by pressure.

With p the pressure, k the shear flow stress and s0 = sqrt(3) k:

    shear m k      coulomb mu p      coulomb_capped min(mu p, m k)      levanov m k (1 - exp(-1.25 p / s0))

wanheim_bay, Wanheim & Bay 1978, CIRP Annals 27: mu p at low pressure, which turns smoothly to m k as asperities are
pressed flat. Levanov 1976. m and mu are multiplied by factors, of pressure, speed, temperature and slid path.
"""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, Friction, FrictionFactors

LEVANOV = 1.25
"""Levanov's constant."""
FLOOR = 1e-3
"""Pressure over the reference below which a power of the pressure is that of the floor: it has no limit at zero."""
SMALL = 1e-7
"""Difference of friction factors by which a derivative is taken."""
SOFTEST = 1e-9
"""Shear flow stress below which a metal has none [MPa]."""
SMOOTH = ("wanheim_bay", "levanov")
"""Laws that rise smoothly from none at no pressure to a part of the shear flow stress."""
BY_FLOW_STRESS = ("shear", "coulomb_capped", "wanheim_bay", "levanov")
"""Laws that ask for the flow stress."""


def is_plain(law: Friction) -> bool:
    """Return whether friction is a constant part of pressure or of shear flow stress, or the smaller of both."""
    return law.factors is None and law.law not in SMOOTH


def find_factor(
    factors: FrictionFactors | None,
    speed: FloatArray,
    path: FloatArray,
    temperature: FloatArray | None = None,
) -> FloatArray:
    """Return what m and mu are multiplied by, whatever the pressure (n,).

    speed: of sliding (n,) [mm/s]. path: slid so far (n,) [mm]. temperature: of the workpiece (n,) [degrees C]; None: it
    is not known. Beyond the ends of a table its end values hold.
    """
    factor = np.ones_like(speed)
    if factors is None:
        return factor
    for table, at in ((factors.speed, speed), (factors.path, path), (factors.temperature, temperature)):
        if table is not None and at is not None:
            factor *= np.interp(at, table[:, 0], table[:, 1])
    return factor


def find_pressure_factor(factors: FrictionFactors | None, pressure: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factor of the pressure (n,) [MPa] on m and mu, and its derivative by it [1/MPa]."""
    value, slope = np.ones_like(pressure), np.zeros_like(pressure)
    if factors is None:
        return value, slope
    if factors.exponent != 1.0:
        power = factors.exponent - 1.0
        ratio = np.maximum(pressure / factors.reference, FLOOR)
        value = ratio**power
        slope = np.where(ratio > FLOOR, power * value / np.maximum(pressure, FLOOR * factors.reference), 0.0)
    if factors.pressure is not None:
        at, of = factors.pressure.T
        place = np.clip(np.searchsorted(at, pressure, side="right") - 1, 0, len(at) - 2)
        rise = (of[place + 1] - of[place]) / (at[place + 1] - at[place])
        rise = np.where((pressure < at[0]) | (pressure >= at[-1]), 0.0, rise)
        own = np.interp(pressure, at, of)
        value, slope = value * own, slope * own + value * rise
    return value, slope


def limit_stress(
    law: Friction, m: FloatArray, mu: FloatArray, pressure: FloatArray, shear_flow: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the largest friction stress that a law allows (n,) [MPa], and its derivative by the pressure (n,).

    m, mu: with all factors but that of the pressure (n,). shear_flow: shear flow stress k (n,) [MPa]; infinite where it
    is not known.
    """
    factor, rise = find_pressure_factor(law.factors, pressure)
    by_push, by_push_rise = mu * factor * pressure, mu * (factor + rise * pressure)
    part, part_rise = np.minimum(m * factor, 1.0), np.where(m * factor < 1.0, m * rise, 0.0)
    if law.law == "coulomb":
        return by_push, by_push_rise
    if law.law in ("shear", "coulomb_capped"):
        by_shear, by_shear_rise = part * shear_flow, part_rise * shear_flow
        if law.law == "shear":
            return by_shear, by_shear_rise
        return np.minimum(by_push, by_shear), np.where(by_push < by_shear, by_push_rise, by_shear_rise)
    ratio = pressure / (np.sqrt(3.0) * np.maximum(shear_flow, SOFTEST))
    if law.law == "levanov":
        fade = np.exp(-LEVANOV * ratio)
        return part * shear_flow * (1.0 - fade), part * LEVANOV * fade / np.sqrt(3.0) + part_rise * shear_flow * (
            1.0 - fade
        )
    if law.law == "wanheim_bay":
        value, slope = find_wanheim_bay(part, ratio)
        by_part = (find_wanheim_bay(part + SMALL, ratio)[0] - value) / SMALL  # 0 from a part of 1 on
        return value * shear_flow, slope / np.sqrt(3.0) + by_part * part_rise * shear_flow
    return np.zeros_like(pressure), np.zeros_like(pressure)


def find_wanheim_bay(part: FloatArray, ratio: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return friction over the shear flow stress (n,), and its derivative by the pressure over the flow stress.

    part: friction factor f of the places that touch (n,), 0 to 1. ratio: pressure over flow stress (n,). Up to the end
    of proportionality asperities touch apart from each other; beyond it their fields of slip lines meet.
    """
    f = np.clip(part, 0.0, 1.0)
    root = np.sqrt(1.0 - f)
    proportional = 1.0 - root
    end = (1.0 + 0.5 * np.pi + np.arccos(f) + np.sqrt(1.0 - f * f)) / (np.sqrt(3.0) * (1.0 + root))
    rest = f - proportional
    safe = np.maximum(rest, 1e-300)
    fade = np.exp(np.minimum((end - ratio) * proportional / (safe * end), 0.0))
    beyond = ratio > end
    value = np.where(beyond, proportional + rest * (1.0 - fade), proportional * ratio / end)
    slope = np.where(beyond, proportional / end * np.where(rest > 0.0, fade, 0.0), proportional / end)
    return value, slope
