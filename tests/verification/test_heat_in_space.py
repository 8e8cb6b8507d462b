# SPDX-License-Identifier: Apache-2.0
"""Heat of solids in space as they are formed: adiabatic compression, a block that cools on all sides."""

import numpy as np
import pytest
from scipy.optimize import brentq

from presswork.case import CaseError, build_model
from presswork.case.space.schema import SpaceCase
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from tests.verification.test_heat_of_forming import ENTHALPY

STEEL = {
    "young": "200e3 GPa",
    "poisson": 0.3,
    "magnitudes": "any",
    "density": "7833 kg/m^3",
    "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
    "thermal": {"conductivity": 30, "specific_heat": "586 J/(kg*K)"},
}
PLANES = {name: {"set": name, "fix": [axis]} for name, axis in (("left", "x"), ("bottom", "y"), ("back", "z"))}


def describe(**changes: object) -> SpaceCase:
    """Return a case of an eighth of a block, its symmetry planes held."""
    case = {
        "title": "block",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 15, 8], "cells": [2, 3, 2]}},
        "materials": {"steel": STEEL},
        "boundary": PLANES,
        "heat": {"initial_temperature": 20},
        "stages": [{"name": "upset", "duration": 1, "displacement": [{"set": "top", "component": "y", "value": -9}]}],
        "solver": {"max_increment": 0.02},
        **changes,
    }
    return SpaceCase.model_validate(case)


def compute(**changes: object) -> ImplicitProcedure:
    procedure = ImplicitProcedure(build_model(describe(**changes)), threads=1)
    for _ in procedure.advance():
        pass
    assert procedure.heat is not None
    arrays = procedure.state[HeatArrays]
    error = procedure.heat.forming.stored(arrays) - arrays.heat.sum()
    assert abs(error) < 1e-8 * np.abs(arrays.heat).max()
    return procedure


@pytest.mark.parametrize("element", ["hex8", "hex8_fbar", "tet4_mini"])
def test_adiabatic_compression(element: str) -> None:
    """700 + 300 e to 60 %, nine tenths of the work, density 7833, specific heat 586: 150.45 K."""
    strain = np.log(1 / 0.4)
    closed = 0.9 * (700 * strain + 150 * strain**2) / ENTHALPY
    piece = {"material": "steel", "element": element, "mesh": {"size": [10, 15, 8], "cells": [2, 3, 2]}}
    rise = compute(workpiece=piece).state[HeatArrays].temperature - 20
    assert np.ptp(rise) < 1e-6
    assert rise.mean() == pytest.approx(closed, rel=1e-3)


def test_a_law_softens_by_the_heat_that_it_makes() -> None:
    """1 - T* falls by exp(-0.9 s0 e / (rho c (Tm - T0)))."""
    heating = {"melting": 520, "exponent": 1.0, "reference": 20}
    steel = STEEL | {"heating": heating, "hardening": {"law": "linear", "yield_stress": 700, "modulus": 0}}
    done = compute(materials={"steel": steel}, solver={"max_increment": 0.01})
    closed = 500 * (1 - np.exp(-0.9 * 700 * np.log(1 / 0.4) / (ENTHALPY * 500)))
    assert (done.state[HeatArrays].temperature - 20).mean() == pytest.approx(closed, rel=2e-3)


def cool(half: float, h: float, time: float, at: float) -> float:
    """Return the part left of the first difference in a plate of a half thickness [mm] that gives h [kW/m2K] away.

    Carslaw & Jaeger 1959, 3.11; a block's is the product of three.
    """
    biot, diffusivity = h * half / 30, 30 / ENTHALPY
    roots = [brentq(lambda b: b * np.tan(b) - biot, n * np.pi, (n + 0.5) * np.pi - 1e-12) for n in range(30)]
    terms = [
        2 * np.sin(b) / (b + np.sin(b) * np.cos(b)) * np.cos(b * at / half)
        * np.exp(-(b**2) * diffusivity * time / half**2)
        for b in roots
    ]  # fmt: skip
    return float(np.sum(terms))


@pytest.mark.parametrize("element", ["hex8_fbar", pytest.param("tet4_mini", marks=pytest.mark.validation)])
def test_a_block_cools_on_all_sides(element: str) -> None:
    """A block of 20 x 30 x 16 mm at 1000 degrees C, 5 kW/m2K to 20, after 2 s: middle, and middles of its faces."""
    size, time = (10.0, 15.0, 8.0), 2.0
    done = compute(
        workpiece={
            "material": "steel",
            "element": element,
            "mesh": {"size": size, "cells": [12, 14, 10], "grading": [0.4, 0.4, 0.4]},
        },
        heat={
            "initial_temperature": 1000,
            "tolerance": 0.1,
            "surroundings": {"ambient": 20, "coefficient": "5 kW/(m^2*K)"},
        },
        stages=[{"name": "cool", "duration": time}],
        solver={"max_increment": 0.05},
    )
    points, degrees = done.model.mesh.points, done.state[HeatArrays].temperature
    for place in ((0, 0, 0), (10, 0, 0), (0, 15, 0), (0, 0, 8)):
        node = int(np.argmin(np.linalg.norm(points - place, axis=1)))
        closed = 20 + 980 * np.prod([cool(half, 5.0, time, at) for half, at in zip(size, place, strict=True)])
        assert degrees[node] - 20 == pytest.approx(closed - 20, rel=1e-2), place


@pytest.mark.parametrize(
    ("changes", "where", "what"),
    [
        ({"heat": None}, "materials.steel.thermal", "has no meaning without [heat]"),
        ({"stages": [{"name": "cool"}]}, "stages.0.duration", "heat needs a duration"),
    ],
)
def test_bad_heat_in_space_is_told(changes, where, what) -> None:
    with pytest.raises(CaseError) as refused:
        build_model(describe(**changes))
    assert where in str(refused.value)
    assert what in str(refused.value)
