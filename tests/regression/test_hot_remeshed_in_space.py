# SPDX-License-Identifier: Apache-2.0
"""Hot bodies of tetrahedra between cold dies, whose mesh changes in the run."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.process.begin import begin
from presswork.process.implicit.new_meshes import NewMeshes
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

TEXT = """
title = "a quarter of a hot block is upset"
analysis = "solid"
[workpiece]
material = "c45"
element = "tet4_mini"
mesh = {kind = "box", size = [8, 8, 10], cells = [3, 3, 4]}
[materials.c45]
library = "c45"
[heat]
initial_temperature = 900
surroundings = {ambient = 20, emissivity = 0.8, coefficient = "10 W/(m^2*K)"}
[tools.die]
shape = "plane"
normal = [0, 0, -1]
position = [0, 0, 10]
contact = "shear"
m = 0.3
heat = {temperature = 200, conductance = [[0, "2 kW/(m^2*K)"], [100, "10 kW/(m^2*K)"]], warms_up = true, \
conductivity = "25 W/(m*K)", specific_heat = "460 J/(kg*K)", density = "7800 kg/m^3"}
[tools.anvil]
shape = "plane"
normal = [0, 0, 1]
contact = "shear"
m = 0.3
heat = {temperature = 300, conductance = [[0, "2 kW/(m^2*K)"], [100, "10 kW/(m^2*K)"]]}
[boundary.middle_x]
set = "left"
fix = ["x"]
[boundary.middle_y]
set = "bottom"
fix = ["y"]
[[stages]]
name = "press"
duration = 0.2
tools.die = {stroke = 2.0, direction = [0, 0, -1]}
[solver]
max_increment = 0.1
[output]
steps = 1
checkpoint_every = 3
"""
INCOMING = [f"heat_{kind}" for kind in ("plastic", "friction", "tools", "convection", "radiation")]


def make(folder, text):
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    return build_model(read_case(folder / "case.toml"))


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return make(tmp_path_factory.mktemp("case"), TEXT + "[remesh]\nevery = 0.25\n")


@pytest.fixture(scope="module")
def result(model, tmp_path_factory):
    return run_model(model, tmp_path_factory.mktemp("out"), threads=1).result


@pytest.fixture(scope="module")
def untouched(tmp_path_factory):
    made = make(tmp_path_factory.mktemp("case"), TEXT + "[remesh]\nenabled = false\n")
    return run_model(made, tmp_path_factory.mktemp("out"), threads=1).result


@pytest.fixture(scope="module")
def fine(tmp_path_factory):
    finer = TEXT.replace("cells = [3, 3, 4]", "cells = [6, 6, 8]")
    made = make(tmp_path_factory.mktemp("case"), finer + "[remesh]\nenabled = false\n")
    return run_model(made, tmp_path_factory.mktemp("out"), threads=1).result


def test_what_comes_in_is_stored_over_new_meshes(result):
    history = result.history
    assert history["remeshes"][-1] >= 1
    incoming = sum(history[name] for name in INCOMING)
    np.testing.assert_allclose(history["heat_stored"], incoming, rtol=1e-8)


def test_axes_of_the_law_stay_normal_to_each_other_on_a_new_mesh(model):
    """A stress turned to axes that are not, and back, changes: hot runs gave up beyond a new mesh."""
    recording = begin(model, 1)
    for _ in zip(range(5), recording.advance(), strict=False):
        pass
    bodies = recording.observers.find(NewMeshes).bodies
    after, _ = bodies.make(bodies.find(), {0}, 1.0)
    axes = after.state.cells.history[0][..., -6:].reshape(-1, 2, 3)
    assert np.abs(axes[:, 0, 1:]).max() > 1e-3  # the metal has turned
    products = axes @ axes.transpose(0, 2, 1)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(2), products.shape), atol=1e-12)


def test_forces_are_those_of_a_run_on_one_mesh(result, untouched):
    one, other = result.history, untouched.history
    at = np.linspace(0.2, 1.0, 9) * one["time"][-1]
    force, expected = (np.interp(at, h["time"], h["die.force"]) for h in (one, other))
    np.testing.assert_allclose(force, expected, rtol=0.02)


def test_heat_lies_between_that_of_the_first_mesh_and_of_a_finer_one(result, untouched, fine):
    """New meshes are finer than the first, whose cells of 2.6 mm take too much heat through the surface."""
    for column, start in (("temperature_mean", 900.0), ("die.temperature_max", 200.0), ("heat_tools", 0.0)):
        changes = [abs(r.history[column][-1] - start) for r in (fine, result, untouched)]
        assert changes[0] < changes[1] < changes[2] < 1.1 * changes[0]


def test_steel_of_the_die_stays_warm_behind_a_new_mesh(result):
    """The columns of the die behind its nodes go to the nodes of the new surface: no cold steel meets the metal."""
    warmest, meshes = result.history["die.temperature_max"], result.history["remeshes"]
    just_after = np.flatnonzero(np.diff(meshes) > 0) + 1
    assert len(just_after) == meshes[-1] >= 1
    assert (warmest[just_after] > warmest[just_after - 1]).all()


def test_cells_have_the_pressure_of_their_nodes_on_new_meshes(model):
    recording = begin(model, 1)
    meshes: set[int] = set()
    for _ in recording.advance():
        procedure = recording.procedure
        state, mechanics = procedure.state, procedure.mechanics
        (block,), (stress,) = procedure.model.mesh.blocks, state.cells.stress
        pressure = mechanics.pressure_scale * state.nodes.displacement[:, 3][block.connectivity].mean(axis=1)
        np.testing.assert_allclose(stress[:, 0, :3].mean(axis=1), pressure, atol=1e-6)
        meshes = {len(stress)} | meshes
    assert len(meshes) > 1


def test_a_resumed_run_and_two_threads_give_the_same_bits(model, result, tmp_path):
    parts = run_in_two_parts(model, tmp_path / "cut", 8, threads=(2, 1))
    assert_same_bits(parts.folder, result.folder)
