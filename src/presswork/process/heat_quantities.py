# SPDX-License-Identifier: Apache-2.0
"""What histories and summaries say of heat: the range of temperature, heat stored and heat come in, their balance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.heat import Conduction
from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.interaction.heat_of_sheet import KINDS as SHEET_KINDS
from presswork.interaction.heat_of_sheet import HeatOfSheet, SheetHeatArrays
from presswork.model import FloatArray, IntArray, Model
from presswork.observe.contract import Row

JOULE = 1e-3
"""Of 1 N mm."""


def heat_columns(kinds: Sequence[str]) -> list[str]:
    """Return the columns of history.csv. kinds: ways by which heat comes in."""
    temperatures = ["temperature_min", "temperature_mean", "temperature_max"]
    return [*temperatures, "heat_stored", *(f"heat_{kind}" for kind in kinds)]


def measure_heat(
    conduction: Conduction, temperature: FloatArray, stored: float, kinds: Sequence[str], heat: FloatArray
) -> Row:
    """Return temperatures [degrees C], and heat since the start [N mm]: stored, and come in by kinds."""
    return {
        "temperature_min": float(temperature.min()),
        "temperature_mean": conduction.mean(temperature),
        "temperature_max": float(temperature.max()),
        "heat_stored": stored,
        **{f"heat_{kind}": float(value) for kind, value in zip(kinds, heat, strict=True)},
    }


def show_dies(forming: HeatOfForming, arrays: HeatArrays) -> dict[str, tuple[FloatArray, IntArray, FloatArray]]:
    """Return the meshes of tools that conduct heat, and their temperatures."""
    temperatures = forming.die_temperatures(arrays)
    meshes = {die.name: die.mesh.mesh for die in forming.dies.dies}
    return {name: (mesh.points, mesh.blocks[0].connectivity, temperatures[name]) for name, mesh in meshes.items()}


def columns_of_sheet(sheet: HeatOfSheet, arrays: SheetHeatArrays) -> list[str]:
    """Return the columns of history.csv of a sheet's heat."""
    phases = ["martensite_min", "martensite_mean"] if sheet.has_phases else []
    return [*heat_columns(SHEET_KINDS), *(f"{name}.temperature_max" for name in sheet.hottest(arrays)), *phases]


def measure_sheet_heat(sheet: HeatOfSheet, arrays: SheetHeatArrays) -> Row:
    """Return what `columns_of_sheet` names."""
    conduction = sheet.conduction
    found: Row = {
        "temperature_min": float(arrays.temperature.min()),
        "temperature_mean": conduction.mean(arrays.temperature),
        "temperature_max": float(arrays.temperature.max()),
        "heat_stored": sheet.stored(arrays),
        **{f"heat_{kind}": float(value) for kind, value in zip(SHEET_KINDS, arrays.heat, strict=True)},
        **{f"{name}.temperature_max": degrees for name, degrees in sheet.hottest(arrays).items()},
    }
    if sheet.has_phases:
        martensite = arrays.fractions[3]
        found |= {"martensite_min": float(martensite.min()), "martensite_mean": conduction.mean(martensite)}
    return found


def summarise_sheet_heat(sheet: HeatOfSheet, arrays: SheetHeatArrays) -> dict[str, float]:
    """Return heat stored and come in [J], and what is missing between them over the largest."""
    return summarise_heat(sheet.stored(arrays), SHEET_KINDS, arrays.heat)


def summarise_heat(stored: float, kinds: Sequence[str], heat: FloatArray) -> dict[str, float]:
    """Return heat stored and come in [J], and what is missing between them over the largest."""
    largest = float(np.abs(heat).max())
    return {
        "stored_j": JOULE * stored,
        **{f"{kind}_j": JOULE * float(value) for kind, value in zip(kinds, heat, strict=True)},
        "balance_error": abs(stored - float(heat.sum())) / largest if largest else 0.0,
    }


def ranges_of_sheet(model: Model, history: Mapping[str, NDArray[Any]]) -> FloatArray:
    """Return the lowest and highest temperature of a sheet, for each of its materials (n_materials, 2) [degrees C]."""
    ends = history["temperature_min"].min(initial=np.inf), history["temperature_max"].max(initial=-np.inf)
    return np.tile(ends, (len(model.materials), 1))


def warn_of_tables(model: Model, reached: FloatArray) -> list[str]:
    """Return which tables of materials their temperatures have left, and by how much.

    reached: lowest and highest temperature of each material (n_materials, 2) [degrees C].
    """
    warnings = []
    for number in sorted({block.material for block in model.mesh.blocks}):
        material, (low, high) = model.materials[number], reached[number]
        if material.thermal is None:
            continue
        tables: dict[str, FloatArray] = {
            "conductivity": material.thermal.conductivity,
            "specific_heat": material.thermal.specific_heat,
        }
        for name, table in tables.items():
            first, last = table[0, 0], table[-1, 0]
            if len(table) > 1 and (low < first - 1.0 or high > last + 1.0):
                warnings.append(
                    f"{material.name}: {name} is given from {first:g} to {last:g} degrees C, and its temperatures went "
                    f"from {low:.4g} to {high:.4g}: beyond its ends it was taken as constant"
                )
    return warnings
