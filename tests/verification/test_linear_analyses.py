# SPDX-License-Identifier: Apache-2.0
"""Small displacements against closed forms of the linear theory, with displacements that are anything but small.

The answers of the linear theory go with load over stiffness, so they are met however soft the body is; an analysis
of large displacements misses them there, which each test shows beside it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh import mesh_rectangle
from presswork.model import Material, Model, PrescribedDisplacement, Pressure, SolverSettings, Support
from tests.problems import shell_linear
from tests.problems.plane_solids import linear_hardening, make_model, run
from tests.verification.test_limit_loads import COARSE, LIMIT, MIDDLE, graded_body

BORE, OUTSIDE, YIELD, POISSON = 100.0, 200.0, 240.0, 0.499
SHEAR = YIELD * 2 / np.sqrt(3)
SOFT = 2100.0
"""Young's modulus a hundredth of the benchmark's: the bore grows by some 15 %."""


def cylinder(element, young, displacements, *, pressure=None, travel=None, cells=20):
    """Return the state, mesh and pressure on the bore of a thick cylinder in plane strain."""
    pattern = "crossed" if element.startswith("tri") else "quad"
    lines = BORE * (OUTSIDE / BORE) ** (np.arange(cells + 1) / cells)
    mesh = mesh_rectangle(lines, np.array([0.0, 5.0]), element=element, pattern=pattern)
    prescribed = [] if travel is None else [PrescribedDisplacement("left", 0, travel)]
    model = make_model(
        mesh,
        Material("perfectly plastic", young, POISSON, linear_hardening(YIELD)),
        analysis="axisymmetric",
        supports=(Support("bottom", (False, True)), Support("top", (False, True))),
        pressures=[] if pressure is None else [Pressure("left", pressure)],
        prescribed=prescribed,
        solver=SolverSettings(displacements=displacements, initial_increment=0.02, max_increment=0.1,
                              force_tolerance=1e-6, symmetric=displacements == "small"),
    )  # fmt: skip
    state = run(model)[0].state
    return state, mesh, state.nodes.reaction[mesh.node_sets["left"], 0].sum() / (2 * np.pi * BORE * 5.0)


def missed_by(element, displacements):
    """Displacement of the outer surface over Hill's, with the plastic front at 1.5 of the bore, less 1."""
    front = 150.0
    pressure = SHEAR * (np.log(front / BORE) + 0.5 * (1 - (front / OUTSIDE) ** 2))
    outer = SHEAR * front**2 / (SOFT * OUTSIDE) * (1 - POISSON**2)
    state, mesh, _ = cylinder(element, SOFT, displacements, pressure=pressure)
    return float(state.nodes.displacement[mesh.node_sets["right"], 0].mean() / outer - 1)


@pytest.mark.parametrize("element", ["tri3", "quad4_fbar", "quad4_1pt", "quad8_2x2"])
def test_cylinder_under_pressure_meets_hill_with_a_soft_metal(element):
    assert abs(missed_by(element, "small")) < 5e-3


def test_cylinder_of_large_displacements_is_another():
    with pytest.raises(Exception, match="no equilibrium"):
        missed_by("quad8_2x2", "large")


@pytest.mark.parametrize("element", ["tri3", "quad4_fbar", "quad4_1pt", "quad8_2x2"])
def test_cylinder_fully_plastic_bears_its_limit_pressure_and_no_less_however_far_it_grows(element):
    """p = 2 Y/sqrt(3) ln(b/a) (Hill 1950); the growing bore of large displacements takes less and less."""
    limit = SHEAR * np.log(OUTSIDE / BORE)
    _, _, pressure = cylinder(element, 2.1e5, "small", travel=50.0)
    assert pressure == pytest.approx(limit, rel=4e-3)
    if element == "quad4_fbar":
        assert cylinder(element, 2.1e5, "large", travel=50.0)[2] < 0.95 * limit


@pytest.mark.parametrize(("element", "cells"), [("quad4_fbar", MIDDLE), ("quad8_2x2", COARSE)])
def test_punch_bears_prandtls_load_when_it_is_pressed_in_by_its_width(element, cells):
    """(2 + pi) k, to the elements' own 3 %, at a depth at which the real body would have flowed up round the punch."""
    mesh = graded_body(element, "quad", cells)
    depth = 1.0
    model = make_model(
        mesh,
        Material("perfectly plastic", 1e4, 0.3, linear_hardening(1.0)),
        supports=(Support("left", (True, False)), Support("top", (False, True))),
        prescribed=(PrescribedDisplacement("middle", 1, depth),),
        solver=SolverSettings(displacements="small", initial_increment=0.001, max_increment=0.1, max_iterations=30),
    )
    state = run(model)[0].state
    load = abs(state.nodes.reaction[mesh.node_sets["middle"], 1].sum())
    assert load / LIMIT == pytest.approx(1.0, abs=0.03)


def solve_by_analysis(model: Model) -> np.ndarray:
    """Return the displacement (n_points, 6) by an analysis of small displacements in one increment."""
    solver = replace(
        model.solver, displacements="small", initial_increment=1.0, max_increment=1.0, force_tolerance=1e-7
    )
    procedure = ImplicitProcedure(replace(model, solver=solver), threads=1)
    assert len(list(procedure.advance())) == 1
    assert procedure.mechanics.extremes(procedure.state)["equivalent_plastic_strain"].max() == 0.0
    return procedure.state.nodes.displacement


SET = {
    "roof": (shell_linear.scordelis_lo, shell_linear.ROOF, 0.9975),
    "hemisphere": (shell_linear.hemisphere, shell_linear.HEMISPHERE, 1.002),
}


@pytest.mark.parametrize("element", ["shell4_mitc", "shell4_mitc_plus", "shell9_mitc", "shell4_1pt"])
@pytest.mark.parametrize("problem", SET)
def test_linear_shells_by_the_analysis_are_those_of_the_published_set(problem, element, monkeypatch):
    """The Scordelis-Lo roof and the pinched hemisphere, to 3 % of published values and as the tangent solves them."""
    compute, reference, converged = SET[problem]
    n = 8 if element == "shell9_mitc" else 16
    by_tangent = compute(element, n)
    monkeypatch.setattr(shell_linear, "solve_linear", solve_by_analysis)
    by_analysis = compute(element, n)
    assert by_analysis == pytest.approx(by_tangent, rel=1e-6)
    assert by_analysis / reference == pytest.approx(converged, abs=0.03)
