# SPDX-License-Identifier: Apache-2.0
"""Turns a Model's material into the compiled elastic-plastic law of a sheet or of a solid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypedDict

import numpy as np

from presswork import _core
from presswork.law.history import BACK_STRESS, EQPS, RISE, History
from presswork.law.thermoelastic import find_young_factor, make_curves
from presswork.model import FloatArray, Hardening, Material, YieldFunction

VON_MISES = (0.5, 0.5, 0.5, 1.5, 1.5, 1.5)
"""Hill's F, G, H, L, M, N that make von Mises."""
SheetLaw = _core.SheetLaw
SolidLaw = _core.PlaneLaw | _core.SolidLaw


def make_yield_function(chosen: YieldFunction | None) -> _core.YieldFunction:
    """Return the compiled yield function: von Mises if none is chosen."""
    if chosen is None:
        return _core.YieldFunction.hill1948(VON_MISES)
    match chosen.law:
        case "hill1948":
            return _core.YieldFunction.hill1948(chosen.parameters)
        case "barlat1989":
            a, c, h, p = chosen.parameters
            return _core.YieldFunction.barlat1989(a, c, h, p, chosen.exponent)
        case "yld2000":
            return _core.YieldFunction.yld2000(chosen.parameters, chosen.exponent)
        case "yld2004":
            return _core.YieldFunction.yld2004(chosen.parameters[:9], chosen.parameters[9:], chosen.exponent)


def make_hardening(hardening: Hardening) -> tuple[_core.HardeningLaw, list[float]]:
    """Return the compiled law's name and its parameters in the order of its fields."""
    return _core.HardeningLaw[hardening.law], [float(p) for p in hardening.parameters]


def make_sheet_law(material: Material) -> _core.SheetLaw:
    """Return the compiled law in plane stress."""
    return _core.SheetLaw(**_arguments(material))


def make_plane_law(material: Material) -> _core.PlaneLaw:
    """Return the compiled law in plane strain and axisymmetry. Raises ValueError for a function of plane stress."""
    return _core.PlaneLaw(**_arguments_of_solid(material), phases=material.phases is not None)


def make_solid_law(material: Material) -> _core.SolidLaw:
    """Return the compiled law in space. Raises ValueError for a yield function of plane stress alone."""
    return _core.SolidLaw(**_arguments_of_solid(material), phases=material.phases is not None)


def make_hardening_law(material: Material) -> _core.VonMises:
    """Return a law whose flow stress is the hardening of a material alone."""
    assert material.hardening is not None
    return _core.VonMises(material.young, material.poisson, *make_hardening(material.hardening))


def first_flow_stress(material: Material) -> float:
    """Return the flow stress of a sheet that has not flowed yet, at rest [MPa]; for a UMAT the value in the case."""
    if material.umat is not None:
        return material.umat.yield_stress
    return float(make_sheet_law(material).flow_stress(np.zeros(1))[0][0])


def is_plain(material: Material) -> bool:
    """Return whether a solid's material is von Mises with isotropic hardening alone, which has a law in closed form."""
    beside = (
        material.yield_function,
        material.kinematic,
        material.rate,
        material.heating,
        material.young_decrease,
        material.thermoelastic,
    )
    return material.umat is None and not is_hot(material) and all(part is None for part in beside)


def is_hot(material: Material) -> bool:
    """Return whether the flow stress depends on strain, strain rate and temperature together."""
    return material.hardening is not None and material.hardening.is_hot


def depends_on_temperature(material: Material) -> bool:
    """Return whether the law must know its temperature."""
    asks = (material.heating, material.thermoelastic, material.phases)
    return is_hot(material) or any(part is not None for part in asks)


def depends_on_rate(material: Material) -> bool:
    """Return whether the flow stress depends on the rate of plastic strain."""
    return material.rate is not None or is_hot(material)


def heats(material: Material) -> bool:
    """Return whether plastic work raises the temperature, so that the law keeps the rise."""
    return find_heating(material) > 0.0


def find_heating(material: Material) -> float:
    """Return by how much plastic work per volume raises the temperature [degree/MPa]."""
    h = material.heating
    if h is None or h.heat_capacity is None or material.density == 0.0:
        return 0.0
    return h.plastic_fraction / (material.density * h.heat_capacity)


def make_thermal(material: Material) -> _core.Thermal | None:
    """Return softening and heating of a material; None: it does not know of temperature."""
    h = material.heating
    if h is None:
        return None
    melting = h.reference if h.melting is None else h.melting
    heating = find_heating(material)
    return _core.Thermal(start=h.start, reference=h.reference, melting=melting, exponent=h.exponent, heating=heating)


def back_stress(kept: History, history: FloatArray, components: int) -> FloatArray:
    """Return the back stress (..., components) in what a law keeps (..., n) behind the stress [MPa].

    It is the sum of every a_i of Chaboche, or of theta and beta of Yoshida and Uemori.
    """
    if BACK_STRESS not in kept:
        return np.zeros((*history.shape[:-1], components))
    parts = history[..., kept[BACK_STRESS]].reshape(*history.shape[:-1], -1, components)
    return np.asarray(parts.sum(axis=-2))


def temperature_at_rest(material: Material, shape: tuple[int, ...]) -> FloatArray:
    """Return the given temperature of points (n_cells, n) at the start [degrees C]; no rows if the law does not ask."""
    if material.heating is None:
        return np.zeros((0, *shape[1:]))
    return np.full(shape, material.heating.start)


