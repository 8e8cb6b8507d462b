# SPDX-License-Identifier: Apache-2.0
"""New meshes with loads, supports and several bodies: places are geometry, and what holds without new meshes holds."""

import numpy as np
import pytest

from presswork import Case, CaseError, build_model
from presswork.examples import copy_example
from presswork.model import BodyContact, EdgeForce
from presswork.process.begin import begin
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.process.mesh_change import new_balance
from presswork.recorder import run_model
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

STEEL = {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 1000}}


def run(case):
    recording = begin(build_model(case), 1)
    rows = [recording.row(report) for report in recording.advance()]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, recording


def bar(stage, remesh, *, element="quad4_fbar", pattern=None, boundary=None, analysis="plane_strain"):
    """A bar of 10 x 20 mm on its lower side, the left one a symmetry plane."""
    mesh = {"size": [10, 20], "cells": [4, 8]} | ({"pattern": pattern} if pattern else {})
    return Case(
        title="bar",
        analysis=analysis,
        workpiece={"material": "steel", "element": element, "mesh": mesh},
        materials={"steel": STEEL},
        boundary=boundary or {"axis": {"set": "left", "fix": ["x"]}, "foot": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "load", **stage}],
        output={"steps": 1},
        solver={"max_increment": 0.1, "force_tolerance": 1e-9, "displacement_tolerance": 1e-10},
        remesh=remesh,
    )


STAGES = {
    "displacement": {"displacement": [{"set": "top", "component": "y", "value": 3.0}]},
    "edge force": {"edge_force": [{"set": "top", "value": [0, 420]}]},
    "pressure": {"pressure": [{"set": "right", "value": 450}]},
}


@pytest.mark.parametrize("name", list(STAGES))
@pytest.mark.parametrize("analysis", ["plane_strain", "axisymmetric"])
def test_even_states_under_loads_do_not_know_of_their_meshes(name, analysis):
    """All points share one state; with a new mesh every tenth of the stage it stays even, and as without any."""
    once, plain = run(bar(STAGES[name], None, analysis=analysis))
    often, recording = run(bar(STAGES[name], {"every": 0.1, "size": 2.2}, analysis=analysis))
    assert often["remeshes"][-1] >= 8
    strain = recording.procedure.state.cells.eqps[0]
    assert strain.mean() > 0.05
    assert np.ptp(strain) < 1e-6 * strain.mean()
    assert strain.mean() == pytest.approx(plain.procedure.state.cells.eqps[0].mean(), rel=2e-4)
    for key in ("foot.force_y", "axis.force_x"):
        scale = np.abs(once[key]).max()
        assert often[key][-1] == pytest.approx(once[key][-1], abs=2e-4 * scale + 1e-3)
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 1.0


def test_a_force_on_one_node_stays_on_that_node():
    """The corner is a set of its own here: it remains a node, and carries the whole force on every mesh."""
    model = build_model(bar({"force": [{"set": "top", "value": [0, 400]}]}, {"every": 0.25, "size": 2.2}))
    corner = int(np.lexsort((model.mesh.points[:, 0], -model.mesh.points[:, 1]))[0])
    model.mesh.node_sets["top"] = np.array([corner], dtype=np.int32)
    recording = begin(model, 1)
    for _ in recording.advance():
        mesh, state = recording.procedure.model.mesh, recording.procedure.state
        (node,) = mesh.node_sets["top"]
        place = mesh.points[node] + state.nodes.displacement[node]
        assert place[0] == 0.0
        assert place[1] == pytest.approx(20.0, abs=0.5)
    assert recording.epoch >= 3
    assert recording.procedure.state.nodes.external_force[node] == pytest.approx([0.0, 400.0])


@pytest.mark.parametrize("element", ["tri6_6pt", "tri6_7pt", "quad8_2x2", "quad4"])
def test_first_meshes_of_other_cells_become_quadrilaterals(element):
    once, plain = run(bar(STAGES["displacement"], None, element=element))
    often, recording = run(bar(STAGES["displacement"], {"every": 0.25, "size": 2.2}, element=element))
    assert recording.procedure.model.mesh.blocks[0].element == ("quad4" if element == "quad4" else "quad4_fbar")
    assert often["remeshes"][-1] >= 3
    strain = recording.procedure.state.cells.eqps[0]
    assert np.ptp(strain) < 1e-6 * strain.mean()
    assert often["foot.force_y"][-1] == pytest.approx(once["foot.force_y"][-1], rel=2e-4)
    assert strain.mean() == pytest.approx(plain.procedure.state.cells.eqps[0].mean(), rel=2e-4)


