# SPDX-License-Identifier: Apache-2.0
"""Rods of random sizes that become martensite under a constant tension, in every family of solids.

The rod cools so slowly that its temperature is even. Its length at the end is that of thermal strain, transformation
strain, elasticity and transformation plasticity; in plane strain, where it is held across, the stress across follows

    d s/E + K s d phi = -d e        e: free growth
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure

YOUNG, K, MS, STRAIN, START, END = 200e3, 1.2e-4, 330.0, 0.009, 400.0, 20.0
AUSTENITE, MARTENSITE = 22e-6, 12e-6


def steel() -> dict[str, Any]:
    return {
        "young": YOUNG,
        "poisson": 0.3,
        "density": "7800 kg/m^3",
        "thermal": {"conductivity": 1e5, "specific_heat": "650 J/(kg*K)"},
        "transformation": {
            "ms": MS,
            "latent_heat": [0.0, 0.0],
            "phases": {
                "austenite": {"expansion": AUSTENITE},
                "martensite": {"expansion": MARTENSITE, "strain": STRAIN, "trip": K},
            },
        },
    }


def rod(family: str, element: str, size: np.ndarray, tension: float) -> dict[str, Any]:
    """Return a case of a rod along y of a size [mm], drawn by a tension [MPa]."""
    space = family == "solid"
    load = "face_force" if space else "edge_force"
    value = [0.0, tension, 0.0] if space else [0.0, tension]
    pull = {load: [{"set": "top", "value": value}]}
    n = 3 if space else 2
    boundary = {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}}
    cool = [{"set": name, "coefficient": 0.5, "ambient": END} for name in ("right", "top")]
    return {
        "title": "rod",
        "analysis": family,
        "workpiece": {
            "material": "steel", "element": element, "mesh": {"size": size[:n].tolist(), "cells": [2, 2, 2][:n]}
        },
        "materials": {"steel": steel()},
        "boundary": boundary | ({"z": {"set": "back", "fix": ["z"]}} if space else {}),
        "heat": {"initial_temperature": START, "tolerance": 0.2, "max_change": 6},
        "stages": [
            {"name": "pull", "duration": 1.0, **pull},
            {"name": "cool", "duration": 400.0, "convection": cool, **pull},
        ],
        "solver": {"initial_increment": 0.01, "max_increment": 0.5, "force_tolerance": 1e-6},
    }  # fmt: skip


def grow(temperature: float) -> tuple[float, float]:
    """Return free growth from the start and phi at a temperature."""
    fraction = 1.0 - np.exp(-0.011 * max(MS - temperature, 0.0))
    soft, hard = AUSTENITE * (temperature - 20.0), MARTENSITE * (temperature - 20.0) + STRAIN
    return (1 - fraction) * soft + fraction * hard - AUSTENITE * (START - 20.0), fraction * (2.0 - fraction)


CASES = [
    ("axisymmetric", "quad4_fbar"),
    ("axisymmetric", "quad8"),
    ("axisymmetric", "quad4_1pt"),
    ("plane_strain", "quad4_fbar"),
    ("solid", "hex8_fbar"),
    ("solid", "tet4_mini"),
]


@pytest.mark.parametrize(("family", "element"), CASES)
def test_a_rod_under_tension_grows_as_the_closed_form_says(family: str, element: str) -> None:
    rng = np.random.default_rng(len(family) + len(element))
    size, tension = rng.uniform(2.0, 9.0, 3), float(rng.uniform(10.0, 30.0))
    kind = SpaceCase if family == "solid" else Case
    procedure = ImplicitProcedure(build_model(kind.model_validate(rod(family, element, size, tension))))
    for _ in procedure.advance():
        pass
    state, mesh = procedure.state, procedure.model.mesh
    degrees = state.cells.temperature[0]
    assert np.ptp(degrees) < 0.5
    free, phi = grow(float(degrees.mean()))
    top = mesh.points[:, 1] > size[1] - 1e-9
    strain = np.log1p(state.nodes.moved[top, 1].mean() / size[1])
    stress = state.cells.stress[0]
    if family != "plane_strain":
        assert strain == pytest.approx(free + tension / YOUNG + K * tension * phi, abs=0.03 * K * tension)
        np.testing.assert_allclose(stress[..., 1], tension, rtol=0.03)
        return
    across, path = 0.0, np.linspace(START, float(degrees.mean()), 4001)
    rows = np.array([grow(t) for t in path])
    plastic = 0.0
    for change, more in np.diff(rows, axis=0):
        # transformation plasticity across: K (s_z - s_y/2) d phi; elasticity: s_z/E - 0.3 s_y/E
        across = (across - YOUNG * (change - 0.5 * K * tension * more)) / (1.0 + YOUNG * K * more)
        plastic += K * (tension - 0.5 * across) * more
    first = 0.3 * tension  # of the pull, held across
    assert float(stress[..., 2].mean()) == pytest.approx(across, rel=0.02, abs=first)