def rate_at_rest(material: Material, shape: tuple[int, ...]) -> FloatArray:
    """Return the rate of plastic strain of points (n_cells, n) at the start [1/s]; no rows if the law does not ask."""
    return np.zeros(shape if depends_on_rate(material) else (0, *shape[1:]))


def temperature(material: Material, kept: History, history: FloatArray, given: FloatArray | None = None) -> FloatArray:
    """Return the temperature [degrees C] of points (...) from what their law keeps behind the stress (..., n).

    given: from outside (as many values) [degrees C]; None or no values: that of the start.
    """
    shape = history.shape[:-1]
    if given is None or given.size == 0:
        base = np.full(shape, material.heating.start if material.heating else 0.0)
    else:
        base = given.reshape(shape)
    return np.asarray(base + kept.of(RISE, history)) if RISE in kept else base


def plastic_work_density(
    material: Material,
    law: _core.SheetLaw | SolidLaw,
    kept: History,
    history_n: FloatArray,
    history: FloatArray,
    stress: FloatArray,
    dt: float,
    given: tuple[FloatArray, FloatArray],
    factor: Sequence[FloatArray] | None = None,
) -> FloatArray:
    """Return the plastic work of an increment over dt [s] per volume (n,) [MPa], by the trapezoidal rule.

    With dp the increment of equivalent plastic strain and g the gradient of the yield function at its end: the mean
    flow stress times dp, and the mean back stress times g dp. history (n, n_history): what the law keeps behind the
    stress, as kept names it; stress (n, components): at the end, in the law's axes; given: temperatures (n,) before and
    after; factor: on the flow stress before and after (n,).
    """
    components = stress.shape[-1]
    dp = kept.of(EQPS, history) - kept.of(EQPS, history_n)
    rate = dp / dt if dt > 0.0 else np.zeros_like(dp)
    ends = [
        law.flow_stress(np.ascontiguousarray(kept.of(EQPS, h)), rate, temperature(material, kept, h, t))[0]
        for h, t in zip((history_n, history), given, strict=True)
    ]
    if factor is not None:
        ends = [flow * part for flow, part in zip(ends, factor, strict=True)]
    work = 0.5 * (ends[0] + ends[1]) * dp
    if material.kinematic is not None:
        before, after = (back_stress(kept, h, components) for h in (history_n, history))
        flows = dp > 0.0
        shifted = np.ascontiguousarray((stress - after)[flows])
        gradient = make_yield_function(material.yield_function).evaluate(shifted)[1]
        work[flows] += (0.5 * (before + after)[flows] * gradient).sum(axis=1) * dp[flows]
    return np.asarray(work)


def present_young(material: Material, eqps: FloatArray, given: FloatArray | None = None) -> FloatArray | float:
    """Return Young's modulus [MPa] at equivalent plastic strains of any shape, and at temperatures [degrees C]."""
    young: FloatArray | float = material.young
    if material.young_decrease is not None:
        saturated, rate = material.young_decrease
        young = np.asarray(saturated + (material.young - saturated) * np.exp(-rate * eqps))
    if material.thermoelastic is None or given is None:
        return young
    return np.asarray(young * find_young_factor(material.thermoelastic, given))


class _Arguments(TypedDict):
    young: float
    poisson: float
    yield_function: _core.YieldFunction
    hardening: _core.HardeningLaw
    parameters: list[float]
    rate: _core.RateLaw
    rate_parameters: Mapping[str, float]
    chaboche: _core.Chaboche | None
    yoshida_uemori: _core.YoshidaUemori | None
    thermal: _core.Thermal | None
    young_saturated: float
    young_rate: float
    expansion: list[float]
    young_factor: list[float]
    poisson_curve: list[float]


def _arguments_of_solid(material: Material) -> _Arguments:
    arguments = _arguments(material)
    if arguments["yield_function"].of_plane_stress_alone:
        assert material.yield_function is not None
        raise ValueError(f"{material.yield_function.law} is a yield function of plane stress alone")
    return arguments


def _arguments(material: Material) -> _Arguments:
    """Return what all the compiled laws are made from."""
    assert material.hardening is not None, "a UMAT is opened, not made"
    hardening, parameters = make_hardening(material.hardening)
    chaboche = yoshida_uemori = None
    if material.kinematic is not None:
        p = material.kinematic.parameters
        if material.kinematic.law == "chaboche":
            chaboche = _core.Chaboche(**p)
        else:
            named = {name: value for name, (value,) in p.items()}
            yoshida_uemori = _core.YoshidaUemori(Y=material.hardening.named()["yield_stress"], **named)
    saturated, falling = material.young_decrease or (0.0, 0.0)
    expansion, young_factor, poisson = make_curves(material.thermoelastic)
    return {
        "young": material.young,
        "poisson": material.poisson,
        "yield_function": make_yield_function(material.yield_function),
        "hardening": hardening,
        "parameters": parameters,
        "rate": _core.RateLaw[material.rate.law if material.rate else "none"],
        "rate_parameters": material.rate.parameters if material.rate else {},
        "chaboche": chaboche,
        "yoshida_uemori": yoshida_uemori,
        "thermal": make_thermal(material),
        "young_saturated": saturated,
        "young_rate": falling,
        "expansion": expansion,
        "young_factor": young_factor,
        "poisson_curve": poisson,
    }
