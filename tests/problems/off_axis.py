# SPDX-License-Identifier: Apache-2.0
"""Set-up of tensile specimens cut at an angle to the rolling direction: the mesh stays along x, the sheet is turned."""

from __future__ import annotations

import json

import numpy as np

from presswork.body.shell_arrays import ShellArrays
from presswork.case.material.yield_function import Barlat1989, Hill1948, Yld2000
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Material, Model, YieldFunction
from tests.problems.plane_solids import DATA, linear_hardening

SETS = json.loads((DATA / "yld2000.json").read_text())
YOUNG, POISSON, YIELD, MODULUS = 2e5, 0.3, 200.0, 1000.0
GIVEN = {
    "hill1948": Hill1948(r00=1.79, r45=1.51, r90=2.27),
    "barlat1989": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=8),
    "yld2000": Yld2000(alpha=tuple(SETS["AA2090-T3"]["alpha"]), exponent=8),
}
PARAMETERS = {
    "hill1948": GIVEN["hill1948"].hill_parameters(),
    "barlat1989": GIVEN["barlat1989"].coefficients(),
    "yld2000": GIVEN["yld2000"].alpha,
}


def sheet(name: str, modulus: float = MODULUS) -> Material:
    """Return a sheet with one of the yield functions and linear hardening."""
    function = YieldFunction(name, PARAMETERS[name], 2 if name == "hill1948" else 8)  # type: ignore[arg-type]
    return Material(name, YOUNG, POISSON, linear_hardening(YIELD, modulus), function)


def run_turned(model: Model, angle: float) -> ImplicitProcedure:
    """Run a model along x of a sheet that was turned: x is `angle` [rad] off the rolling direction."""
    procedure = ImplicitProcedure(model, threads=1)
    c, s = np.cos(angle), np.sin(angle)
    for direction in procedure.state[ShellArrays].direction:
        direction[...] = direction @ np.array([[c, s], [-s, c]])
    for _ in procedure.advance():
        pass
    return procedure
