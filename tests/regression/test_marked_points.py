# SPDX-License-Identifier: Apache-2.0
"""Marked points: their paths and what they see, through new meshes, in every family; errors that name the place."""

import matplotlib as mpl
import numpy as np
import pytest

from presswork import Case, CaseError, build_model, read_case
from presswork.examples import copy_example
from presswork.process.begin import begin
from presswork.recorder import run_model
from presswork.results import Result
from presswork.view.all_plots import plot_all
from tests.regression.whole_runs import run_in_two_parts

mpl.use("Agg")


def upsetting(remesh=None, contact="frictionless", **changes):
    """The quarter section of a billet of 10 by 15 mm under a flat platen, 700 + 300 e MPa."""
    hardening = {"law": "linear", "yield_stress": 700, "modulus": 300}
    friction = {"m": 0.15} if contact == "shear" else {}
    return Case(
        **{
            "title": "upsetting",
            "analysis": "axisymmetric",
            "workpiece": {"material": "steel", "mesh": {"size": [10, 15], "cells": [8, 12]}},
            "materials": {"steel": {"young": 2e5, "poisson": 0.3, "hardening": hardening}},
            "tools": {"punch": {"profile": [[0, 15], [40, 15]], "contact": contact, **friction}},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
            "stages": [{"name": "press", "tools": {"punch": {"stroke": 6.0, "direction": [0, -1]}}}],
            "output": {"steps": 3, "checkpoint_every": 1},
            "points": {"inner": [4.1, 6.3], "rim": [10, 15]},
            "remesh": remesh,
        }
        | changes
    )


def run_rows(case):
    recording = begin(build_model(case), 1)
    rows = [recording.row(report) for report in recording.advance()]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def test_homogeneous_upsetting_moves_points_along_their_closed_path_through_new_meshes():
    """y = y0 h / h0, x follows from the volume that plastic flow keeps; strain ln(h0 / h); 19 new meshes."""
    rows = run_rows(upsetting({"every": 0.05, "quality": 0.01}))
    assert rows["remeshes"][-1] >= 19
    height = 1.0 - rows["punch.stroke"] / 15.0
    np.testing.assert_allclose(rows["inner.y"], 6.3 * height, atol=1e-6)
    np.testing.assert_allclose(rows["inner.x"] / 4.1, rows["rim.x"] / 10.0, rtol=1e-7)
    np.testing.assert_allclose(rows["inner.x"], 4.1 / np.sqrt(height), rtol=4e-3)  # elastic compression on top
    strain = -np.log(height[-1])
    assert rows["inner.equivalent_plastic_strain"][-1] == pytest.approx(strain, rel=0.02)
    assert rows["inner.effective_stress"][-1] == pytest.approx(700 + 300 * strain, rel=0.02)
    assert rows["inner.hydrostatic_stress"][-1] == pytest.approx(-rows["inner.effective_stress"][-1] / 3, rel=1e-3)


def test_with_friction_new_meshes_leave_the_path_and_the_values():
    once, often = (run_rows(upsetting(remesh, "shear")) for remesh in ({"enabled": False}, {"every": 0.05}))
    assert often["remeshes"][-1] >= 15
    for name, tolerance in (("inner.x", 0.02), ("inner.y", 0.02), ("inner.effective_stress", 5.0)):
        expected = np.interp(often["punch.stroke"], once["punch.stroke"], once[name])
        assert np.abs(often[name] - expected).max() < tolerance, name
    strain = np.interp(6.0, once["punch.stroke"], once["inner.equivalent_plastic_strain"])
    assert often["inner.equivalent_plastic_strain"][-1] == pytest.approx(strain, rel=0.02)


def test_points_are_in_history_pictures_and_after_a_resume_the_same_bits(tmp_path):
    model = build_model(upsetting({"every": 0.2}, "shear"))
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"

    run_in_two_parts(model, tmp_path / "part", lambda progress: progress.text.startswith("press: increment 12,"))
    assert (tmp_path / "whole" / "history.csv").read_bytes() == (tmp_path / "part" / "history.csv").read_bytes()
    paths = plot_all(Result(tmp_path / "whole"), fields=["eqps"])
    assert {"points.png", "flow_lines_003.png"} < {path.name for path in paths}


@pytest.mark.parametrize(
    ("example", "changes", "point"),
    [
        ("taylor_bar", ["output.rows=4", "output.steps=1", "workpiece.mesh.cells=[4,20]"], [1.0, 10.0]),
        ("flat_bar", [], None),
        ("scordelis_lo_roof", [], None),
        ("square_cup", ["output.rows=2", "output.steps=1"], [20.0, 10.0, 0.0]),
    ],
)
def test_every_family_follows_points(tmp_path, example, changes, point):
    """The point of a first row has moved with its body, and has its strain."""
    path = copy_example(example, tmp_path)
    case = read_case(path, changes)
    place = point or build_model(case).mesh.points.mean(axis=0).tolist()
    if example == "scordelis_lo_roof":
        model = build_model(case)
        place = model.mesh.points[model.mesh.blocks[0].connectivity[0]].mean(axis=0).tolist()
    recording = begin(build_model(read_case(path, [*changes, f"points.mark={place}"])), 1)
    row = recording.row(next(iter(recording.advance())))
    assert set(row) == set(recording.columns)
    moved = [row[f"mark.{axis}"] - x for axis, x in zip("xyz", place, strict=False)]
    assert 0.0 < np.abs(moved).max() < 30.0
    assert row["mark.equivalent_plastic_strain"] >= 0.0


@pytest.mark.parametrize(
    ("points", "said"),
    [
        ({"web": [11.0, 3.0]}, r"points.web.*outside the workpiece.*instance \[10, "),
        ({"punch": [5.0, 3.0]}, "points.punch.*has this name already"),
        ({"a,b": [5.0, 3.0]}, "no name of a file"),
    ],
)
def test_a_point_outside_or_with_a_name_that_is_taken_is_refused(points, said):
    with pytest.raises(CaseError, match=f"(?s){said}"):
        build_model(upsetting(points=points))
