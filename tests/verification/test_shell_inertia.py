# SPDX-License-Identifier: Apache-2.0
"""Inertia and damping of shells under loads: their force in closed form, and a snap to the tabulated branch beyond."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, ShellCase, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.supports import NotHeldError
from tests.verification.test_shell_large_rotation import TABLES
from tests.verification.test_shell_snap_through import hinged_roof

LENGTH, WIDTH, THICKNESS, DENSITY = 20.0, 10.0, 0.8, 7.85e-9
VELOCITY, DAMPING, DURATION, INCREMENTS = 100.0, 1e5, 0.01, 20


def carried(element: str, **solver: Any) -> ShellCase:
    """A sheet that nothing holds, carried along by one of its edges."""
    section = {"thickness": THICKNESS, "points": 3}
    mesh = {"size": [LENGTH, WIDTH], "cells": [4, 2]}
    steps = {"initial_increment": 1 / INCREMENTS, "max_increment": 1 / INCREMENTS}
    laws = {"hardening": {"law": "linear", "yield_stress": 300, "modulus": 10}, "yield_function": {"law": "von_mises"}}
    return ShellCase(
        title="carried",
        analysis="shell",
        workpiece={"material": "steel", "element": element, "section": section, "mesh": mesh},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "density": DENSITY, **laws}},
        stages=[{"name": "carry", "duration": DURATION,
                 "displacement": [{"set": "left", "component": "x", "value": VELOCITY * DURATION}]}],
        solver={**steps, **solver},
    )  # fmt: skip


@pytest.mark.parametrize("element", ["shell4_mitc_plus", "shell4_1pt", "shell3_mitc", "shell6_mitc", "shell9_mitc"])
def test_damping_of_a_sheet_carried_along_is_its_mass_times_velocity(element) -> None:
    """c m v at the edge that carries it; its work is that times the way, and m v^2 at first, half of which backward
    Euler loses when the velocity jumps.
    """
    with pytest.raises(NotHeldError, match="nothing holds the shell"):
        ImplicitProcedure(build_model(carried(element)), threads=1)
    model = build_model(carried(element, inertia=2.0, damping=DAMPING))
    procedure = ImplicitProcedure(model, threads=1)
    list(procedure.advance())
    mass = 2.0 * DENSITY * LENGTH * WIDTH * THICKNESS
    force = procedure.state.nodes.reaction[model.mesh.node_sets["left"], 0].sum()
    assert force == pytest.approx(DAMPING * mass * VELOCITY, rel=1e-4)
    first = mass * (VELOCITY**2 - 0.5 * DAMPING * VELOCITY**2 * DURATION / INCREMENTS)  # by the trapezoidal rule
    energy = procedure.energy_balance()
    assert energy["inertia_work"] == pytest.approx(first + DAMPING * mass * VELOCITY**2 * DURATION, rel=1e-3)
    assert abs(energy["error_percent"]) < 0.1


def test_a_roof_that_snaps_under_its_load_comes_to_rest_on_the_tabulated_branch() -> None:
    """Under its full load, 1.35 times the limit load of Sze, Liu & Lo (2004)."""
    steps = {"initial_increment": 0.01, "max_increment": 0.01, "symmetric": False}
    slow = [replace(stage, duration=1.0) for stage in hinged_roof(12.7, 6).stages]
    model = replace(hinged_roof(12.7, 6, **steps), stages=tuple(slow))
    heavy = replace(model.materials[0], density=2e-9)
    settings = replace(model.solver, inertia=1.0, damping=1e3)
    procedure = ImplicitProcedure(replace(model, materials=(heavy,), solver=settings), threads=1)
    list(procedure.advance())
    down = -float(procedure.state.nodes.displacement[model.mesh.node_sets["bottom_left"], 2].mean())
    table = np.array(TABLES["hinged_roof"]["thickness_12.7"])
    beyond = table[int(np.argmin(table[:, 0] + (table[:, 1] < 11.0))) :]
    assert down == pytest.approx(float(np.interp(1.0, *beyond.T)), rel=0.01)
    energy = procedure.energy_balance()
    assert energy["inertia_work"] > 0.1 * energy["external_work"], "what the snap sets free"
    assert abs(energy["error_percent"]) < 2.0


def test_inertia_is_refused_where_it_cannot_act() -> None:
    with pytest.raises(CaseError, match=r"solver.inertia.*no time passes.*control = .load."):
        build_model(carried("shell4_mitc_plus", inertia=1.0, control="arc_length"))
    case = carried("shell4_mitc_plus", inertia=1.0)
    odd = case.materials["steel"].model_copy(update={"young": 1.0, "density": None})
    with pytest.raises(CaseError, match=r"materials.steel.density.*missing key.*solver.inertia needs it"):
        build_model(case.model_copy(update={"materials": {"steel": odd}}))
    with pytest.raises(ValueError, match="the density of no metal"):
        odd.model_validate({**odd.model_dump(), "young": 2e5, "density": 7850.0})
