# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies in the plane by explicit dynamics: balances, and the implicit procedure."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.implicit.stepping import ImplicitProcedure
from presswork.process.begin import begin
from tests.problems.touching_bodies import IN_PLANE, STRIKES, write_case

UPSET = """displacement = [
  { set = "top", component = "y", value = -1 },
  { set = "other.top", component = "y", value = -1 },
]
[explicit]
target_step = 1e-7
[boundary]
axis = { set = "left", fix = ["x"] }
floor = { set = "bottom", fix = ["y"] }
floor_of_ring = { set = "other.bottom", fix = ["y"] }"""


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_bodies_that_strike_each_other_keep_momentum_and_energy(tmp_path, element) -> None:
    model = build_model(read_case(write_case(tmp_path, IN_PLANE, element=element, **STRIKES)))
    run = begin(model, threads=1)
    mass = run.solids.mass
    before = mass @ run.solids.velocity
    rows = [run.row(report) for report in run.advance()]
    np.testing.assert_allclose(mass @ run.solids.velocity, before, atol=1e-12 * np.linalg.norm(before))
    assert np.abs(run.solids.velocity[list(model.bodies[0].points), 1]).max() > 1e3
    assert rows[-1]["friction_energy"] > 0.0
    assert max(abs(row["energy_error_percent"]) for row in rows) < 0.2


def test_a_core_upset_in_a_ring_pushes_it_as_in_the_implicit_procedure(tmp_path) -> None:
    given = {"analysis": "axisymmetric", "depth": "", "velocity": "", "origin": "[6, 0]", "other": "soft"}
    text = write_case(tmp_path, IN_PLANE, element="quad4_1pt", **given, duration=1e-3, stage=UPSET)
    model = build_model(read_case(text))
    run = begin(model, threads=1)
    nodes, way, found = model.mesh.node_sets["top"], [0.0], []
    for report in run.advance():
        way.append(5.0 - run.solids.position[nodes, 1].mean())
        found.append(run.row(report)["top.force_y"])
    middle = 0.5 * (np.array(way[1:]) + way[:-1])
    blocks = tuple(dataclasses.replace(block, element="quad4_fbar") for block in model.mesh.blocks)
    mesh = dataclasses.replace(model.mesh, blocks=blocks)
    procedure = ImplicitProcedure(dataclasses.replace(model, explicit=None, mesh=mesh))
    strokes, forces = [], []
    for _ in procedure.advance():
        strokes.append(-procedure.state.nodes.displacement[nodes, 1].mean())
        forces.append(procedure.state.nodes.reaction[nodes, 1].sum())
    late = middle > 0.2
    np.testing.assert_allclose(np.array(found)[late], np.interp(middle, strokes, forces)[late], rtol=0.02)
