# SPDX-License-Identifier: Apache-2.0
"""Heat of formed bodies and sheets: the range of temperature, heat stored and heat come in, their balance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from presswork.body.heat import Conduction
from presswork.body.sheet_heat import SheetConduction
from presswork.implicit.heat_of_forming import DIE_KINDS, KINDS, HeatArrays, HeatOfForming
from presswork.interaction.heat.heat_of_sheet import KINDS as SHEET_KINDS
from presswork.model import FloatArray, IntArray, Model
from presswork.observe.contract import History, Observed, Observer, Row

JOULE = 1e-3
"""Value of 1 N mm in J."""


class HeatOfBodies(Observer):
    """Heat of solids that are formed, and of tools that conduct."""

    def columns(self, run: Observed) -> list[str]:
        """Return temperatures, heat stored and come in, and the hottest place of each tool that warms up."""
        if (heat := run.body_heat()) is None:
            return []
        forming, own = heat
        hottest = [f"{name}.temperature_max" for name in forming.hottest(own)]
        return [*heat_columns(KINDS), *hottest, *(["dies_heat_stored"] if forming.dies.dies else [])]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return what `columns` names."""
        if (heat := run.body_heat()) is None:
            return {}
        forming, own = heat
        row = measure_heat(forming.conduction, own.temperature, forming.stored(own), KINDS, own.heat)
        row |= {f"{name}.temperature_max": value for name, value in forming.hottest(own).items()}
        return row | ({"dies_heat_stored": forming.stored_in_dies(own)} if forming.dies.dies else {})

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the balance of heat."""
        if (heat := run.body_heat()) is None:
            return {}
        forming, own = heat
        found: dict[str, Any] = summarise_heat(forming.stored(own), KINDS, own.heat)
        if forming.dies.dies:
            found["dies"] = summarise_heat(forming.stored_in_dies(own), DIE_KINDS, own.die_heat)
        return {"heat": found}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return which tables of materials their temperatures have left."""
        heat = run.body_heat()
        return [] if heat is None else warn_of_tables(run.model, heat[1].reached)


class HeatOfSheets(Observer):
    """Heat of a sheet that is stamped."""

    def columns(self, run: Observed) -> list[str]:
        """Return temperatures, heat stored and come in, the hottest place of each tool, and martensite."""
        if (heat := run.sheet_heat()) is None:
            return []
        sheet, own = heat
        phases = ["martensite_min", "martensite_mean"] if sheet.has_phases else []
        return [*heat_columns(SHEET_KINDS), *(f"{name}.temperature_max" for name in sheet.hottest(own)), *phases]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return what `columns` names."""
        if (heat := run.sheet_heat()) is None:
            return {}
        sheet, own = heat
        row = measure_heat(sheet.conduction, own.temperature, sheet.stored(own), SHEET_KINDS, own.heat)
        row |= {f"{name}.temperature_max": degrees for name, degrees in sheet.hottest(own).items()}
        if sheet.has_phases:
            martensite = own.fractions[3]
            mean = sheet.conduction.mean(martensite)
            row |= {"martensite_min": float(martensite.min()), "martensite_mean": mean}
        return row

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the balance of heat."""
        if (heat := run.sheet_heat()) is None:
            return {}
        return {"heat": summarise_heat(heat[0].stored(heat[1]), SHEET_KINDS, heat[1].heat)}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return which tables of materials their temperatures have left."""
        if run.sheet_heat() is None:
            return []
        ends = history["temperature_min"].min(initial=np.inf), history["temperature_max"].max(initial=-np.inf)
        return warn_of_tables(run.model, np.tile(ends, (len(run.model.materials), 1)))


def heat_columns(kinds: Sequence[str]) -> list[str]:
    """Return the columns of history.csv. kinds: kinds of heat that comes in."""
    temperatures = ["temperature_min", "temperature_mean", "temperature_max"]
    return [*temperatures, "heat_stored", *(f"heat_{kind}" for kind in kinds)]


def measure_heat(
    conduction: Conduction | SheetConduction,
    temperature: FloatArray,
    stored: float,
    kinds: Sequence[str],
    heat: FloatArray,
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


def summarise_heat(stored: float, kinds: Sequence[str], heat: FloatArray) -> dict[str, float]:
    """Return heat stored and come in [J], and what is missing between them over the largest."""
    largest = float(np.abs(heat).max())
    return {
        "stored_j": JOULE * stored,
        **{f"{kind}_j": JOULE * float(value) for kind, value in zip(kinds, heat, strict=True)},
        "balance_error": abs(stored - float(heat.sum())) / largest if largest else 0.0,
    }


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
