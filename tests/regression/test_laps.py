# SPDX-License-Identifier: Apache-2.0
"""Laps: where the surface of a body folds onto itself the part has a fault, and every view says so."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from presswork import Case, build_model
from presswork.examples import copy_example
from presswork.interaction.laps import LapArrays, list_laps
from presswork.process.begin import begin
from presswork.recorder import run_model
from presswork.remesh import section
from presswork.remesh.boundary import NewLine
from presswork.results import Result
from presswork.view.mesh_plot import plot_contours

mpl.use("Agg")


@pytest.fixture(scope="module")
def crushed(tmp_path_factory) -> Path:
    """The packaged tube, whose fold closes on itself, on meshes that change."""
    folder = tmp_path_factory.mktemp("laps")
    path = copy_example("self_contact", folder)
    model = build_model(Case.from_toml(path, ["remesh.size=0.5", "output.steps=4"]))
    assert run_model(model, folder / "run", threads=1).status == "completed"
    return folder / "run"


def test_a_fold_that_closes_is_a_lap_in_summary_field_and_picture(crushed):
    result = Result(crushed)
    assert result.summary["remeshes"] >= 1
    (lap,) = result.summary["laps"]
    points, mark = result.points(-1), result.field("lap")
    assert 20.0 < lap["x_mm"] < points[:, 0].max()
    assert points[mark > 0.5][:, :2].mean(axis=0) == pytest.approx([lap["x_mm"], lap["y_mm"]])
    assert result.field("lap", 1).max() == 0.0, "half way down the fold is open"
    (warning,) = (w for w in result.summary["warnings"] if "lap" in w)
    assert "a fault of the part" in warning
    closed, still_open = (plot_contours(result, "equivalent_plastic_strain", step).get_title() for step in (-1, 1))
    assert "lap (red)" in closed
    assert "lap" not in still_open
    mpl.pyplot.close("all")


def test_a_loop_that_a_new_mesh_leaves_out_is_marked_and_goes_along(tmp_path, monkeypatch):
    """The new line says that it has left out a loop beside a node: the mark stays with the material."""
    path = copy_example("forging_hub", tmp_path)
    recording = begin(build_model(Case.from_toml(path, ["remesh.size=1.0"])), 1)
    next(recording.advance())
    real = section.resample

    def with_lap(old, size):
        line = real(old, size)
        free = np.flatnonzero(line.is_free)
        return NewLine(line.points, line.place, line.is_free, line.offset, free[:3])

    monkeypatch.setattr(section, "resample", with_lap)
    assert recording._remesh("asked for")
    monkeypatch.undo()
    state, mesh = recording.procedure.state, recording.procedure.model.mesh
    (before,) = list_laps(state, mesh)
    assert state[LapArrays].begun >= 0.0
    assert recording._remesh("asked for again")
    (after,) = list_laps(recording.procedure.state, recording.procedure.model.mesh)
    assert after == pytest.approx(before, abs=1.0)
    assert recording.procedure.state[LapArrays].begun == state[LapArrays].begun
