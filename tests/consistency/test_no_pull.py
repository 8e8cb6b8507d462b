# SPDX-License-Identifier: Apache-2.0
"""No converged increment holds on by a pull, whatever the kind of contact and however large the increment."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.case import StampingCase
from presswork.case import build_model as build_any_model
from presswork.geometry.tool_surface import make_surface
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_contact import RELEASE as RELEASE_OF_SLOTS
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.tool_arrays import ContactArrays, SpaceToolArrays
from presswork.model import FloatArray
from presswork.process.implicit.stamping import make_shell_model
from tests.regression.test_implicit_stamping import CUP

STEEL = {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 200}}
LAWS: dict[str, dict[str, Any]] = {
    "frictionless": {"contact": "frictionless"},
    "sticking": {"contact": "sticking"},
    "shear": {"contact": "shear", "m": 0.2},
    "coulomb": {"contact": "coulomb", "mu": 0.2},
    "coulomb_capped": {"contact": "coulomb_capped", "mu": 0.2, "m": 0.3},
}

HEELS = {"quad4_fbar": 0.2, "quad8_2x2": 0.9, "tri3": 0.3, "tri6_7pt": 0.9}


def block(mesh: dict[str, Any]) -> dict[str, Any]:
    return {"material": "steel", "element": "quad4_fbar", "mesh": mesh}


def press_ball(law: dict[str, Any]) -> ImplicitProcedure:
    """A round tool pressed into a strip that lies on a support, and lifted again, in large increments."""
    ball = [[0.0, 3.0], {"to": [6.0, 9.0], "centre": [0.0, 9.0], "turn": "left"}]
    case = Case(
        title="ball",
        analysis="plane_strain",
        workpiece=block({"size": [8, 3], "cells": [16, 6]}),
        materials={"steel": STEEL},
        tools={"ball": {"profile": ball, **law}},
        boundary={"middle": {"set": "left", "fix": ["x"]}, "floor": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"ball": {"move": [0, -0.3]}}},
                {"name": "lift", "tools": {"ball": {"move": [0, 0.31]}}}],
        solver={"initial_increment": 0.2, "max_increment": 0.2},
    )  # fmt: skip
    return ImplicitProcedure(build_model(case), threads=1)


def press_body(law: dict[str, Any]) -> ImplicitProcedure:
    """A narrow block pressed onto a wide one, drawn along it and lifted."""
    case = Case(
        title="bodies",
        analysis="plane_strain",
        workpiece=block({"size": [12, 3], "cells": [24, 4]}),
        materials={"steel": STEEL},
        bodies={"punch": block({"origin": [3, 3], "size": [4, 2], "cells": [6, 3]})},
        contacts={"joint": {"between": ["punch", "workpiece"], **law}},
        boundary={"floor": {"set": "bottom", "fix": ["x", "y"]}},
        stages=[{"name": "press", "displacement": [
                    {"set": "punch.top", "component": "y", "value": -0.01},
                    {"set": "punch.top", "component": "x", "value": 0}]},
                {"name": "draw", "displacement": [
                    {"set": "punch.top", "component": "y", "value": 0},
                    {"set": "punch.top", "component": "x", "value": 0.2}]}],
        solver={"initial_increment": 0.2, "max_increment": 0.2},
    )  # fmt: skip
    return ImplicitProcedure(build_model(case), threads=1)


def drag_heel(element: str, m: float) -> ImplicitProcedure:
    """The heel of a block dragged under constant shear: it pulls when it is held and comes back when it is let go."""
    case = Case(
        title="heel",
        analysis="plane_strain",
        workpiece=block({"size": [10, 10], "cells": [9, 9]}) | {"element": element},
        materials={"steel": {**STEEL, "hardening": {"law": "linear", "yield_stress": 700, "modulus": 0}}},
        tools={"floor": {"profile": [[-30, 0], [30, 0]], "contact": "shear", "m": m}},
        boundary={"top": {"set": "top", "fix": ["x", "y"]}},
        stages=[{"name": "press", "tools": {"floor": {"move": [0, 0.01]}}},
                {"name": "slide", "tools": {"floor": {"move": [0.1, 0]}}}],
        solver={"initial_increment": 0.1, "max_increment": 0.1},
    )  # fmt: skip
    return ImplicitProcedure(build_model(case), threads=1)


def fold_spring() -> ImplicitProcedure:
    """A strip pressed until it folds onto itself."""
    path = Path(__file__).parents[2] / "src/presswork/examples/self_contact.toml"
    changes = ["workpiece.mesh.cells=[3,40]", "stages.0.tools.punch.stroke=18.5", "solver.max_increment=0.05"]
    return ImplicitProcedure(build_model(Case.from_toml(path, changes)), threads=1)


def draw_sheet() -> ImplicitProcedure:
    """A square cup between punch, die and holder."""
    data = {
        **CUP,
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 1.0}}}],
        "implicit": {"max_increment": 0.1},
    }
    return ImplicitProcedure(make_shell_model(build_any_model(StampingCase.model_validate(data))), threads=1)


def pulls_of_tools(procedure: ImplicitProcedure) -> tuple[FloatArray, float]:
    """Return the normal forces on the held nodes, pushing positive, and what may be left of a pull.

    That is what may be out of balance: the residual's tolerance times the largest nodal force.
    """
    contact, state = procedure.interactions.tools.contact, procedure.state
    contact.search(state, state.nodes.displacement)
    push = contact.normal_forces(state, state.nodes.reaction, procedure.interactions.supports.fixed(0))[
        state[ContactArrays].status > 0
    ]
    return push, procedure.model.solver.force_tolerance * float(state[Progress].peak_force)


def pulls_of_edges(procedure: ImplicitProcedure) -> tuple[FloatArray, float]:
    """The same with mid-sides judged with half the push of their ends, as the contact judges them."""
    _, allowed = pulls_of_tools(procedure)
    contact, state = procedure.interactions.tools.contact, procedure.state
    push = contact.normal_forces(state, state.nodes.reaction, procedure.interactions.supports.fixed(0))
    return contact._judge(push)[state[ContactArrays].status > 0], allowed


def pulls_of_slots(procedure: ImplicitProcedure) -> tuple[FloatArray, float]:
    """Return the pressures of the slots of bodies, and the part of the largest with which a slot may pull that has
    changed too often.
    """
    pressure = procedure.state[InterfaceArrays].pressure
    return pressure, RELEASE_OF_SLOTS * float(pressure.max(initial=0.0))


def pulls_of_sheet_tools(procedure: ImplicitProcedure) -> tuple[FloatArray, float]:
    """Return the forces on the nodes of a sheet along the outward normals of the tools."""
    state, pushes = procedure.state, []
    for tool, force, moved in zip(
        procedure.model.space_tools,
        state[SpaceToolArrays].force - state[SpaceToolArrays].friction,
        state[SpaceToolArrays].displacement,
        strict=True,
    ):
        touched = np.linalg.norm(force, axis=1) > 0.0
        place = procedure.model.mesh.points + state.nodes.displacement[:, :3] - np.array(tool.position) - moved
        surface = make_surface(tool.shape, 10.0, smooth=True)
        _, normal, _, _ = surface.nearest(np.ascontiguousarray(place[touched]), 10.0)
        pushes.append((force[touched] * normal).sum(axis=1))
    return np.concatenate(pushes), 0.0


CONTACTS: dict[str, tuple[Callable[[], ImplicitProcedure], Callable[..., tuple[FloatArray, float]]]] = {
    **{f"tool_{name}": (lambda law=law: press_ball(law), pulls_of_tools) for name, law in LAWS.items()},
    **{f"bodies_{name}": (lambda law=law: press_body(law), pulls_of_slots) for name, law in LAWS.items()},
    **{f"tool_heel_{e}": (lambda e=e, m=m: drag_heel(e, m), pulls_of_edges) for e, m in HEELS.items()},
    "self_contact": (fold_spring, pulls_of_slots),
    "self_contact_tools": (fold_spring, pulls_of_tools),
    "space_tools": (draw_sheet, pulls_of_sheet_tools),
}


@pytest.mark.parametrize("kind", CONTACTS)
def test_no_converged_increment_pulls(kind) -> None:
    make, measure = CONTACTS[kind]
    procedure = make()
    pushes = 0
    for _ in procedure.advance():
        found, allowed = measure(procedure)
        assert found.min(initial=0.0) >= -allowed
        pushes += int((found > allowed).sum())
    assert pushes > 10, "something must push"
