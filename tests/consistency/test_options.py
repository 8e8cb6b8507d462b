# SPDX-License-Identifier: Apache-2.0
"""No option without a use: every solver setting changes what is computed, or how."""

import pytest

from presswork import Case, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import SolverSettings, TangentTerms
from presswork.outcome import GaveUpError

THESIS = {"tangent": "thesis", "max_iterations": 60}
CHANGES = {
    "newton": ({}, {"newton": "modified"}),
    "tangent": ({}, {"tangent": "thesis"}),
    "terms": (THESIS, {**THESIS, "terms": {"k_v": True}}),
    "strain_matrix": (THESIS, {**THESIS, "terms": {"strain_matrix": "Bbar"}}),
    "k_e": (THESIS, {**THESIS, "terms": {"k_e": False}}),
    "k_u": (THESIS, {**THESIS, "terms": {"k_u": False}}),
    "k_v": (THESIS, {**THESIS, "terms": {"k_v": True}}),
    "modulus": (THESIS, {**THESIS, "terms": {"modulus": "consistent"}}),
    "symmetric": ({}, {"symmetric": False}),
    "friction_tangent": ({}, {"friction_tangent": "bond"}),
    "line_search": ({"initial_increment": 0.5, "max_increment": 0.5}, {"line_search": False}),
    "force_tolerance": ({}, {"force_tolerance": 1e-8}),
    "displacement_tolerance": (THESIS, {**THESIS, "displacement_tolerance": 1e-9}),
    "max_iterations": ({}, {"max_iterations": 2}),
    "initial_increment": ({}, {"initial_increment": 0.001}),
    "min_increment": ({"max_iterations": 2}, {"min_increment": 0.001}),
    "max_increment": ({}, {"max_increment": 0.2}),
    "target_iterations": ({}, {"target_iterations": 2}),
    "displacements": ({}, {"displacements": "small"}),
    "strain_measure": ({}, {"strain_measure": "stretch"}),
    "integrator": ({}, {"integrator": "direct"}),
    "substeps": ({"integrator": "substepping"}, {"substeps": 2}),
    "hourglass_stiffness": ({}, {"hourglass_stiffness": 0.5}),
}
ELSEWHERE = {
    "pressure_stiffness": "tests/unit/interaction/test_loads.py",
    "increment_tolerance": "tests/verification/test_increment_errors.py",
    "control": "tests/verification/test_shell_snap_through.py",
    "linear_solver": "tests/regression/test_forming_in_space.py",
    "contact_stiffness": "tests/verification/test_hemispherical_punch.py",
    "inertia": "tests/regression/test_implicit_inertia.py, test_solid_inertia.py and test_shell_inertia.py",
    "damping": "tests/regression/test_implicit_inertia.py, test_solid_inertia.py and test_shell_inertia.py",
    "kirchhoff_penalty": "tests/consistency/test_shell_tangent.py",
}


def trace(settings: dict[str, object]) -> tuple[object, ...]:
    """Every residual of a small upsetting with friction, and the force at its end."""
    case = Case(
        title="options",
        analysis="axisymmetric",
        workpiece={"material": "steel", "element": "quad4_1pt", "mesh": {"size": [10, 15], "cells": [3, 4]}},
        materials={
            "steel": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "voce", "yield_stress": 700,
                      "saturation_stress": 900, "rate": 10}}
        },
        tools={"punch": {"profile": [[0, 15], [30, 15]], "contact": "shear", "m": 0.3}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"move": [0, -1.5]}}}],
        output={"steps": 1},
        solver=settings,
    )  # fmt: skip
    procedure = ImplicitProcedure(build_model(case), threads=1)
    residuals = []
    try:
        for report in procedure.advance():
            residuals += report.log.residual
    except GaveUpError:
        residuals.append("gave up")
    return (*residuals, float(procedure.state.nodes.reaction[:, 1].max()))


def test_every_setting_is_tried() -> None:
    fields = set(SolverSettings.__dataclass_fields__) | set(TangentTerms.__dataclass_fields__)
    assert fields == set(CHANGES) | set(ELSEWHERE)


@pytest.mark.parametrize("name", CHANGES)
def test_setting_changes_what_is_computed(name) -> None:
    base, change = CHANGES[name]
    unchanged = trace(base)
    assert unchanged == trace(base), "the same settings give the same bits"
    assert trace({**base, **change}) != unchanged
