# SPDX-License-Identifier: Apache-2.0
"""Force and contact of bodies in space through new meshes, on cells fine enough to judge."""

import numpy as np
import pytest

from presswork import build_model
from presswork.process.begin import begin
from presswork.recorder import run_model
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
