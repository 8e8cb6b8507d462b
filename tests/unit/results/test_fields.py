# SPDX-License-Identifier: Apache-2.0
"""Contact stress is exact where it is uniform, on the axis too; effective stress by its definition."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.procedure.implicit import ImplicitProcedure
from presswork.results.fields import effective_stress, point_fields


def fields_of(procedure: ImplicitProcedure) -> dict[str, np.ndarray]:
    state = procedure.state
    forces = procedure.contact.forces(state, procedure.equilibrium.fixed(len(procedure.model.stages) - 1))
    return point_fields(procedure.model, state, forces, procedure.mechanics.nodal_flow_stress(state))


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
    stress = state.stress[0].reshape(-1, 4)[:, 1]
    np.testing.assert_allclose(fields["contact_pressure"][top], -stress.mean(), rtol=1e-5)
    np.testing.assert_allclose(fields["contact_shear"][top], 0.0, atol=1e-5 * abs(stress.mean()))
    others = np.setdiff1d(np.arange(len(model.mesh.points)), top)
    assert not fields["contact_pressure"][others].any()


def test_effective_stress_of_uniaxial_shear_and_hydrostatic_stress() -> None:
    stress = np.array([[300.0, 0, 0, 0], [0, 0, 0, 100.0], [-500.0, -500, -500, 0]])
    np.testing.assert_allclose(effective_stress(stress), [300, 100 * np.sqrt(3), 0])
