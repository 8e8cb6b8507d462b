# SPDX-License-Identifier: Apache-2.0
"""What a user is told where increments find no equilibrium."""

from dataclasses import replace
from importlib.resources import files

from presswork import build_model
from presswork.case import StampingCase
from presswork.implicit.remedy import find_remedy
from presswork.process.implicit.stamping import make_shell_model


def test_a_sheet_that_snaps_over_is_to_get_its_mass() -> None:
    """Friction leaves no pivots to count: any stamping without inertia is told."""
    path = str(files("presswork").joinpath("examples/draw_bending.toml"))
    model = build_model(StampingCase.from_toml(path, ("procedure=implicit",)))
    assert "set implicit.inertia = 1" in find_remedy(model, 0)
    assert "set implicit.inertia = 1" in find_remedy(make_shell_model(model), 0), "what the run has"
    steadied = replace(model, solver=replace(model.solver, inertia=1.0))
    assert "inertia" not in find_remedy(steadied, 0)
