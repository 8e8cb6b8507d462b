# SPDX-License-Identifier: Apache-2.0
"""Explicit bodies of tetrahedra in space that touch each other on new meshes: conservation, contact, the same bits."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.interaction.bodies.space_interface import SpaceInterface
from presswork.observe.marked_points import find_marked
from presswork.process.begin import begin
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.new_meshes import IntervalMeshes
from presswork.process.explicit.present_bodies import list_nodes
from tests.problems.touching_bodies import FLYING, HEAT_OF_STACK, STACK, write_case
from tests.regression.whole_runs import compare_with_restart

pytest.importorskip("mmgpy", reason="new meshes in space are made by mmgpy")

NEVER, OFTEN = (
    "enabled = false",
    "every = 0.34\nsize = 1.4\nsmallest_size = 0.7\n[remesh.bodies.upper]\nsize = 1.4\nsmallest_size = 0.7",
)
TWO = "size = 1.4\nsmallest_size = 0.7\n[remesh.bodies.upper]\nsize = {upper}\nsmallest_size = 0.7"


def write(folder: Path, remesh: str, text: str = STACK, **changes: Any) -> Path:
    return write_case(folder, text + "[remesh]\n" + remesh + "\n", **changes)


def start(folder: Path, remesh: str, rows: int, text: str = STACK, **changes: Any) -> ExplicitForming:
    """Return a run after some rows."""
    run = begin(build_model(read_case(write(folder, remesh, text, **changes))), threads=1)
    assert isinstance(run, ExplicitForming)
    for _ in itertools.islice(run.advance(), rows):
        pass
    return run


def measure_gaps(run: ExplicitForming) -> np.ndarray:
    """Return the mean gaps of the nodes of the slave that face the master [mm]."""
    interface = SpaceInterface(run.model, run.model.contacts[0], 0)
    interface.search(run.solids.position)
    gap = np.asarray(interface.measure_gaps(run.solids.position).gap)
    return gap[np.isfinite(gap)]


def measure_momenta(run: ExplicitForming) -> np.ndarray:
    return np.array([run.solids.mass[own] @ run.solids.velocity[own] for own in list_nodes(run)])


def test_force_on_new_meshes_of_two_bodies_is_that_on_one_mesh_each(tmp_path: Path) -> None:
    rows = {}
    for name, remesh in (("one", NEVER), ("new", OFTEN)):
        run = begin(build_model(read_case(write(tmp_path, remesh))), threads=1)
        rows[name] = [run.row(report) for report in run.advance()]
    assert rows["new"][-1]["remeshes"] >= 2
    for column in ("die.force", "joint.force_z"):
        one, new = (np.array([row[column] for row in rows[name]]) for name in ("one", "new"))
        np.testing.assert_allclose(new[3:-1], one[3:-1], rtol=0.03)  # in the last row tools stop, and masses differ
    assert abs(rows["new"][-1]["energy_error_percent"]) < 1.0
    assert isinstance(run, ExplicitForming)
    meshes = run.observers.find(IntervalMeshes)
    np.testing.assert_allclose(meshes.bodies.measure(), meshes.first_volumes, rtol=2e-3)


def test_a_body_that_is_not_meshed_anew_keeps_its_mesh_and_state_to_the_bit(tmp_path: Path) -> None:
    run = start(tmp_path, TWO.format(upper=1.4), 4)
    before, points, body = run.solids.state_as_given().to_arrays(), run.model.mesh.points, run.model.bodies[1].points
    assert run.observers.find(IntervalMeshes).remesh("asked for", {0})
    after, own = run.solids.state_as_given().to_arrays(), run.model.bodies[1].points
    assert run.model.bodies[0].points.stop != body.start
    names = [name for name in before if name.startswith("solids.") and name.endswith(".1")]
    assert len(names) > 3
    assert [name for name in names if not np.array_equal(before[name], after[name])] == []
    for name in ("nodes.position", "nodes.velocity"):
        assert np.array_equal(before[name][list(body)], after[name][list(own)])
    assert np.array_equal(points[list(body)], run.model.mesh.points[list(own)])
    assert run.observers.find(IntervalMeshes).first_volumes[1] == pytest.approx(125.0)


@pytest.mark.parametrize(("upper", "slave"), [(1.1, 1), (2.5, 0)])
def test_a_joint_presses_on_as_it_did(tmp_path: Path, upper: float, slave: int) -> None:
    """With coarser cells the upper block is the master from then on."""
    run = start(tmp_path, TWO.format(upper=upper), 5)
    before, gap, work = run.contacts.row(), measure_gaps(run), run.contacts.added[0].lost
    assert run.observers.find(IntervalMeshes).remesh("asked for")
    assert run.model.contacts[0].slave == slave
    assert run.contacts.added[0].lost == work
    assert measure_gaps(run).min() > 2.0 * gap.min()  # springs sink in, and no deeper for the new mesh
    next(run.advance())
    after = run.contacts.row()
    assert after["joint.force_z"] == pytest.approx(before["joint.force_z"], rel=0.05)


def test_bodies_that_strike_each_other_keep_momentum_and_energy_on_new_meshes(tmp_path: Path) -> None:
    sizes = "size = 2.5\nsmallest_size = 1.5\n[remesh.bodies.upper]\nsize = 2.5\nsmallest_size = 1.5"
    run = start(tmp_path, sizes, 2, FLYING, element="tet4_nodal")
    assert (run.contacts.added[0].pressure > 0.0).any()
    before, masses = measure_momenta(run), run.observers.find(IntervalMeshes)._measure_masses()
    assert run.observers.find(IntervalMeshes).remesh("asked for")
    np.testing.assert_allclose(measure_momenta(run), before, atol=1e-12 * np.abs(before).max())
    np.testing.assert_allclose(run.observers.find(IntervalMeshes)._measure_masses(), masses, rtol=1e-12)
    rows = [run.row(report) for report in run.advance()]
    after = measure_momenta(run)
    np.testing.assert_allclose(after.sum(axis=0), before.sum(axis=0), atol=1e-11 * np.abs(before).max())
    assert np.abs(after - before).max() > 0.01 * np.abs(before).max()  # they have gone on pushing each other
    assert abs(rows[-1]["energy_error_percent"]) < 1.0


@pytest.mark.validation
def test_a_marked_point_beside_a_joint_stays_in_its_body(tmp_path: Path) -> None:
    marks = "[points]\nlower = [1.0, 1.0, 4.999]\nupper = [1.0, 1.0, 5.001]\n"
    run = start(tmp_path, OFTEN, 0, STACK + marks)
    for _ in run.advance():
        bodies = [
            [number for number, body in enumerate(run.model.bodies) if node in body.points]
            for node in find_marked(run).nodes[:, 0]
        ]
        assert bodies == [[0], [1]]
    assert run.epoch >= 2


@pytest.mark.validation
def test_a_restart_and_threads_give_the_same_bits(tmp_path: Path) -> None:
    model = build_model(read_case(write(tmp_path, OFTEN)))
    compare_with_restart(model, 5, 2, until=7)


@pytest.mark.validation
def test_results_have_the_meshes_of_all_bodies(tmp_path: Path) -> None:
    result = run_model(build_model(read_case(write(tmp_path, OFTEN))), tmp_path / "out", threads=1).result
    assert result.summary["remeshes"] >= 2
    first, last = result.field("body", step=0), result.field("body", step=-1)
    assert len(first) != len(last)
    assert set(last) == {0, 1}
    moved = result.points(-1)
    assert moved[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert moved[:, 2].max() == pytest.approx(10.0 - result.history["die.stroke"][-1], abs=1e-6)


@pytest.mark.validation
def test_heat_passes_between_bodies_on_new_meshes_and_none_is_lost(tmp_path: Path) -> None:
    text = (STACK + HEAT_OF_STACK).replace("[bodies.upper]\n", "[bodies.upper]\ninitial_temperature = 100\n")
    run = start(tmp_path, OFTEN, 4, text)
    stored = run.heat.forming.stored_in_bodies(run.heat.arrays)
    assert run.observers.find(IntervalMeshes).remesh("asked for", {1})
    found = run.heat.forming.stored_in_bodies(run.heat.arrays)
    np.testing.assert_allclose(found, stored, rtol=1e-9)
    row = [run.row(report) for report in run.advance()][-1]
    assert row["remeshes"] >= 2
    made = row["heat_plastic"] + row["heat_friction"]
    assert row["heat_stored"] == pytest.approx(made, rel=1e-6)
    degrees, (lower, upper) = run.heat.arrays.temperature, list_nodes(run)
    assert degrees[lower].min() < 290.0
    assert degrees[upper].max() > 110.0
