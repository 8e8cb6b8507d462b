# SPDX-License-Identifier: Apache-2.0
"""From a Model's material to the compiled law of a sheet, or of a solid with a sheet's laws."""

from __future__ import annotations

from typing import Any

from presswork import _core
from presswork.model import Material, YieldFunction

VON_MISES = (0.5, 0.5, 0.5, 1.5, 1.5, 1.5)
"""Hill's F, G, H, L, M, N that make von Mises."""


def make_yield_function(chosen: YieldFunction | None) -> _core.YieldFunction:
    """Return the compiled yield function: von Mises if none is chosen."""
    if chosen is None:
        return _core.YieldFunction.hill1948(VON_MISES)
    if chosen.law == "hill1948":
        return _core.YieldFunction.hill1948(chosen.parameters)
    if chosen.law == "barlat1989":
        a, c, h, p = chosen.parameters
        return _core.YieldFunction.barlat1989(a, c, h, p, chosen.exponent)
    return _core.YieldFunction.yld2000(chosen.parameters, chosen.exponent)


def make_sheet_law(material: Material) -> _core.SheetLaw:
    """Return the compiled law in plane stress."""
    yields, flow = make_yield_function(material.yield_function), _flow(material)
    return _core.SheetLaw(material.young, material.poisson, yields, *flow, **_options(material))


def make_solid_law(material: Material) -> _core.SolidLaw:
    """Return the compiled law in three dimensions: von Mises or Hill 1948. Raises ValueError for other functions."""
    chosen = material.yield_function
    if chosen is not None and chosen.law != "hill1948":
        raise ValueError(f"{chosen.law} is a yield function of plane stress alone")
    parameters = VON_MISES if chosen is None else chosen.parameters
    return _core.SolidLaw(material.young, material.poisson, parameters, *_flow(material), **_options(material))


def _flow(material: Material) -> tuple[_core.HardeningLaw, list[float]]:
    assert material.hardening is not None, "a sheet takes no UMAT"
    return _core.HardeningLaw[material.hardening.law], [float(p) for p in material.hardening.parameters]


def _options(material: Material) -> dict[str, Any]:
    """Return back stresses, rate and falling modulus by the names of the compiled law's arguments."""
    chaboche = yoshida_uemori = None
    if material.kinematic is not None:
        p = material.kinematic.parameters
        if material.kinematic.law == "chaboche":
            chaboche = _core.Chaboche(p[: len(p) // 2], p[len(p) // 2 :])
        else:
            names = ("B", "C", "m", "b", "Rsat", "h")
            assert material.hardening is not None
            size = float(material.hardening.parameters[0])
            yoshida_uemori = _core.YoshidaUemori(Y=size, **dict(zip(names, p, strict=True)))
    saturated, falling = material.young_decrease or (0.0, 0.0)
    return {
        "rate": _core.RateLaw[material.rate.law] if material.rate else _core.RateLaw.none,
        "rate_parameters": material.rate.parameters if material.rate else (0.0, 1.0),
        "chaboche": chaboche,
        "yoshida_uemori": yoshida_uemori,
        "young_saturated": saturated,
        "young_rate": falling,
    }
