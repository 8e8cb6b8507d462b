# SPDX-License-Identifier: Apache-2.0
"""Laws from shared libraries in hot forming: the temperature that they are given, and the heat that they tell."""

from pathlib import Path

import numpy as np
import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.umat import compile_law
from tests.verification.test_heat_of_forming import ENTHALPY

SOURCE = Path(__file__).parents[1] / "data" / "umat" / "mises_hot.c"
THERMAL = {"conductivity": 30, "specific_heat": "586 J/(kg*K)"}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of data/umat/mises_hot.c."""
    return compile_law(SOURCE, tmp_path_factory.mktemp("umat") / "mises_hot.so")


def describe(library: Path, tells: int, **changes: object) -> Case:
    """Return the upsetting of a cylinder by 60 % without friction; tells: the last property of mises_hot.c."""
    steel = {
        "umat": str(library),
        "props": [200e3, 0.3, 700, 20, 520, tells],
        "state_variables": 1,
        "plastic_strain": 1,
        "density": "7833 kg/m^3",
        "thermal": THERMAL,
    }
    return Case.model_validate(
        {
            "title": "upsetting",
            "analysis": "axisymmetric",
            "workpiece": {"material": "steel", "mesh": {"size": [10, 15], "cells": [2, 3]}},
            "materials": {"steel": steel},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
            "tools": {"punch": {"profile": [[0, 15], [40, 15]], "contact": "frictionless"}},
            "heat": {"initial_temperature": 20, "tolerance": 0.1},
            "stages": [{"name": "upset", "duration": 1, "tools": {"punch": {"stroke": 9, "direction": [0, -1]}}}],
            "solver": {"max_increment": 0.01},
            **changes,
        }
    )


@pytest.mark.parametrize("tells", [0, 1, 2], ids=["nothing", "SPD", "RPL"])
def test_a_umat_softens_by_the_heat_that_it_makes(library: Path, tells: int) -> None:
    """1 - T* falls by exp(-0.9 s0 e / (rho c (TM - T0))), whether the routine tells SPD, RPL or nothing."""
    done = ImplicitProcedure(build_model(describe(library, tells)), threads=1)
    for _ in done.advance():
        pass
    closed = 500 * (1 - np.exp(-0.9 * 700 * np.log(1 / 0.4) / (ENTHALPY * 500)))
    rise = done.state[HeatArrays].temperature - 20
    assert np.ptp(rise) < 1e-3
    assert rise.mean() == pytest.approx(closed, rel=6e-3), "elastic strain is 0.4 % of the way"
    stress = done.state.cells.stress[0][..., 1]
    assert -stress == pytest.approx(700 * (1 - rise.mean() / 500), rel=1e-3), "it is given the temperature at the end"
    assert done.heat is not None
    heat = done.state[HeatArrays].heat
    assert done.heat.forming.stored(done.state[HeatArrays]) == pytest.approx(heat.sum(), rel=1e-8)


@pytest.mark.parametrize(
    ("changes", "where", "what"),
    [
        ({"procedure": "explicit"}, "materials.steel.umat", "computes no heat with a UMAT"),
        (
            {"procedure": "explicit", "heat": {"initial_temperature": 20, "max_change": 5}},
            "heat.max_change",
            "is for the implicit procedure",
        ),
        ({"heat": None}, "materials.steel.thermal", "has no meaning without [heat]"),
        ({"analysis": "plane_strain", "procedure": "explicit"}, "materials.steel.umat", "computes no heat with a UMAT"),
    ],
)
def test_where_a_umat_knows_no_heat_is_told(library: Path, changes, where, what) -> None:
    with pytest.raises(CaseError) as refused:
        build_model(describe(library, 0, **changes))
    assert where in str(refused.value)
    assert what in str(refused.value)
