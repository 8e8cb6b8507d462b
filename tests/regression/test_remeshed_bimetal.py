# SPDX-License-Identifier: Apache-2.0
"""Two hot bodies of different metals, pressed together while both get new meshes."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from presswork import Case, build_model
from presswork.examples import copy_example
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.process.begin import begin
from presswork.process.implicit.forming import ImplicitForming
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.recorder import run_model
from tests.regression.whole_runs import run_in_two_parts

KEYS = [
    "workpiece.mesh.cells=[6,8]", "bodies.ring.mesh.cells=[4,8]", "remesh.size=2.5", "remesh.bodies.ring.size=2.0",
    "remesh.every=0.2", "stages.0.tools.die.stroke=6", "output.steps=3", "output.checkpoint_every=1",
]  # fmt: skip


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory):
    return build_model(Case.from_toml(copy_example("bimetal_upsetting", tmp_path_factory.mktemp("bimetal")), KEYS))


@pytest.fixture(scope="module")
def whole(model, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bimetal") / "whole"
    assert run_model(model, folder, threads=1).status == "completed"
    return folder


def test_heat_closes_over_new_meshes_of_both_bodies(whole: Path) -> None:
    summary = json.loads((whole / "summary.json").read_text())
    assert summary["remeshes"] >= 3
    assert summary["heat"]["balance_error"] < 1e-8
    assert abs(summary["energy"]["error_percent"]) < 1.0
    with h5py.File(whole / "results.vtkhdf") as file:
        counts = np.asarray(file["VTKHDF/Steps/PartOffsets"])
    assert len(counts) >= 3


def test_no_body_loses_heat_to_the_other_on_new_meshes(model) -> None:
    """What each body has stored stays to round-off as both meshes change, where nothing but the mesh does."""
    recording = begin(model, 1)
    assert isinstance(recording, ImplicitForming)
    bodies = recording.observers.find(NewMeshes).bodies
    for _ in zip(range(8), recording.advance(), strict=False):
        pass
    before = recording.procedure
    after, _ = bodies.make(bodies.find(), {0, 1}, 1.0)
    assert all(
        len(new.connectivity) != len(old.connectivity)
        for new, old in zip(after.model.mesh.blocks, before.model.mesh.blocks, strict=True)
    )
    assert before.heat is not None
    assert after.heat is not None
    wanted = before.heat.forming.stored_in_bodies(before.state[HeatArrays])
    found = after.heat.forming.stored_in_bodies(after.state[HeatArrays])
    assert wanted[0] > 0.0 > wanted[1]  # the ring heats the core
    assert found == pytest.approx(wanted, rel=1e-9)


def test_heat_closes_where_one_body_keeps_its_mesh(model) -> None:
    recording = begin(model, 1)
    assert isinstance(recording, ImplicitForming)
    bodies = recording.observers.find(NewMeshes).bodies
    for _ in zip(range(8), recording.advance(), strict=False):
        pass
    before = recording.procedure
    after, _ = bodies.make(bodies.find(), {1}, 1.0)
    assert before.heat is not None
    assert after.heat is not None
    core = model.bodies[0].points.stop
    temperatures = [run.state[HeatArrays].temperature[:core] for run in (before, after)]
    np.testing.assert_array_equal(*temperatures)
    wanted = before.heat.forming.stored_in_bodies(before.state[HeatArrays])
    found = after.heat.forming.stored_in_bodies(after.state[HeatArrays])
    assert found.sum() == pytest.approx(wanted.sum(), abs=1e-9 * np.abs(wanted).max())
    assert found == pytest.approx(wanted, rel=2e-3)


@pytest.mark.validation
def test_a_resumed_run_gives_the_same_bits(model, whole: Path, tmp_path: Path) -> None:
    run_in_two_parts(model, tmp_path / "halves", lambda progress: progress.text.startswith("upset: increment 25,"))
    assert (whole / "history.csv").read_bytes() == (tmp_path / "halves/history.csv").read_bytes()