def test_a_gap_to_another_body_gets_small_cells_before_they_touch():
    """A block comes down 0.8 mm on a wider one 0.4 mm below it: cells beneath its corner are small before any force."""
    block = {"material": "steel", "element": "quad4_fbar"}
    case = Case(
        title="two blocks",
        analysis="plane_strain",
        workpiece=block | {"mesh": {"size": [8, 4], "cells": [8, 4]}},
        bodies={"upper": block | {"mesh": {"origin": [0, 4.4], "size": [3.3, 3], "cells": [4, 3]}}},
        contacts={"joint": {"between": ["workpiece", "upper"], "contact": "coulomb", "mu": 0.1}},
        materials={"steel": STEEL},
        boundary={
            "axis": {"set": "left", "fix": ["x"]},
            "upper_axis": {"set": "upper.left", "fix": ["x"]},
            "foot": {"set": "bottom", "fix": ["y"]},
        },
        stages=[{"name": "press", "displacement": [{"set": "upper.top", "component": "y", "value": -0.8}]}],
        solver={"max_increment": 0.1},
        remesh={"size": 1.0, "smallest_size": 0.25, "bodies": {"upper": {"size": 1.0, "smallest_size": 0.25}}},
    )
    rows, recording = run(case)
    first = int(np.flatnonzero(rows["remesh_cause"] == 8)[0])
    force = np.abs(rows["joint.force_y"])
    assert force[first - 1] == 0.0
    once, _ = run(case.model_copy(update={"remesh": case.remesh.model_copy(update={"enabled": False})}))
    assert force[-1] == pytest.approx(np.abs(once["joint.force_y"][-1]), rel=0.01)
    procedure = recording.procedure
    x = procedure.model.mesh.points[:, :2] + procedure.state.nodes.displacement
    assert np.sort(np.abs(x[:, 0] - 3.3)[np.abs(x[:, 1] - 3.8) < 0.4])[3] < 0.5


@pytest.fixture
def two_bodies(tmp_path):
    return copy_example("two_bodies", tmp_path)


@pytest.mark.validation
def test_the_slave_is_chosen_anew_unless_the_case_names_it(two_bodies):
    keys = ["remesh.size=0.4", "remesh.bodies.ring.size=0.2", "remesh.every=0.5", "stages.0.tools.punch.stroke=1"]
    for own, slave in ((keys, 1), ([*keys, "contacts.bore.slave='workpiece'"], 0)):
        recording = run(Case.from_toml(two_bodies, own))[1]
        (contact,) = recording.procedure.model.contacts
        assert isinstance(contact, BodyContact)
        assert contact.slave == slave


def test_a_body_that_is_not_meshed_anew_keeps_its_state_to_the_bit(two_bodies):
    recording = begin(build_model(Case.from_toml(two_bodies, ["remesh.size=0.5"])), 1)
    for _ in zip(range(6), recording.advance(), strict=False):
        pass
    before = recording.procedure
    kept = {name: getattr(before.state.cells, name)[1].copy() for name in ("stress", "eqps", "history")}
    points = before.model.mesh.points + before.state.nodes.displacement
    seen = {}
    real = new_balance.balance_at_rest

    def look(procedure):
        seen.update({name: getattr(procedure.state.cells, name)[1].copy() for name in kept})
        return real(procedure)

    new_balance.balance_at_rest = look
    try:
        assert recording.observers.find(NewMeshes).remesh("asked for", {0})
    finally:
        new_balance.balance_at_rest = real
    for name, values in kept.items():
        assert np.array_equal(seen[name], values), name
    own, own_n = (procedure.model.bodies[1].points for procedure in (recording.procedure, before))
    after = recording.procedure.model.mesh.points
    assert np.array_equal(after[own.start : own.stop], points[own_n.start : own_n.stop])


@pytest.mark.validation
def test_runs_with_bodies_and_loads_resume_to_the_same_bits(two_bodies, tmp_path):
    model = build_model(Case.from_toml(two_bodies, ["remesh.every=0.3", "output.checkpoint_every=1", "output.steps=2"]))
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"

    parts = run_in_two_parts(model, tmp_path / "halves", lambda now: now.text.startswith("upset: increment 30,"))
    assert_same_bits(parts.folder, tmp_path / "whole")


def test_the_whole_of_an_edge_force_stays_the_same_where_its_area_grows():
    stage = {"edge_force": [{"set": "top", "total": [0, 4200]}]}
    often, recording = run(bar(stage, {"every": 0.25, "size": 2.2}))
    (load,) = recording.procedure.model.stages[0].edge_forces
    assert isinstance(load, EdgeForce)
    assert recording.procedure.state.nodes.external_force[:, 1].sum() == pytest.approx(4200.0, rel=1e-12)
    assert often["remeshes"][-1] >= 3


@pytest.mark.parametrize(
    ("changes", "key", "fault"),
    [
        ({"boundary": {"all": {"set": "half", "fix": ["x"]}}}, "boundary.all.set", ""),
        ({"remesh": {"bodies": {"ringg": {"size": 1.0}}}}, "remesh.bodies.ringg", "no such body"),
    ],
)
def test_places_that_new_meshes_cannot_keep_are_refused(changes, key, fault):
    case = bar(STAGES["displacement"], changes.get("remesh", {}), boundary=changes.get("boundary"))
    with pytest.raises(CaseError) as error:
        build_model(case)
    assert key in str(error.value)
    assert fault in str(error.value)
