# SPDX-License-Identifier: Apache-2.0
"""A sheet that touches itself by increments: overlap under a pressure, friction and its work in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.sheet_on_itself import SelfContactArrays
from presswork.model import (
    PrescribedDisplacement,
    ShellPressure,
    Stage,
    Support,
)
from tests.problems.shells import CLAMPED, RX, RY, RZ, X, Y, Z, fixing
from tests.problems.stacked_plates import GAP, SETTINGS, SIDE, THICKNESS, YOUNG, stack


def test_plates_under_a_pressure_overlap_by_half_of_what_each_sinks_into_a_tool() -> None:
    """p t / (2 c E): both have springs of c E / t per area."""
    pressure = 50.0
    stages = (
        Stage("close", prescribed=(PrescribedDisplacement("upper", Z, -GAP),)),
        Stage("press", shell_pressures=(ShellPressure("upper", -pressure),)),
    )
    # no rotation, so that all nodes sink in alike
    supports = (Support("upper", fixing(X, Y, RX, RY, RZ)),)
    procedure, iterations, energies = ImplicitProcedure(stack(stages, supports, 0.0), threads=1), [], []
    for report in procedure.advance():
        iterations.append(len(report.log))
        if report.fraction == 1.0:
            energies.append(procedure.energy_balance())
    exact = pressure * THICKNESS / (2.0 * SETTINGS.contact_stiffness * YOUNG)
    contact = procedure.interactions.self_contact
    assert contact is not None
    upper = procedure.model.mesh.node_sets["upper"]
    depth = -GAP - procedure.state.nodes.displacement[upper, 2]
    np.testing.assert_allclose(depth, exact, rtol=1e-4)
    assert contact.find_overlap(procedure.state) == pytest.approx(exact, rel=1e-4)
    force = procedure.state[SelfContactArrays].force
    assert force[upper, 2].sum() == pytest.approx(pressure * SIDE**2, rel=1e-5)
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-9 * pressure * SIDE**2)
    assert max(iterations) <= 5
    done, stored = (energies[1][name] - energies[0][name] for name in ("external_work", "contact_energy"))
    assert stored > 1.0
    assert done == pytest.approx(stored, rel=1e-3)


@pytest.mark.parametrize("mu", [0.0, 0.15])
def test_a_plate_that_slides_on_another_of_an_unlike_mesh_obeys_coulomb(mu: float) -> None:
    """Friction is mu N; its work mu N times the way, less what the elastic stick takes."""
    way = 0.5
    stages = (
        Stage("close", prescribed=(PrescribedDisplacement("upper", Z, -GAP - 0.01),)),
        Stage("slide", prescribed=(PrescribedDisplacement("upper", X, way),)),
    )
    procedure = ImplicitProcedure(stack(stages, (Support("upper", CLAMPED),), mu, upper=5), threads=1)
    for _ in procedure.advance():
        pass
    state, upper = procedure.state, procedure.model.mesh.node_sets["upper"]
    force = state[SelfContactArrays].force[upper].sum(axis=0)
    assert force[2] > 100.0
    assert force[0] == pytest.approx(-mu * force[2], rel=1e-6, abs=1e-6)
    assert force[1] == pytest.approx(0.0, abs=1e-6 * force[2])
    work = procedure.energy_balance()["friction_work"]
    assert work == pytest.approx(mu * force[2] * way, rel=0.15)
    assert abs(procedure.energy_balance()["error_percent"]) < 1.0


def test_a_resumed_run_gives_the_same_bits() -> None:
    stages = (
        Stage("close", prescribed=(PrescribedDisplacement("upper", Z, -GAP - 0.01),)),
        Stage("slide", prescribed=(PrescribedDisplacement("upper", X, 1.5),)),
    )
    model = stack(stages, (Support("upper", fixing(X, Y, Z, RX, RZ)),), 0.1, upper=5)
    whole, kept = ImplicitProcedure(model, threads=1), None
    for report in whole.advance():
        if report.number == 27:
            kept = {name: array.copy() for name, array in whole.state.to_arrays().items()}
    assert kept is not None
    assert kept["self_contact.friction"].any()
    resumed = ImplicitProcedure(model, threads=1)
    resumed.state.load_arrays(kept)
    for _ in resumed.advance():
        pass
    for name, array in whole.state.to_arrays().items():
        np.testing.assert_array_equal(resumed.state.to_arrays()[name], array, err_msg=name)
