# SPDX-License-Identifier: Apache-2.0
"""A run whose mesh changes on the way: another numbering changes nothing, and a resumed run gives the same bits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.evolution.points import EvolvedArrays
from presswork.examples import copy_example
from presswork.implicit.epochs import Epoch, NextMesh
from presswork.implicit.progress import Progress
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import Model
from presswork.process.implicit.asked_mesh import AskedMesh
from presswork.process.implicit.forming import ImplicitForming
from presswork.recorder import Outcome, run_model
from presswork.results.history import read_history
from tests.problems.renumbered import renumber, touching
from tests.regression.whole_runs import assert_same_bits, stop_after

CHANGED_AFTER = 4

BILLET: dict[str, Any] = {
    "title": "billet upset with friction",
    "analysis": "axisymmetric",
    "workpiece": {
        "material": "steel",
        "element": "quad4_fbar",
        "mesh": {"kind": "rectangle", "size": [10.0, 15.0], "cells": [4, 6]},
    },
    "materials": {
        "steel": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "swift", "K": 700.0, "e0": 0.01, "n": 0.2}}
    },
    "tools": {"punch": {"profile": [[-1, 15], [30, 15]], "contact": "shear", "m": 0.3}},
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "stages": [
        {"name": "upset", "tools": {"punch": {"stroke": 2.0, "direction": [0, -1]}}},
        {"name": "lift", "tools": {"punch": {"stroke": 0.5, "direction": [0, 1]}}},
    ],
    "solver": {"initial_increment": 0.1, "max_increment": 0.1, "force_tolerance": 1e-10},
    "output": {"steps": 2, "checkpoint_every": 3},
}


def ask(epoch: Epoch) -> NextMesh | None:
    return renumber(epoch.mesh) if epoch.state[Progress].increments == CHANGED_AFTER else None


def ask_for_a_mesh_without_sets(epoch: Epoch) -> NextMesh:
    change = renumber(epoch.mesh)
    del change.mesh.node_sets["bottom"]  # type: ignore[attr-defined]
    return change


def run(folder: Path, hook: Any = ask, case: dict[str, Any] = BILLET, **options: Any) -> Outcome:
    def begin(model: Model, threads: int) -> ImplicitForming:
        recording = ImplicitForming(model, threads=threads)
        if hook is not None:
            recording.add_mesh_change(AskedMesh(recording, hook))
        return recording

    return run_model(build_model(Case.model_validate(case)), folder, threads=1, procedure=begin, **options)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("epochs") / "whole"
    assert run(folder).status == "completed"
    return folder


def test_another_numbering_changes_nothing_but_round_off(whole: Path, tmp_path: Path) -> None:
    """Sums are added up in another order. Newton's method takes the same ways while the punch presses; where it lifts,
    round-off decides which node of no force lets go first.
    """
    assert run(tmp_path / "out", hook=None).status == "completed"
    found, wanted = (read_history(folder / "history.csv") for folder in (whole, tmp_path / "out"))
    assert list(found) == list(wanted)
    for name in wanted:
        if wanted[name].dtype.kind == "f":
            scale = np.abs(wanted[name]).max()
            np.testing.assert_allclose(found[name], wanted[name], rtol=0.0, atol=1e-8 * scale + 1e-12, err_msg=name)
    pressed = wanted["stage"] == "upset"
    np.testing.assert_array_equal(found["iterations"][pressed], wanted["iterations"][pressed])


def test_results_keep_the_mesh_of_each_epoch(whole: Path) -> None:
    with h5py.File(whole / "results.vtkhdf") as file:
        assert sorted(file["presswork/meshes"]) == ["0", "1"]
    assert "new mesh of 24 cells after increment 4 renumbered" in (whole / "run.log").read_text()


@pytest.mark.parametrize("reports", [2, CHANGED_AFTER, CHANGED_AFTER + 1, 12])
def test_a_run_resumed_before_or_after_the_change_gives_the_same_bits(whole: Path, tmp_path: Path, reports) -> None:
    assert run(tmp_path / "out", on_increment=stop_after(reports)).status == "interrupted"
    assert run(tmp_path / "out", resume=True).status == "completed"
    assert_same_bits(tmp_path / "out", whole)


def test_another_mesh_is_asked_for_once_where_an_increment_fails(tmp_path: Path) -> None:
    failures: list[str] = []

    def ask_where_it_fails(epoch: Epoch) -> NextMesh | None:
        failures.append(epoch.failure)
        return renumber(epoch.mesh) if epoch.failure else None

    few = {
        **BILLET,
        "solver": {"initial_increment": 0.1, "max_increment": 0.1, "min_increment": 0.05, "max_iterations": 2},
    }
    outcome = run(tmp_path / "out", hook=ask_where_it_fails, case=few)
    assert outcome.status == "gave_up"
    assert len(failures) == 1
    assert "finds no equilibrium" in failures[0], "the other mesh fails as well, and is not asked for another"
    with h5py.File(tmp_path / "out" / "results.vtkhdf") as file:
        assert sorted(file["presswork/meshes"]) == ["0", "1"]


def test_a_mesh_without_a_set_that_the_model_names_stops_the_run(tmp_path: Path) -> None:
    outcome = run(tmp_path / "out", hook=ask_for_a_mesh_without_sets)
    assert outcome.status == "gave_up"
    assert "the new mesh has no node set 'bottom'" in outcome.reason


SIDE_BY_SIDE = ["stages.0.tools.punch.stroke=2", "solver.max_increment=0.05", "output.steps=1"]
SIDE_BY_SIDE += ["bodies.ring.mesh.size=[4,10.6]", "bodies.ring.mesh.origin=[6.2,0]", "bodies.ring.mesh.cells=[4,7]"]
SIDE_BY_SIDE += ["tools.punch.profile=[[0,10.6],[30,10.6]]"]


def test_one_of_two_bodies_changes_its_mesh_and_both_go_on(tmp_path: Path) -> None:
    """The core has more cells from the third increment on, while the ring alone is pressed: as if from the start."""
    path = copy_example("two_bodies", tmp_path)
    coarse, fine = (
        build_model(Case.from_toml(path, [*SIDE_BY_SIDE, f"workpiece.mesh.cells={cells}"]))
        for cells in ([3, 8], [5, 10])
    )

    def ask_for_more_cells(epoch: Epoch) -> NextMesh | None:
        return NextMesh(fine.mesh, carry_ring) if epoch.state[Progress].increments == 3 else None

    histories = {}
    for name, model, hook in (("changed", coarse, ask_for_more_cells), ("from the start", fine, None)):
        recording = ImplicitForming(model, threads=1)
        if hook is not None:
            recording.add_mesh_change(AskedMesh(recording, hook))
        outcome = run_model(model, tmp_path / name, procedure=lambda _, __, r=recording: r)
        assert outcome.status == "completed"
        assert recording.model.bodies == fine.bodies
        histories[name] = read_history(tmp_path / name / "history.csv")
    found, wanted = histories.values()
    assert wanted["bore.force_x"][2] == 0.0, "the core is still untouched"
    assert wanted["bore.force_x"][-1] > 1e3
    for name in wanted:
        if wanted[name].dtype.kind == "f":
            scale = np.abs(wanted[name]).max()
            np.testing.assert_allclose(found[name], wanted[name], rtol=0.0, atol=1e-8 * scale + 1e-12, err_msg=name)


def carry_ring(before: Epoch, after: Epoch) -> None:
    """Fill the State of the ring, whose mesh stays; the core is at rest."""
    old, new = before.state, after.state
    ring_n, ring = (np.asarray(epoch.run.model.bodies[1].points) for epoch in (before, after))
    for name in ("displacement", "increment", "reaction", "external_force"):
        getattr(new.nodes, name)[ring] = getattr(old.nodes, name)[ring_n]
    for name in ("stress", "eqps", "history", "temperature", "hourglass"):
        getattr(new.cells, name)[1] = getattr(old.cells, name)[1].copy()
    for name, blocks in old[EvolvedArrays].values.items():
        new[EvolvedArrays].values[name][1] = blocks[1].copy()
    held_n, held = (np.isin(touching(epoch.mesh), own) for epoch, own in ((before, ring_n), (after, ring)))
    old_contact, contact = old[ContactArrays], new[ContactArrays]
    contact.status[:, held] = old_contact.status[:, held_n]
    for name in ("anchor", "drag", "shear_part"):
        getattr(contact, name)[held] = getattr(old_contact, name)[held_n]
