# SPDX-License-Identifier: Apache-2.0
"""Plane-strain limit loads of a perfectly plastic body: (2 + pi) k = 2.9685 s0 on the punch and on the ligament.

Prandtl's punch (smooth, rigid, half-width 1, on a body 10 x 10) and the deep double-edge notched bar of Nagtegaal,
Parks & Rice (1974; half-ligament 1, half-width 10), whose limit stress on the net section is the same. Cells are graded
to the punch's edge and the notch's tip. s0/E = 1e-7, so that no cell changes its shape. The load is read at a
displacement of 300 s0/E and again at 3000 s0/E: an element that does not lock has reached its limit at the first and
stays there, one that locks goes on rising.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh import grade_line, mesh_rectangle
from presswork.model import Material, PrescribedDisplacement, SolverSettings, Support
from tests.problems.plane_solids import linear_hardening, make_model

YIELD, YOUNG, EXTENT = 1.0, 1e7, 10.0
LIMIT = (2 + np.pi) * YIELD / np.sqrt(3)
PROBLEMS = ("punch", "notch")
FINE, MIDDLE, COARSE = (30, 30, 32), (12, 14, 16), (8, 10, 12)  # cells along the punch, beside it, and downwards
FREE_OF_LOCKING = {
    "tri3": FINE,  # crossed: 4CST, its error falls with the cell size only
    "tri6_6pt": COARSE,
    "tri6_7pt": COARSE,
    "quad4_fbar": MIDDLE,
    "quad4_1pt": MIDDLE,
    "quad8_2x2": COARSE,
    "quad9_2x2": COARSE,
}


def graded_body(element, pattern, cells):
    """Cells along the punch shrink fourfold to its edge, and grow from there in geometric progression."""
    along, beside, down = cells
    punch = grade_line(0.0, [(1.0, along, 0.25)])
    smallest = punch[-1] - punch[-2]

    def ratio(length, n):
        growth = brentq(lambda g: smallest * (g**n - 1) / (g - 1) - length, 1.0 + 1e-6, 10.0)
        return growth ** (n - 1)

    x = grade_line(0.0, [(1.0, along, 0.25), (EXTENT - 1.0, beside, ratio(EXTENT - 1.0, beside))])
    y = grade_line(0.0, [(EXTENT, down, ratio(EXTENT, down))])
    mesh = mesh_rectangle(x, y, element=element, pattern=pattern)
    bottom = mesh.node_sets["bottom"]
    return replace(mesh, node_sets={**mesh.node_sets, "middle": bottom[mesh.points[bottom, 0] < 1.0 + 1e-9]})


@cache
def load_over_limit(problem, element, cells, pattern=None):
    """Mean stress on the punch or the ligament over the limit, at displacements of 300 and 3000 s0/E."""
    pattern = pattern or ("crossed" if element.startswith("tri") else "quad")
    mesh = graded_body(element, pattern, cells)
    held, moved = ("top", "middle") if problem == "punch" else ("middle", "top")
    motion = PrescribedDisplacement(moved, 1, 3000 * YIELD / YOUNG)
    # the first flow in small increments: hourglass forces of quad4_1pt grow by the modulus at their start
    solver = SolverSettings(
        initial_increment=0.001, max_increment=0.2, force_tolerance=1e-4, symmetric=False, max_iterations=30
    )
    model = make_model(
        mesh,
        Material("perfectly plastic", YOUNG, 0.3, linear_hardening(YIELD)),
        supports=(Support("left", (True, False)), Support(held, (False, True))),
        prescribed=(motion,),
        solver=solver,
    )
    procedure, travel, load = ImplicitProcedure(model, threads=1), [0.0], [0.0]
    for report in procedure.advance():
        travel.append(3000 * report.fraction)
        load.append(abs(procedure.state.nodes.reaction[mesh.node_sets["middle"], 1].sum()))
    return np.interp([300.0, 3000.0], travel, load) / LIMIT


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("element", FREE_OF_LOCKING)
def test_element_free_of_locking_comes_within_3_percent_of_the_limit_load_and_stays(problem, element):
    near, far = load_over_limit(problem, element, FREE_OF_LOCKING[element])
    assert abs(far - 1) < 0.03
    assert far / near - 1 < 0.015


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize(("element", "pattern"), [("tri3", "right"), ("quad4", "quad")])
def test_element_that_locks_passes_the_limit_load_and_keeps_rising(problem, element, pattern):
    near, far = load_over_limit(problem, element, MIDDLE, pattern)
    assert near > 1.1
    assert far > 1.3
    assert far / near - 1 > 0.1


@pytest.mark.parametrize(("element", "order"), [("tri3", 1), ("quad4_fbar", 1)])
def test_limit_load_converges_from_above(element, order):
    """Halved cells leave about half the error, and the limit stays an upper bound."""
    errors = [load_over_limit("punch", element, (n, n + 2, n + 4))[1] - 1 for n in (6, 12, 24)]
    assert errors[0] > errors[1] > errors[2] > 0
    assert errors[0] / errors[2] > 2 ** (2 * order - 0.5)
