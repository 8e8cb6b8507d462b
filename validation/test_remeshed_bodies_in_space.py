# SPDX-License-Identifier: Apache-2.0
"""Force and contact of bodies in space through new meshes, on cells fine enough to judge, implicit and explicit."""

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.process.begin import begin
from presswork.process.explicit.new_meshes import IntervalMeshes
from presswork.recorder import run_model
from tests.problems.touching_bodies import STACK, write_case
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts
from tests.verification.test_remeshed_bodies_in_space import FINE, press

pytestmark = pytest.mark.validation


def follow(case):
    recording = begin(build_model(case), 1)
    rows = [recording.row(report) for report in recording.advance()]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, recording


def test_contact_of_bodies_in_space_survives_new_meshes():
    once, _ = follow(press({"enabled": False}, fine=True))
    often, recording = follow(press(FINE | {"every": 0.3}, fine=True))
    assert often["remeshes"][-1] >= 2
    stroke = np.linspace(0.2, 0.8, 7)
    for key in ("die.force", "joint.force_z"):
        wanted, found = (np.interp(stroke, rows["die.stroke"], rows[key]) for rows in (once, often))
        assert np.abs(found / wanted - 1).max() < 0.02
    procedure = recording.procedure
    plastic = procedure.volume() - procedure.mechanics.elastic_dilatation(procedure.state) - procedure.initial_volume
    assert abs(plastic / procedure.initial_volume) < 1e-3
    assert abs(procedure.energy_balance()["error_percent"]) < 1.0


def test_runs_with_new_meshes_of_bodies_in_space_resume_to_the_same_bits(tmp_path):
    model = build_model(press(FINE | {"every": 0.5}, stroke=0.6, fine=True, checkpoints=1))
    whole = run_model(model, tmp_path / "whole", threads=1)
    assert whole.status == "completed"
    assert whole.result.summary["remeshes"] >= 1
    parts = run_in_two_parts(model, tmp_path / "halves", lambda now: now.text.startswith("press: increment 7,"))
    assert_same_bits(parts.folder, tmp_path / "whole")


SIZES = """[remesh]
every = 0.25
size = 1.4
smallest_size = 0.7
[remesh.bodies.upper]
size = 1.4
smallest_size = 0.7
"""


def stack(folder, remesh, **changes):
    """Return a run of two blocks upset by 4 of 10 mm, after its end, with its rows."""
    text = (
        STACK.replace("0.9 ms", "4 ms")
        .replace("stroke = 0.9", "stroke = 4")
        .replace("steps = 3\nrows = 9", "steps = 4\nrows = 40")
    )
    for old, new in changes.get("words", ()):
        assert old in text
        text = text.replace(old, new)
    return follow(read_case(write_case(folder, text.replace("0.4 us", "0.3 us") + remesh)))


def test_two_explicit_blocks_upset_on_new_meshes_are_those_on_a_fine_mesh_and_of_the_implicit_procedure(tmp_path):
    often, run = stack(tmp_path, SIZES)
    cells = [("cells = [5, 5, 4]", "cells = [9, 9, 7]"), ("cells = [4, 4, 4]", "cells = [8, 8, 7]")]
    fine, _ = stack(tmp_path, "[remesh]\nenabled = false\n", words=cells)
    slow = [('procedure = "explicit"', ""), ("tet4_nodal", "tet4_mini"), ("rows = 40", ""), ('duration = "4 ms"', "")]
    slow += [('[explicit]\ntarget_step = "0.4 us"', ""), ("stroke = 4", "stroke = 2.6")]
    implicit, _ = stack(tmp_path, SIZES, words=slow)
    assert often["remeshes"][-1] >= 4
    assert implicit["remeshes"][-1] >= 1  # it puts off those that change the force
    middle = 0.5 * (often["die.stroke"][1:] + often["die.stroke"][:-1])  # forces are means over rows
    late = (middle > 0.5) & (middle < 3.8)
    force = often["joint.force_z"][1:]
    wanted = np.interp(middle, implicit["die.stroke"], implicit["joint.force_z"])
    of_fine, of_implicit = force / fine["joint.force_z"][1:], (force / wanted)[middle < 2.5]
    print(f"{np.abs(of_fine[late] - 1.0).max():.2%}, {np.abs(of_implicit[5:] - 1.0).max():.2%}")
    assert np.abs(of_fine[late] - 1.0).max() < 0.02
    assert np.abs(of_implicit[5:] - 1.0).max() < 0.02
    meshes = run.observers.find(IntervalMeshes)
    print(np.array(meshes.bodies.measure()) / meshes.first_volumes - 1.0, often["energy_error_percent"][-1])
    assert abs(sum(meshes.bodies.measure()) / sum(meshes.first_volumes) - 1.0) < 1e-3
    assert abs(often["energy_error_percent"][-1]) < 0.5
