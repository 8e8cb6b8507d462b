# SPDX-License-Identifier: Apache-2.0
"""New meshes of bodies in space that touch each other: what holds on the first mesh holds on the next ones."""

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.space.schema import SpaceCase
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.process.begin import begin
from presswork.process.implicit.new_meshes import NewMeshes


def press(remesh, *, stroke=0.8, fine=False, checkpoints=100):
    """A quarter of a hard block of 10 x 10 x 4 mm that a flat die presses into a soft one of 16 x 16 x 5 mm."""
    block = {"element": "tet4_mini"}
    upper = {"origin": [0, 0, 5], "size": [5, 5, 4], "cells": [6, 6, 4] if fine else [4, 4, 3]}
    return SpaceCase(
        title="two blocks",
        analysis="solid",
        workpiece=block | {"material": "soft", "mesh": {"size": [8, 8, 5], "cells": [8, 8, 5] if fine else [5, 5, 3]}},
        bodies={"upper": block | {"material": "hard", "mesh": upper}},
        contacts={"joint": {"between": ["workpiece", "upper"], "contact": "coulomb", "mu": 0.2}},
        materials={
            "soft": {"young": 70e3, "poisson": 0.33, "hardening": {"law": "swift", "K": 200, "e0": 0.01, "n": 0.2}},
            "hard": {"young": 210e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 400, "e0": 0.01, "n": 0.2}},
        },
        tools={"die": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 9], "contact": "shear", "m": 0.2}},
        boundary={
            "x": {"set": "left", "fix": ["x"]},
            "y": {"set": "bottom", "fix": ["y"]},
            "z": {"set": "back", "fix": ["z"]},
            "upper_x": {"set": "upper.left", "fix": ["x"]},
            "upper_y": {"set": "upper.bottom", "fix": ["y"]},
        },
        stages=[{"name": "press", "tools": {"die": {"stroke": stroke, "direction": [0, 0, -1]}}}],
        solver={"max_increment": 0.1},
        output={"steps": 1, "checkpoint_every": checkpoints},
        remesh=remesh,
    )


SIZES = {"size": 1.5, "smallest_size": 0.7, "bodies": {"upper": {"size": 1.25, "smallest_size": 0.7}}}

FINE = {"size": 1.1, "smallest_size": 0.6, "bodies": {"upper": {"size": 0.9, "smallest_size": 0.5}}}


def stop_after(case, n):
    recording = begin(build_model(case), 1)
    for _ in zip(range(n), recording.advance(), strict=False):
        pass
    return recording


def test_a_body_in_space_that_is_not_meshed_anew_keeps_its_mesh_and_state_to_the_bit():
    recording = stop_after(press(SIZES), 5)
    before = recording.procedure
    kept = {name: getattr(before.state.cells, name)[1].copy() for name in ("stress", "eqps", "history")}
    points = before.model.mesh.points + before.state.nodes.moved
    bodies, body = recording.observers.find(NewMeshes).bodies, before.model.bodies[1]
    after, _ = bodies.make(bodies.find(), {0}, 1.0)
    for name, values in kept.items():
        assert np.array_equal(getattr(after.state.cells, name)[1], values), name
    own = after.model.bodies[1].points
    assert np.array_equal(after.model.mesh.points[own.start : own.stop], points[body.points.start : body.points.stop])
    assert len(after.model.bodies[0].points) != len(before.model.bodies[0].points)


@pytest.mark.validation
@pytest.mark.parametrize("size", [1.25, 3.0])
def test_pressure_and_shear_pass_to_the_surface_that_is_the_slave_now(size):
    """With coarser cells the upper block is the master from then on; what the joint passes stays, and its direction."""
    sizes = SIZES | {"bodies": {"upper": {"size": size, "smallest_size": min(size, 2.5)}}}
    recording = stop_after(press(sizes), 6)
    before = recording.procedure
    passed = before.interactions.bodies.total_forces(before.state)["joint"]
    assert recording.observers.find(NewMeshes).remesh("asked for", must=True)
    after = recording.procedure
    (contact,) = after.model.contacts
    assert contact.slave == (1 if size < 2 else 0)
    again = after.interactions.bodies.total_forces(after.state)["joint"]
    assert again[2] == pytest.approx(passed[2], rel=0.06)
    assert again[:2] == pytest.approx(passed[:2], abs=0.02 * passed[2])
    # no slot that presses is open, or deeper in than what its pressure takes; those that hang over the master's edge
    # touch it with hundredths of a mm2
    joint = after.state[InterfaceArrays]
    nodes = np.concatenate(after.interactions.bodies.surface_nodes())
    bears = np.linalg.norm(joint.force[nodes], axis=1) > 0.005 * again[2]
    assert joint.pressure[bears].max() < 500.0


def test_sizes_of_a_body_that_there_is_not_are_refused():
    with pytest.raises(CaseError) as error:
        build_model(press(SIZES | {"bodies": {"uper": {"size": 1.0}}}))
    assert "remesh.bodies.uper" in str(error.value)
    assert "no such body" in str(error.value)
