# SPDX-License-Identifier: Apache-2.0
"""From sticking to slipping against a closed form: a long elastic strip pushed at its end along a tool.

The strip, t thick, lies between a frictionless symmetry plane and a tool with constant shear friction tau, so that it
cannot get thicker: its modulus along is E_u = E (1 - nu) / ((1 + nu)(1 - 2 nu)). From the pushed end a front runs in,
behind which the strip slips and before which it sticks, unstressed. With stress s at the end the front is at s t / tau,
and the end has moved by u = s^2 t / (2 E_u tau) (equilibrium t ds/dx = tau, integrated twice; the shear-lag of pull-out
tests). Pulled back by v, friction turns round from the end on, by Masing's rule: the stress falls by
2 sqrt(E_u tau v / t).
"""

from functools import cache

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays

YOUNG, POISSON, YIELD = 200e3, 0.3, 1e4
MODULUS = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
LENGTH, THICKNESS, FRONT = 80.0, 1.0, 50.0
SHEAR = 5.0
STRESS = SHEAR * FRONT / THICKNESS
WAY = STRESS**2 * THICKNESS / (2 * MODULUS * SHEAR)


@cache
def push_strip(element: str) -> tuple[list[float], list[np.ndarray]]:
    """Push the end by WAY, then back by half of it; the end's stress and every node's friction after each stage."""
    moves = (WAY, -0.5 * WAY)
    case = Case(
        title="strip",
        analysis="plane_strain",
        workpiece={
            "material": "steel",
            "element": element,
            "mesh": {"kind": "rectangle", "size": [LENGTH, THICKNESS], "cells": [160, 2]},
        },
        materials={
            "steel": {"young": YOUNG, "poisson": POISSON, "hardening": {"law": "linear", "yield_stress": YIELD}}
        },
        tools={
            "tool": {
                "profile": [[-5, THICKNESS], [LENGTH + 5, THICKNESS]],
                "contact": "shear",
                "m": SHEAR * np.sqrt(3) / YIELD,
            }
        },
        boundary={"middle": {"set": "bottom", "fix": ["y"]}},
        stages=[
            {"name": f"stage {i}", "displacement": [{"set": "left", "component": "x", "value": move}]}
            for i, move in enumerate(moves)
        ],
        solver={"max_increment": 0.1, "initial_increment": 0.1, "force_tolerance": 1e-8, "max_iterations": 60},
    )
    procedure = ImplicitProcedure(build_model(case), threads=1)
    model = procedure.model
    stresses, drags = [], []
    for report in procedure.advance():
        if report.fraction == 1.0:
            stresses.append(float(procedure.state.nodes.reaction[model.mesh.node_sets["left"], 0].sum()) / THICKNESS)
            drags.append(procedure.state[ContactArrays].drag.copy())
    return stresses, drags


@pytest.mark.parametrize("element", ["quad4_fbar", "quad8_2x2", "tri6_7pt"])
def test_the_slip_front_has_run_as_far_as_the_closed_form_says(element) -> None:
    (stress, _), (drag, _) = push_strip(element)
    assert stress == pytest.approx(STRESS, rel=0.01)
    assert np.abs(drag).sum() / SHEAR == pytest.approx(FRONT, rel=0.01), "length of the zone that slips"


@pytest.mark.parametrize("element", ["quad4_fbar", "quad8_2x2", "tri6_7pt"])
def test_friction_turns_round_by_masings_rule(element) -> None:
    (_, stress), _ = push_strip(element)
    fall = 2 * np.sqrt(MODULUS * SHEAR * 0.5 * WAY / THICKNESS)
    assert stress - STRESS == pytest.approx(-fall, rel=0.01)
