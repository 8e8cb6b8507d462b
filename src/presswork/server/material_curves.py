# SPDX-License-Identifier: Apache-2.0
"""The curves of a material as an editor shows them."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.case import CaseError
from presswork.case.material.forming_limit.build import build_formability
from presswork.case.material.library import find_sheet, list_keys, list_sheets
from presswork.case.material.sheet import SheetLaws, check_sheet_material
from presswork.case.units import LENGTH, to_number

_LARGEST_STRAIN = 0.8
_THICKNESS = 1.0
"""Thickness of the sheet that a forming limit is shown for where no blank has one [mm]."""


def list_materials() -> list[dict[str, Any]]:
    """Return the materials of the library: key, name, what it is, and whether it is for hot forming."""
    found = []
    for sheet in list_sheets():
        window = sheet.material.to_model(sheet.key).hardening
        degrees = None if window is None or window.window is None else [float(value) for value in window.window[2]]
        found.append({"key": sheet.key, "name": sheet.name, "summary": sheet.summary, "temperatures": degrees})
    return found


def describe_material(asked: dict[str, Any]) -> dict[str, Any]:
    """Return flow stress over strain, forming limit and sources of a material.

    asked: `own`, a table of a case, or `name`, of the library; `thickness` of the blank. Empty for one that is not
    known, or not complete yet.
    """
    name, own = str(asked.get("name", "")), asked.get("own")
    try:
        if isinstance(own, dict) and "library" not in own:
            laws = check_sheet_material({key: value for key, value in own.items() if key in SheetLaws.model_fields})
            title, sources = name, []
        else:
            key = str(own["library"]) if isinstance(own, dict) else name
            if key not in list_keys():
                return {}
            sheet = find_sheet(key)
            laws, title = sheet.material, f"{sheet.name}: {sheet.summary}"
            sources = [f"{key}: {text}" for key, text in (*sheet.sources.items(), *sheet.assumed.items())]
        strain = np.linspace(0.0, _LARGEST_STRAIN, 161)
        stress = laws.build_law().flow_stress(strain)[0]
        curves = _draw_states(laws, asked)
    except (CaseError, ValueError, TypeError):
        return {}
    found = {"title": title, "strain": strain.tolist(), "stress": stress.tolist(), "sources": sources}
    return {**found, "curves": curves, **_describe_limit(laws, asked.get("thickness"))}


def _draw_states(laws: SheetLaws, asked: dict[str, Any]) -> list[dict[str, Any]]:
    """Return flow stress at the temperatures and rates asked for; none of a law that depends on neither.

    The label of a state beyond the window that a law was fitted in ends with "(extrapolated)".
    """
    hardening = laws.to_model("shown").hardening
    window = None if hardening is None else hardening.window
    if window is None:
        return []
    (low, high), rates, degrees = window
    strain = np.linspace(max(low, 0.0), min(high, _LARGEST_STRAIN), 81)
    law, curves = laws.build_law(), []
    for temperature in [float(value) for value in asked.get("temperatures", [])][:4]:
        for rate in [float(value) for value in asked.get("rates", [])][:3]:
            stress = law.flow_stress(strain, np.full_like(strain, rate), np.full_like(strain, temperature))[0]
            is_outside = not (degrees[0] <= temperature <= degrees[1] and rates[0] <= rate <= rates[1])
            label = f"{temperature:g} °C, {rate:g} 1/s{' (extrapolated)' if is_outside else ''}"
            curves.append({"label": label, "x": strain.tolist(), "y": np.asarray(stress).tolist()})
    return curves


def _describe_limit(laws: SheetLaws, asked: object) -> dict[str, Any]:
    """Return the forming limit of a blank of a thickness, with its safety margin; empty without one."""
    try:
        thickness = float(to_number(asked, LENGTH)) if asked is not None else _THICKNESS
        formability = build_formability(laws, "material", thickness)
    except (CaseError, ValueError, TypeError):
        return {}
    if formability.curve is None:
        return {}
    minor = np.linspace(-0.3, 0.3, 61)
    return {
        "limit": {
            "minor": minor.tolist(),
            "major": formability.curve.limit(minor).tolist(),
            "method": formability.curve.method,
            "margin": formability.safety_margin,
            "thickness": thickness,
            "note": formability.note,
        }
    }
