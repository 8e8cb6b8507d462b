# SPDX-License-Identifier: Apache-2.0
"""A long cylinder, R 20, from 850 into 20 degrees C: stress where it is far from its ends, and that of the table.

The table (tests/data/quench_cylinder.csv) is a one-dimensional computation of 80 elements in generalised plane strain.
"""

from __future__ import annotations

import copy
import csv
from pathlib import Path
from typing import Any

import numpy as np

from presswork.case import Case, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray

TABLE = Path(__file__).parents[1] / "data/quench_cylinder.csv"
RADIUS = 20.0
CASE: dict[str, Any] = {
    "title": "long cylinder, quenched",
    "analysis": "axisymmetric",
    "workpiece": {
        "material": "steel",
        "element": "quad4_fbar",
        "mesh": {"size": [RADIUS, 90.0], "cells": [20, 9], "grading": [0.3, 1.0]},
    },
    "materials": {
        "steel": {
            "young": 200e3,
            "poisson": 0.3,
            "density": "7800 kg/m^3",
            "hardening": {"law": "linear", "yield_stress": 100.0},
            "thermal": {"conductivity": 25.0, "specific_heat": "650 J/(kg*K)"},
        }
    },
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "heat": {"initial_temperature": 850.0, "tolerance": 0.3},
    "stages": [
        {
            "name": "quench",
            "duration": 120.0,
            "convection": [{"set": "right", "coefficient": "3000 W/(m^2*K)", "ambient": 20.0}],
        }
    ],
    "solver": {"initial_increment": 0.0005, "max_increment": 0.05},
}
AUSTENITE = {"expansion": 22e-6, "yield_stress": [[0, 200.0], [1000, 50.0]]}
MARTENSITE = {"expansion": 12e-6, "strain": 0.009, "yield_stress": [[0, 1500.0], [1000, 500.0]]}
KINETICS: dict[str, Any] = {"ms": 330.0, "latent_heat": [0.0, 0.0]}


def cylinder(which: str) -> dict[str, Any]:
    """Return the case of `thermal`, `martensite`, `trip`, or `elastic`: martensite without yield."""
    data = copy.deepcopy(CASE)
    steel = data["materials"]["steel"]
    if which == "thermal":
        steel["expansion"] = {"coefficient": 22e-6}
        steel["hardening"] = {"law": "linear", "yield_stress": 200.0}
        steel["heating"] = {"reference": 0.0, "melting": 200.0 / 0.15, "exponent": 1.0}
        return data
    phases = {"austenite": dict(AUSTENITE), "martensite": MARTENSITE | {"trip": 5e-5 if which == "trip" else 0.0}}
    if which == "elastic":
        del steel["hardening"]
        for phase in phases.values():
            del phase["yield_stress"]
        data["stages"][0]["duration"] = 600.0
    if which == "trip":
        data["heat"]["max_change"] = 6.0
    steel["transformation"] = KINETICS | {"phases": phases}
    return data


def run(data: dict[str, Any]) -> ImplicitProcedure:
    """Return the procedure at the end."""
    procedure = ImplicitProcedure(build_model(Case.model_validate(data)))
    for _ in procedure.advance():
        pass
    return procedure


def read_table(which: str) -> FloatArray:
    """Return r/R, and radial, hoop and axial stress [MPa] (n, 4)."""
    lines = [line for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    rows = [list(row.values()) for row in csv.DictReader(lines) if row["case"] == which]
    return np.array([[float(value) for value in row[1:]] for row in rows])


def find_profile(procedure: ImplicitProcedure, at: FloatArray) -> FloatArray:
    """Return radial, hoop and axial stress [MPa] at r/R (n, 3), of the cells at the plane of symmetry."""
    mesh = procedure.model.mesh
    middle = mesh.points[mesh.blocks[0].connectivity[:, :4]].mean(axis=1)
    low = np.flatnonzero(middle[:, 1] <= middle[:, 1].min() + 1e-9)
    low = low[np.argsort(middle[low, 0])]
    stress = procedure.state.cells.stress[0][low].mean(axis=1)
    return np.column_stack([np.interp(at, middle[low, 0] / RADIUS, stress[:, k]) for k in (0, 2, 1)])
