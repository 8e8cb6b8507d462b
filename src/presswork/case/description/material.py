# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` says of a material."""

from __future__ import annotations

import math

from presswork import model


def describe_material(material: model.Material) -> str:
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
    parts += [material.yield_function.law if material.yield_function else "von Mises"]
    parts += [_describe_hardening(material.hardening)]
    if material.kinematic:
        parts += [_describe_kinematic(material.kinematic)]
    if material.rate:
        a, b = material.rate.parameters
        names = ("D", "q") if material.rate.law == "cowper_symonds" else ("C", "reference rate")
        parts += [f"{material.rate.law} rate: {names[0]} = {a:g}, {names[1]} = {b:g}"]
    if material.heating:
        h = material.heating
        parts += [f"softens with temperature from {h.reference:g} to {h.melting:g} degrees C, starts at {h.start:g}"]
        if h.heat_capacity is not None:
            parts += [f"heated by {h.plastic_fraction:g} of its plastic work"]
    return ", ".join(parts)


def describe_forming_limit(material: model.Material) -> str:
    """Say what a part's strains will be judged by."""
    judged = material.formability
    if judged.curve is None:
        return "none: the material has no forming_limit, so nothing will be said of cracks"
    minor, major = judged.curve.lowest()
    reserve = 100 * judged.safety_margin
    text = f"{judged.curve.method}, lowest at minor {minor:.3g}, major {major:.3g}; safety margin {reserve:g} %"
    return f"{text}; {judged.note}" if judged.note else text


def _describe_kinematic(kinematic: model.Kinematic) -> str:
    p = kinematic.parameters
    if kinematic.law == "chaboche":
        pairs = zip(p[: len(p) // 2], p[len(p) // 2 :], strict=True)
        return "back stresses " + " and ".join(f"C = {C:g} MPa, gamma = {gamma:g}" for C, gamma in pairs)
    names = ("B", "C", "m", "b", "Rsat", "h")
    return "Yoshida-Uemori " + ", ".join(f"{name} = {value:g}" for name, value in zip(names, p, strict=True))


def _describe_hardening(hardening: model.Hardening) -> str:
    p = [float(value) for value in hardening.parameters]
    match hardening.law:
        case "linear":
            return f"linear hardening: {p[0]:g} + {p[1]:g} e MPa"
        case "swift":
            return f"Swift hardening: {p[0]:g} ({p[1]:g} + e)^{p[2]:g} MPa"
        case "ludwik":
            return f"Ludwik hardening: {p[0]:g} + {p[1]:g} e^{p[2]:g} MPa"
        case "voce":
            return f"Voce hardening: {p[1]:g} - {p[1] - p[0]:g} exp(-{p[2]:g} e) MPa"
        case "linear_voce":
            return f"linear and Voce hardening: {p[1]:g} + {p[3]:g} e - {p[1] - p[0]:g} exp(-{p[2]:g} e) MPa"
        case "hockett_sherby":
            return f"Hockett-Sherby hardening: {p[1]:g} - {p[1] - p[0]:g} exp(-{p[2]:g} e^{p[3]:g}) MPa"
        case "swift_voce":
            return (
                f"Swift-Voce hardening: {1 - p[0]:g} x {p[1]:g} ({p[2]:g} + e)^{p[3]:g} + "
                f"{p[0]:g} x ({p[5]:g} - {p[5] - p[4]:g} exp(-{p[6]:g} e)) MPa"
            )
        case "monotone_table":
            return f"smooth hardening table of {len(p) // 3} points: {p[1]:g} MPa at 0 to {p[-2]:g} MPa at {p[-3]:g}"
        case "table":
            return f"hardening table of {len(p) // 2} points: {p[1]:g} MPa at 0 to {p[-1]:g} MPa at {p[-2]:g}"
