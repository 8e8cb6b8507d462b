# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies in space by explicit dynamics: balances, closed forms, the implicit procedure."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.process.begin import begin
from tests.problems.touching_bodies import CLAMP, FLYING, PRESSED, compare_with_implicit, write_case


def make_run(tmp_path, text, **changes):
    return begin(build_model(read_case(write_case(tmp_path, text, **changes))), threads=1)


UNEVEN = {"hex8_fbar": 3e-3, "tet4_nodal": 0.12}
"""Of the stress: nodes of tetrahedra have unlike masses over their surface, and so springs of unlike stiffness."""


def compute(run) -> list:
    return [run.row(report) for report in run.advance()]


@pytest.mark.parametrize("element", ["hex8_1pt", "hex8_fbar", "tet4_nodal"])
def test_bodies_that_strike_each_other_keep_momentum_and_energy(tmp_path, element) -> None:
    run = make_run(tmp_path, FLYING, element=element)
    mass = run.solids.mass
    before = mass @ run.solids.velocity
    own = mass[: len(run.model.bodies[0].points)].sum() * 20e3
    rows = compute(run)
    after = mass @ run.solids.velocity
    np.testing.assert_allclose(after, before, atol=1e-12 * own)
    lower = run.solids.velocity[list(run.model.bodies[0].points)]
    assert np.abs(lower[:, 0]).max() > 1e3  # friction has taken it along
    assert rows[-1]["contact_energy"] < 0.01 * rows[0]["kinetic_energy"]  # they have come apart again
    assert rows[-1]["friction_energy"] > 0.01 * rows[0]["kinetic_energy"]
    assert max(abs(row["energy_error_percent"]) for row in rows) < 0.2


@pytest.mark.parametrize("element", ["hex8_fbar", "tet4_nodal"])
def test_a_uniform_pressure_passes_between_meshes_that_do_not_match(tmp_path, element) -> None:
    run = make_run(tmp_path, PRESSED, element=element)
    row = compute(run)[-1]
    stress = run.solids.stress
    mean = -stress[:, 2].mean()
    depth = 0.01 - 10.0 * mean / 200e3  # of the springs: of 0.01 mm what the bodies do not take
    assert 0.0 < depth < 0.001 * 2.5
    uneven = UNEVEN[element]
    np.testing.assert_allclose(stress[:, 2], -mean, rtol=uneven)
    np.testing.assert_allclose(stress[:, [0, 1, 3, 4, 5]], 0.0, atol=uneven * mean)
    pressure = run.solids.contacts[0].pressure
    assert (pressure > 0.0).sum() in (24, 25)  # nodes of the slave's face
    np.testing.assert_allclose(pressure[pressure > 0.0], mean, rtol=uneven)
    np.testing.assert_allclose(row["joint.force_z"], 100.0 * mean, rtol=uneven)


def test_the_force_is_that_of_the_implicit_procedure(tmp_path) -> None:
    given = {
        "element": "hex8_fbar",
        "material": "soft",
        "stroke": 2.0,
        "duration": 1e-3,
        "target_step": 5e-7,
        "damping": 0.0,
    }
    run = make_run(tmp_path, PRESSED, **given)
    middle, found, expected = compare_with_implicit(run, "upper.front", 2, "joint")
    late = middle > 0.3
    np.testing.assert_allclose(found[late], expected[late], rtol=0.02)


def test_a_clamp_that_closes_holds_itself_off(tmp_path) -> None:
    run = make_run(tmp_path, CLAMP)
    force = [-run.row(report)["top.force_y"] for report in run.advance()]
    assert max(force) > 1.8 * force[12]  # 1.3 mm of 1.5
    contact = run.solids.contacts[0]
    whole = (contact.push + contact.friction_force).sum(axis=0)
    np.testing.assert_allclose(whole, 0.0, atol=1e-10 * np.abs(contact.push).max())
    assert contact.pressure.max() > 10.0


def advance(run, rows: int):
    for _ in itertools.islice(run.advance(), rows):
        pass
    return run


def test_threads_and_a_dump_change_no_bit(tmp_path) -> None:
    model = build_model(read_case(write_case(tmp_path, FLYING, cells=10)))
    whole = advance(begin(model, threads=1), 3).solids.dump()
    assert whole["bodies.impulse.0"].any()
    resumed = begin(model, threads=1)
    resumed.load_arrays(advance(begin(model, threads=2), 2).to_arrays())
    found = advance(resumed, 1).solids.dump()
    assert [name for name, values in whole.items() if values.tobytes() != found[name].tobytes()] == []


HOT = """
[heat]
initial_temperature = 300
[materials.soft.thermal]
conductivity = 200
specific_heat = "900 J/(kg*K)"
[contacts.joint.heat]
conductance = "100 kW/(m^2*K)"
"""


def test_heat_passes_between_bodies_and_none_is_lost(tmp_path) -> None:
    path = write_case(tmp_path, PRESSED, material="soft", stroke=0.2, target_step=5e-7, damping=0.0)
    text = path.read_text().replace("[bodies.upper]\n", "[bodies.upper]\ninitial_temperature = 100\n")
    path.write_text(text + HOT)
    run = begin(build_model(read_case(path)), threads=1)
    row = [run.row(report) for report in run.advance()][-1]
    made = row["heat_plastic"] + row["heat_friction"]
    assert row["heat_stored"] == pytest.approx(made, rel=1e-6)
    degrees = run.heat.arrays.temperature
    assert degrees[list(run.model.bodies[0].points)].min() < 299.0
    assert degrees[list(run.model.bodies[1].points)].max() > 101.0
