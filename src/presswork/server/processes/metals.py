# SPDX-License-Identifier: Apache-2.0
"""Materials of the library as a case of forming takes them: cold by name, hot with what the library does not have."""

from __future__ import annotations

from presswork.case.material.library import list_sheets
from presswork.server.processes.questions import Data

COLD = ("low_carbon_steel", "c45", "42crmo4", "stainless_304", "aa6061_o", "copper_ofhc", "brass_cartridge")
"""Offered first for solids at room temperature."""
HOT = ("c45_hot", "c20_hot", "medium_carbon_steel_hot", "aa6082_hot", "aa7075_hot", "ti6al4v", "inconel_718")
"""Offered first for hot forging."""
SHEETS = ("dc04", "dc01", "dx54", "hc340la", "dp600", "dp980", "aa6016_t4", "aa5182_o", "stainless_304")
"""Offered first for sheet metal."""
# EN 1993-1-2 (2005), 3.4.1: carbon steel; constant beyond 1300 degrees C
_STEEL = {
    "density": "7850 kg/m^3",
    "thermal": {
        "conductivity": [[20, 53.3], [200, 47.3], [400, 40.7], [600, 34.0], [800, 27.3], [1300, 27.3]],
        "specific_heat": [
            [20, "440 J/(kg*K)"],
            [400, "606 J/(kg*K)"],
            [650, "814 J/(kg*K)"],
            [900, "650 J/(kg*K)"],
            [1300, "650 J/(kg*K)"],
        ],
    },
}
_TIME = 0.2
"""Duration of a stage whose material depends on rate or temperature [s]: about that in a press."""
_EXPANSION = {"aa": 2.35e-5, "ti": 8.6e-6, "br": 1.9e-5, "co": 1.7e-5, "in": 1.3e-5, "st": 1.2e-5}
"""Coefficient of thermal expansion about room temperature [1/K], by the first letters of a name; steel's otherwise."""


def make_hot(name: str) -> Data:
    """Return the table of a material that takes heat up: with density and thermal data of steel where it has none."""
    given = _read_library(name)
    return {"library": name, **{key: value for key, value in _STEEL.items() if key not in given}}


def set_cold(data: Data, name: str) -> None:
    """Make a solid of a material, from room temperature on; one that softens with heat takes it up within a time."""
    data["workpiece"]["material"] = name
    given = _read_library(name)
    if not (given.keys() & {"thermal", "heating", "rate", "density"}):
        return
    data["materials"] = {name: make_hot(name)}
    data["heat"] = {"initial_temperature": 20}
    for stage in data["stages"]:
        stage["duration"] = _TIME


def _read_library(name: str) -> Data:
    """Return what the library has of a material; empty for one that is not in it."""
    sheet = next((sheet for sheet in list_sheets() if sheet.key == name), None)
    return sheet.material.model_dump(exclude_none=True, exclude_defaults=True) if sheet is not None else {}


def find_expansion(name: str) -> float:
    """Return the coefficient of thermal expansion of a metal of the library [1/K]."""
    return _EXPANSION.get(name[:2], _EXPANSION["st"])
