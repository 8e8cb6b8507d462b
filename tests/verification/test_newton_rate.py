# SPDX-License-Identifier: Apache-2.0
"""Full Newton with the consistent tangent converges quadratically on logged steps of the upsetting example.

Near the solution r_(k+1) = C r_k^2, so the order log(r_(k+1)/r_k) / log(r_k/r_(k-1)) tends to 2. The symmetric part of
the tangent, which is the default, gives a linear rate.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.resources import files
from itertools import islice

import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Hardening, Heating
from tests.problems.plane_solids import ELEMENTS

EXAMPLE = files("presswork.examples") / "upsetting_4cst.toml"
FLOOR = 1e-11
"""Relative residual above which rounding plays no part: the last ones stand at some 1e-13."""


HOT = Hardening(
    "hensel_spittel", np.array([1500, -0.0027, 0.13, 0.14, -0.0005, 0, 0, 0, 0, 1e-3, 2, 1e-3, 100, 800, 1250])
)
"""About carbon steel, which hardens."""


@cache
def residuals(element, symmetric, hot=False):
    """Relative residuals of every iteration, of increments 3 to 8 of upsetting with 8 x 12 cells."""
    pattern = "crossed" if element.startswith("tri") else "quad"
    changes = [
        f'workpiece.element="{element}"',
        f'workpiece.mesh.pattern="{pattern}"',
        "workpiece.mesh.cells=[8,12]",
        f"solver.force_tolerance={1e-9 if hot else 1e-12}",  # the return mapping of a hot law ends at 1e-10
        f"solver.symmetric={str(symmetric).lower()}",
        "solver.initial_increment=0.005",
        "solver.max_increment=0.005",
    ]
    model = build_model(Case.from_toml(EXAMPLE, changes))
    if hot:
        steel = replace(model.materials[0], hardening=HOT, heating=Heating(start=1000.0))
        model = replace(model, materials=(steel,))
    procedure = ImplicitProcedure(model, threads=1)
    reports = list(islice(procedure.advance(), 8))[2:]
    assert any(e.max() > 0.01 for e in procedure.state.cells.eqps)
    return [np.array(r.log.residual) for r in reports if sum(r.log.contact_changes) == 0 and not r.cutbacks]


def orders(histories, floor=FLOOR):
    """Order of each step from its last three residuals above the floor, or with the first one below it in addition.

    Rounding can only raise a residual, so that both are lower bounds of the order; the larger is taken.
    """
    found = []
    for r in histories:
        last = int(np.argmax(r < floor)) if (r < floor).any() else len(r) - 1
        triples = [r[k - 2 : k + 1] for k in (last - 1, last) if k >= 2 and r[k - 2] < 0.05]
        if triples:
            found.append(max(np.log(c / b) / np.log(b / a) for a, b, c in triples))
    return found


@pytest.mark.parametrize("element", ELEMENTS)
def test_full_newton_converges_quadratically_on_a_logged_step_of_upsetting(element):
    found = orders(residuals(element, symmetric=False))
    assert len(found) >= 3
    assert np.median(found) > 1.75


def test_full_newton_converges_quadratically_with_a_law_of_strain_rate_and_temperature():
    """The last step above the floor of one increment after another: r_(k+1) goes with r_k squared."""
    histories = residuals("quad4_fbar", symmetric=False, hot=True)
    before, after = np.log([r[r > 1e-10][-2:] for r in histories]).T
    assert np.ptp(before) > np.log(10)
    order = np.polyfit(before, after, 1)[0]
    assert order == pytest.approx(2.0, abs=0.2)


def test_symmetric_part_of_the_tangent_converges_linearly_but_fast():
    """What is left out is small: near the solution each iteration gains a factor of about 100."""
    histories = residuals("tri3", symmetric=True)
    rates = [r[1:] / r[:-1] for r in (h[(h > FLOOR) & (h < 1e-4)] for h in histories) if len(r) > 1]
    assert np.median(np.concatenate(rates)) < 0.03
    assert np.median(orders(histories)) < 1.5
