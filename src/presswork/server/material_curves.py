# SPDX-License-Identifier: Apache-2.0
"""The curves of a material as an editor shows them."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.case import CaseError
from presswork.case.material.forming_limit.build import build_formability
from presswork.case.material.library import find_sheet, list_keys
from presswork.case.material.sheet import SheetLaws, check_sheet_material
from presswork.case.units import LENGTH, to_number

_LARGEST_STRAIN = 0.8
_THICKNESS = 1.0
"""Thickness of the sheet that a forming limit is shown for where no blank has one [mm]."""


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
    except (CaseError, ValueError, TypeError):
        return {}
    found = {"title": title, "strain": strain.tolist(), "stress": stress.tolist(), "sources": sources}
    return {**found, **_describe_limit(laws, asked.get("thickness"))}


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
