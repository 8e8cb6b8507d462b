# SPDX-License-Identifier: Apache-2.0
"""A test machine's file as a material: laws fitted to it, shown beside what was measured, and saved beside the case."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from presswork.case.units import DENSITY, HEAT_CAPACITY, LENGTH, STRESS, Dimension, to_number
from presswork.material.compression import correct, find_hot_head, read_compression
from presswork.material.cyclic import is_cyclic, read_cyclic
from presswork.material.fit_laws import (
    fit_hot_laws,
    fit_laws,
    make_cyclic_material,
    make_hot_material,
    make_tensile_material,
    pick_rolling_direction,
)
from presswork.material.identify_cyclic import fit_cyclic
from presswork.material.measured_file import read_measured_file
from presswork.material.specimen_facts import Sizes
from presswork.material.tensile import read_tensile
from presswork.model import FloatArray
from presswork.results.whole_file import write_whole

YOUNG, HOT_YOUNG, POISSON = 206e3, 100e3, 0.3
"""Steel's, cold and hot [MPa], where none is given."""
MOST_SHOWN = 120
"""Measured points of a curve that a page shows."""
EXTRAPOLATED = 1.0
"""Plastic strain to which laws of tensile tests are drawn."""
MOST_CURVES = 9


def fit_test(path: Path, asked: dict[str, Any], target: Path | None = None) -> dict[str, Any]:
    """Fit the laws to tensile or hot compression tests, or to one with reversals; write a material file to a target.

    asked: young, thickness, width, gauge_length, density, specific_heat as texts, and law, the one that is taken; what
    is empty is not given. Returns kind, notes, laws and curves as the page shows them. Raises CaseError,
    PydanticCustomError for what is no quantity.
    """
    is_hot = find_hot_head(read_measured_file(path)) is not None
    young = _read(asked, "young", STRESS)
    elastic = {"young": (HOT_YOUNG if is_hot else YOUNG) if young is None else young, "poisson": POISSON}
    if is_hot:
        found, data = _fit_hot(path, asked, elastic)
    elif is_cyclic(path):
        found, data = _fit_reversals(path, asked, elastic)
    else:
        found, data = _fit_tensile(path, asked, elastic)
    if target is not None:
        write_whole(target, tomli_w.dumps(data).encode())
    return found


def _read(asked: dict[str, Any], key: str, dimension: Dimension) -> float | None:
    text = str(asked.get(key) or "").strip()
    if not text:
        return None
    return to_number(float(text) if text.replace(".", "", 1).isdigit() else text, dimension)


def _fit_tensile(path: Path, asked: dict[str, Any], elastic: dict[str, float]) -> tuple[dict[str, Any], dict[str, Any]]:
    sizes = Sizes(**{key: _read(asked, key, LENGTH) for key in ("thickness", "width", "gauge_length")})
    read = read_tensile([path], sizes, elastic["young"])
    along = pick_rolling_direction(read.tests, path)
    fits = _put_first(fit_laws(along, "all", elastic["young"]), asked)
    strain, stress = along.plastic_strain(elastic["young"]), along.stress
    kept = strain >= 0.0
    line = np.linspace(0.0, EXTRAPOLATED, 101)
    curves = [
        {"label": "measured", "x": _thin(strain[kept]), "y": _thin(stress[kept]), "is_measured": True},
        *({"label": fit.law, "x": line.tolist(), "y": fit.stress(line).tolist()} for fit in fits[:4]),
    ]
    laws = [_describe(fit.law, fit.parameters, fit.scatter, fit.relative) for fit in fits]
    found = {"kind": "tensile test", "notes": list(read.notes), "laws": laws, "curves": curves}
    return found, make_tensile_material([path], fits[0], dict(elastic), None)


def _fit_hot(path: Path, asked: dict[str, Any], elastic: dict[str, float]) -> tuple[dict[str, Any], dict[str, Any]]:
    density, heat = _read(asked, "density", DENSITY), _read(asked, "specific_heat", HEAT_CAPACITY)
    capacity = None if density is None or heat is None else density * heat
    tests = correct(read_compression(path), capacity)
    fits, faults = fit_hot_laws(tests, "all")
    fits = _put_first(fits, asked)
    best, every = fits[0], max(1, -(-len(tests) // MOST_CURVES))
    curves = []
    for test in tests[::every]:
        label = f"{test.start:g} °C, {test.rate:g} 1/s"
        curves.append({"label": label, "x": _thin(test.strain), "y": _thin(test.stress), "is_measured": True})
        fitted = best.stress(test.strain, test.rate, test.temperature)
        curves.append({"label": f"{label}: {best.law}", "x": _thin(test.strain), "y": _thin(fitted)})
    notes = [f"{len(tests)} hot compression tests", *(f"left out: {fault}" for fault in faults)]
    if capacity is None:
        notes.append("heating in the test is not corrected: give density and specific heat")
    laws = [_describe(fit.law, dict(fit.parameters), fit.scatter, fit.relative) for fit in fits]
    data = make_hot_material(path, best, dict(elastic), is_heated=capacity is not None)
    return {"kind": "hot compression", "notes": notes, "laws": laws, "curves": curves}, data


def _fit_reversals(
    path: Path, asked: dict[str, Any], elastic: dict[str, float]
) -> tuple[dict[str, Any], dict[str, Any]]:
    test = read_cyclic(
        path, Sizes(**{key: _read(asked, key, LENGTH) for key in ("thickness", "width", "gauge_length")})
    )
    fits = _put_first(fit_cyclic(test, "all", elastic["young"]), asked)
    strain, stress = (np.concatenate([getattr(b, name) for b in test.branches]) for name in ("strain", "stress"))
    curves: list[dict[str, Any]] = [
        {"label": "measured", "x": _thin(strain), "y": _thin(stress), "is_measured": True},
        *({"label": fit.law, "x": strain.tolist(), "y": np.concatenate(fit.stress).tolist()} for fit in fits),
    ]
    top = float(np.abs(stress).max())
    laws = [
        _describe(fit.law, dict(fit.parameters), fit.find_error(fitted=True), fit.find_error(fitted=True) / top)
        for fit in fits
    ]
    notes = [test.how, f"{len(test.branches)} branches between reversals"]
    found = {"kind": "tension and compression", "notes": notes, "laws": laws, "curves": curves}
    return found, make_cyclic_material(path, fits[0], elastic)


def _put_first(fits: list[Any], asked: dict[str, Any]) -> list[Any]:
    """Return fits with the law that was asked for first, the others in their order."""
    return sorted(fits, key=lambda fit: fit.law != asked.get("law"))


def _describe(law: str, parameters: dict[str, Any], scatter: float, relative: float) -> dict[str, Any]:
    texts = [f"{key} = {value:.4g}" for key, value in parameters.items() if isinstance(value, float | int) and value]
    return {"law": law, "parameters": ", ".join(texts), "scatter": scatter, "relative": relative}


def _thin(values: FloatArray) -> list[float]:
    every = max(1, len(values) // MOST_SHOWN)
    return [float(value) for value in values[::every]]
