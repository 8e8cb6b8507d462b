# SPDX-License-Identifier: Apache-2.0
"""Whole runs with contact of bodies: the same bits however they are run and resumed; the files show both bodies."""

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, OutputError, Result, run
from presswork.examples import copy_example
from tests.regression.whole_runs import assert_same_bits, stop_after

SMALL = {
    "two_bodies": ["workpiece.mesh.cells=[6,10]", "bodies.ring.mesh.cells=[4,7]", "output.checkpoint_every=3"],
    "self_contact": ["workpiece.mesh.cells=[3,40]", "stages.0.tools.punch.stroke=18.5", "output.checkpoint_every=7"],
}


@pytest.fixture(scope="module", params=["two_bodies", pytest.param("self_contact", marks=pytest.mark.validation)])
def case(request, tmp_path_factory) -> Case:
    path = copy_example(request.param, tmp_path_factory.mktemp("case"))
    return Case.from_toml(path, SMALL[request.param])


@pytest.fixture(scope="module")
def reference(case, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "reference"
    assert run(case, folder, threads=1).status == "completed"
    return folder


def test_interrupted_run_with_body_contact_resumes_to_the_same_bits(case, reference, tmp_path) -> None:
    assert run(case, tmp_path / "out", on_increment=stop_after(20), threads=1).status == "interrupted"
    for count in (1, 13, 17):
        resumed = run(case, tmp_path / "out", resume=True, on_increment=stop_after(count), threads=1)
        assert resumed.status == "interrupted"
    assert run(case, tmp_path / "out", resume=True, threads=2).status == "completed"
    assert_same_bits(tmp_path / "out", reference)


def test_bodies_push_each_other_with_the_same_force(case, reference) -> None:
    """What the results show of a contact: fields at its nodes, forces in the history that balance."""
    result = Result(reference)
    name = next(iter(case.contacts))
    assert np.hypot(result.history[f"{name}.force_x"], result.history[f"{name}.force_y"]).max() > 1e3
    force = result.field("contact_force")[:, :2]
    pressure, shear = result.field("contact_pressure"), result.field("contact_shear")
    x = result.points()
    between = (pressure > 0) & (np.abs(x[:, 1] - x[:, 1].max()) > 1e-6) & (np.abs(x[:, 1]) > 1e-6)
    assert between.sum() >= 4
    assert np.abs(force[between].sum(axis=0)).max() < 0.2 * np.abs(force[between]).sum()
    inside = between & (np.abs(shear) > 0)
    assert (np.abs(shear[inside]) <= 0.1 * pressure[inside] * 1.2 + 1e-9).all()
    if case.bodies:
        assert set(np.unique(result.field("body"))) == {0.0, 1.0}


@pytest.mark.validation
def test_a_sliver_of_contact_beside_a_corner_asks_for_no_augmentations(tmp_path) -> None:
    """On a punch with m = 1 the ring's upper corner ends a few hundredths of an edge above a node of the core."""
    case = Case.from_toml(copy_example("two_bodies", tmp_path), ["tools.punch.m=1", "stages.0.tools.punch.stroke=4.25"])
    assert run(case, tmp_path / "out", threads=1).status == "completed"
    rows = Result(tmp_path / "out").history
    assert len(rows["increment"]) < 70
    assert rows["iterations"].max() < 20


def test_checkpoint_of_another_contact_is_refused(case, reference, tmp_path) -> None:
    name = next(iter(case.contacts))
    other = case.model_copy(update={"contacts": {name: case.contacts[name].model_copy(update={"mu": 0.2})}})
    with pytest.raises(OutputError, match="belongs to another case"):
        run(other, reference, resume=True)
