# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about a material."""

from __future__ import annotations

import math

import numpy as np

from presswork import model
from presswork.law.elastic_plastic import make_yield_function

_OTHERS = np.array([[0.5, 0.5, 0.5], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
"""Unit tension at 45 and 90 degrees, and biaxial: xx, yy, xy."""
STRONG = 1.1
"""Biaxial yield stress over that at 0 degrees, from which r-values may have made it."""


def describe_material(material: model.Material, *, starts: bool = True) -> str:
    """Describe a material; starts: also at its own temperature at the start."""
    if material.gtn:
        g = material.gtn
        elastic = f"E = {material.young:g} MPa, Poisson's ratio {material.poisson:g}"
        return f"{elastic}, pores: {g.initial:g} at the start, averaged over {g.length:g} mm"
    if material.umat:
        umat, tried = material.umat, not math.isnan(material.young)
        return f"UMAT of {umat.library}, {len(umat.props)} props, {umat.n_state} state variables; " + (
            f"at first E = {material.young:g} MPa, Poisson's ratio {material.poisson:g}" if tried else "not opened"
        )
    assert material.hardening is not None
    parts = [f"E = {material.young:g} MPa", f"Poisson's ratio {material.poisson:g}"]
    if material.young_decrease:
        saturated, rate = material.young_decrease
        parts[0] += f" falling to {saturated:g} MPa as exp(-{rate:g} e)"
    if material.is_elastic:
        parts += ["elastic: it has no hardening, and never yields"]
    else:
        parts += [_describe_yield(material.yield_function) if material.yield_function else "von Mises"]
        parts += [_describe_hardening(material.hardening)]
    if material.kinematic:
        parts += [_describe_kinematic(material.kinematic)]
    if material.rate:
        values = ", ".join(f"{name.replace('_', ' ')} = {value:g}" for name, value in material.rate.parameters.items())
        parts += [f"{material.rate.law} rate: {values}"]
    if material.heating:
        h = material.heating
        if h.melting is None:
            parts += [f"starts at {h.start:g} degrees C"] if starts else []
        else:
            softens = f"softens with temperature from {h.reference:g} to {h.melting:g} degrees C"
            parts += [f"{softens}, starts at {h.start:g}" if starts else softens]
        if h.heat_capacity is not None:
            parts += [f"heated by {h.plastic_fraction:g} of its plastic work"]
    if material.transformation:
        parts += [_describe_transformation(material.transformation)]
    if material.damage:
        d = material.damage
        numbers = [f"{name} = {value:g}" for name, value in d.parameters.items()]
        numbers += [] if d.critical is None else [f"critical {d.critical:g}"]
        parts += [f"damage by {d.criterion} {' and '.join(numbers)}".rstrip()]
    return ", ".join(parts)


def _describe_yield(function: model.YieldFunction) -> str:
    """Describe what a yield function predicts for tension in other directions, where that is usually not measured."""
    diagonal, across, biaxial = (1.0 / value for value in make_yield_function(function).evaluate(_OTHERS)[0])
    compared = f"{diagonal:.3g}, {across:.3g} and {biaxial:.3g} of that at 0"
    if max(abs(value - 1.0) for value in (diagonal, across, biaxial)) < 1e-6:
        compared = "equal to that at 0"
    text = f"{function.law} (yield stress at 45, 90 degrees and biaxial {compared}"
    if function.law == "hill1948" and biaxial > STRONG:
        text += "; r-values alone do so in Hill's function: if it was not measured, take yld2000 with r00, r45, r90"
    return f"{text})"


def describe_forming_limit(material: model.Material) -> str:
    """Describe the limit that a part's strains will be judged by."""
    judged = material.formability
    if judged.curve is None:
        return "none: the material has no forming_limit, so cracks will not be judged"
    minor, major = judged.curve.lowest()
    reserve = 100 * judged.safety_margin
    text = f"{judged.curve.method}, lowest at minor {minor:.3g}, major {major:.3g}; safety margin {reserve:g} %"
    return f"{text}; {judged.note}" if judged.note else text


def _describe_kinematic(kinematic: model.Kinematic) -> str:
    p = kinematic.parameters
    if kinematic.law == "chaboche":
        pairs = zip(p["C"], p["gamma"], strict=True)
        return "back stresses " + " and ".join(f"C = {C:g} MPa, gamma = {gamma:g}" for C, gamma in pairs)
    return "Yoshida-Uemori " + ", ".join(f"{name} = {value:g}" for name, (value,) in p.items())


def _describe_hardening(hardening: model.Hardening) -> str:
    p, rows = hardening.named(), [float(value) for value in hardening.parameters]
    if hardening.law == "monotone_table":
        n = len(rows) // 3
        return f"smooth hardening table of {n} points: {rows[1]:g} MPa at 0 to {rows[-2]:g} MPa at {rows[-3]:g}"
    if hardening.law == "table":
        return f"hardening table of {len(rows) // 2} points: {rows[1]:g} MPa at 0 to {rows[-1]:g} MPa at {rows[-2]:g}"
    if hardening.window is not None and not p:
        (_, strain), (slow, fast), (cold, hot) = hardening.window.tolist()
        return f"hot_table up to strain {strain:g}, {slow:g} to {fast:g} 1/s, {cold:g} to {hot:g} degrees C"
    voce = ""
    if "saturation_stress" in p:
        voce = f"{p['saturation_stress'] - p['yield_stress']:g} exp(-{p['rate']:g} e"
    match hardening.law:
        case "linear":
            return f"linear hardening: {p['yield_stress']:g} + {p['modulus']:g} e MPa"
        case "swift":
            return f"Swift hardening: {p['K']:g} ({p['e0']:g} + e)^{p['n']:g} MPa"
        case "ludwik":
            return f"Ludwik hardening: {p['yield_stress']:g} + {p['K']:g} e^{p['n']:g} MPa"
        case "voce":
            return f"Voce hardening: {p['saturation_stress']:g} - {voce}) MPa"
        case "linear_voce":
            return f"linear and Voce hardening: {p['saturation_stress']:g} + {p['modulus']:g} e - {voce}) MPa"
        case "hockett_sherby":
            return f"Hockett-Sherby hardening: {p['saturation_stress']:g} - {voce}^{p['exponent']:g}) MPa"
        case "swift_voce":
            return (
                f"Swift-Voce hardening: {1 - p['voce_share']:g} x {p['K']:g} ({p['e0']:g} + e)^{p['n']:g} + "
                f"{p['voce_share']:g} x ({p['saturation_stress']:g} - {voce})) MPa"
            )
    return f"{hardening.law} hardening: " + ", ".join(f"{name} = {value:g}" for name, value in p.items())


def _describe_transformation(steel: model.Transformation) -> str:
    """Name the temperatures at which phases begin to form."""
    text = _describe_kinetics(steel)
    if steel.mechanics is not None:
        text += ", with strain" + (" and flow stress" if steel.mechanics.phases[0].yield_stress is not None else "")
        text += " by phase"
        trip = max(phase.trip for phase in steel.mechanics.phases)
        text += f", transformation plasticity up to {trip:g} 1/MPa" if trip else ""
    return text


def _describe_kinetics(steel: model.Transformation) -> str:
    if steel.times:
        tables = ", ".join(steel.times)
        return f"transforms on cooling: {tables} by times, martensite from {steel.martensite_start:.0f} °C on"
    if not steel.composition:
        return f"martensite from {steel.martensite_start:.0f} °C on"
    return (
        f"transforms on cooling: ferrite from {steel.ferrite_start:.0f}, pearlite from {steel.pearlite_start:.0f}, "
        f"bainite from {steel.bainite_start:.0f}, martensite from {steel.martensite_start:.0f} °C on"
    )
