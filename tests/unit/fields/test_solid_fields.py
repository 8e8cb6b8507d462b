# SPDX-License-Identifier: Apache-2.0
"""Contact stress is exact where it is uniform, on the axis too; effective stress by its definition."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.fields.solid_fields import effective_stress
from presswork.fields.table import compute_fields
from presswork.implicit.stepping import ImplicitProcedure


def fields_of(procedure: ImplicitProcedure) -> dict[str, np.ndarray]:
    state = procedure.state
    forces = procedure.interactions.tools.contact.forces(
        state, procedure.interactions.supports.fixed(len(procedure.model.stages) - 1)
    )
    return compute_fields(procedure.mechanics.show(state, forces))[0]


@pytest.mark.parametrize("element", ["tri3", "tri6_7pt", "quad4_fbar", "quad8_2x2", "quad9_2x2"])
@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_uniform_contact_pressure_is_the_stress_beneath_it(element, analysis) -> None:
    case = Case(
        title="frictionless",
        analysis=analysis,
        workpiece={"material": "steel", "element": element, "mesh": {"size": [10, 15], "cells": [4, 5]}},
        materials={
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
            }
        },
        tools={"punch": {"profile": [[-1, 15], [30, 15]], "contact": "frictionless"}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"move": [0, -3]}}}],
        solver={"force_tolerance": 1e-8},
    )
    model = build_model(case)
    procedure = ImplicitProcedure(model, threads=1)
    for _ in procedure.advance():
        pass
    state = procedure.state
    fields = fields_of(procedure)
    top = model.mesh.node_sets["top"]
    stress = state.cells.stress[0].reshape(-1, 4)[:, 1]
    np.testing.assert_allclose(fields["contact_pressure"][top], -stress.mean(), rtol=1e-5)
    np.testing.assert_allclose(fields["contact_shear"][top], 0.0, atol=1e-5 * abs(stress.mean()))
    others = np.setdiff1d(np.arange(len(model.mesh.points)), top)
    assert not fields["contact_pressure"][others].any()


def test_effective_stress_of_uniaxial_shear_and_hydrostatic_stress() -> None:
    stress = np.array([[300.0, 0, 0, 0], [0, 0, 0, 100.0], [-500.0, -500, -500, 0]])
    np.testing.assert_allclose(effective_stress(stress), [300, 100 * np.sqrt(3), 0])


def press_ring(contact: dict[str, object]) -> tuple[ImplicitProcedure, np.ndarray]:
    case = Case(
        title="ring",
        analysis="axisymmetric",
        workpiece={
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"origin": [9, 0], "size": [9, 6], "cells": [8, 4]},
        },
        materials={
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
            }
        },
        tools={"punch": {"profile": [[0, 6], [60, 6]], **contact}},
        boundary={"middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"move": [0, -1]}}}],
        solver={"force_tolerance": 1e-8, "max_iterations": 50},
    )
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    return procedure, procedure.model.mesh.node_sets["top"]


@pytest.mark.parametrize(
    ("contact", "fraction_of_flow", "fraction_of_pressure"),
    [
        ({"contact": "shear", "m": 0.2}, 0.2 / np.sqrt(3), np.inf),
        ({"contact": "coulomb", "mu": 0.05}, np.inf, 0.05),
        ({"contact": "coulomb_capped", "mu": 0.05, "m": 0.1}, 0.1 / np.sqrt(3), 0.05),
    ],
)
def test_friction_limit_bounds_the_shear_and_is_reached(contact, fraction_of_flow, fraction_of_pressure) -> None:
    procedure, top = press_ring(contact)
    fields = fields_of(procedure)
    flow = procedure.mechanics.nodal_flow_stress(procedure.state)[top]
    by_flow = fraction_of_flow * flow if np.isfinite(fraction_of_flow) else np.full(len(top), np.inf)
    by_push = fraction_of_pressure * fields["contact_pressure"][top] if np.isfinite(fraction_of_pressure) else by_flow
    limit = fields["friction_limit"]
    np.testing.assert_allclose(limit[top], np.minimum(by_flow, by_push))
    assert not np.delete(limit, top).any()
    used = np.abs(fields["contact_shear"][top]) / limit[top]
    assert used.max() <= 1 + 1e-6
    assert np.median(used) > 0.97, "most of the ring slides; k has hardened since the increment began"


@pytest.mark.parametrize("contact", ["frictionless", "sticking"])
def test_there_is_no_friction_limit_without_a_law(contact) -> None:
    procedure, top = press_ring({"contact": contact})
    fields = fields_of(procedure)
    assert not fields["friction_limit"].any()
    status = 2.0 if contact == "sticking" else 1.0
    np.testing.assert_array_equal(fields["contact_status"][top], status)
