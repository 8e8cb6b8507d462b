# SPDX-License-Identifier: Apache-2.0
"""Laps: where the surface of a body folds onto itself the part has a fault, and every view says so."""

from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from presswork import Case, build_model
from presswork.examples import copy_example
from presswork.mesh.topology import find_boundary_edges
from presswork.model import Mesh
from presswork.process.begin import begin
from presswork.process.implicit.increments import find_position
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.recorder import run_model
from presswork.remesh import section
from presswork.results import Result
from presswork.view.plots.mesh_plot import plot_contours
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, stop_at_fold

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


def test_a_loop_that_a_new_mesh_leaves_out_is_marked_along_its_whole_length(tmp_path, monkeypatch):
    """The new line says that it has left out a loop 2 mm deep: the seam stays with the material."""
    path = copy_example("forging_hub", tmp_path)
    recording = begin(build_model(Case.from_toml(path, ["remesh.size=1.0"])), 1)
    reports = recording.advance()
    next(reports)
    real = section.resample
    (body,) = recording.observers.find(NewMeshes).bodies.find()
    free = ~(body.on_tool.any(axis=0) | body.fixed.any(axis=1))[body.chains[0]]
    mouth = body.position[body.chains[0]][free].mean(axis=0)
    seam = np.linspace(mouth, mouth - [2.0, 0.0], 9)
    monkeypatch.setattr(section, "resample", lambda old, size: replace(real(old, size), seams=(seam,)))
    assert recording.observers.find(NewMeshes).remesh("asked for")
    monkeypatch.undo()

    def tell():
        (lap,) = recording.summary({"time": np.zeros(0), **dict.fromkeys(recording.columns, np.zeros(0))})["laps"]
        return np.array([lap["x_mm"], lap["y_mm"]]), lap["length_mm"]

    assert tell()[0] == pytest.approx(seam.mean(axis=0), abs=0.5)
    assert tell()[1] == pytest.approx(2.0, abs=1e-3)
    before = recording.to_arrays()
    next(reports)
    assert recording.observers.find(NewMeshes).remesh("asked for again")
    assert tell()[1] == pytest.approx(2.0, rel=0.05)
    marked = recording.show().laps > 0.5
    points = find_position(recording.procedure)
    for place in recording.observers.find(NewMeshes).seams.places(points):
        assert np.linalg.norm(points[marked] - place, axis=1).min() < 1.0 / np.sqrt(2)  # half the diagonal of a cell
    recording.load_arrays(before)
    assert tell()[1] == pytest.approx(2.0, abs=1e-3)


STEEL = {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 500}}


def pressed(tools, stroke, is_void, *, remesh=None, **changes):
    """A section cut out of a bar of 24 x 20 mm, between tools; no contact with itself is asked for."""
    *_, moved = tools
    contact = {"contact": "shear", "m": 0.2}
    case = Case(
        title="folded",
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": {"size": [24, 20], "cells": [24, 20]}},
        materials={"steel": STEEL},
        tools={name: {**contact, **tool} for name, tool in tools.items()},
        boundary=changes.pop("boundary", {}),
        stages=[{"name": "press", "tools": {moved: stroke}}],
        remesh=remesh,
        output={"steps": 2, "checkpoint_every": 1},
    )
    model = build_model(case)
    mesh, (block,) = model.mesh, model.mesh.blocks
    x, y = mesh.points[block.connectivity].mean(axis=1).T
    left = block.connectivity[~is_void(x, y)]
    used = np.unique(left)
    new = np.full(len(mesh.points), -1, dtype=np.int32)
    new[used] = np.arange(len(used))
    sets = {name: new[nodes][new[nodes] >= 0] for name, nodes in mesh.node_sets.items()}
    block = replace(block, connectivity=new[left])
    edges = find_boundary_edges([block.connectivity])
    edge_sets = {name: new[own][(new[own] >= 0).all(axis=1)] for name, own in mesh.edge_sets.items()}
    body = replace(model.bodies[0], points=range(len(used)))
    points = mesh.points[used] + np.outer(
        0.02 * np.maximum(mesh.points[used, 1] - 5.0, 0.0), changes.get("lean", (0, 0))
    )
    return replace(model, mesh=Mesh(points, (block,), sets, edge_sets, edges), bodies=(body,))


def press_u_shut(stroke=6.0):
    """A U whose arms are 10 mm wide and 4 mm apart, between two upright plates."""
    tools = {"anvil": {"profile": [[0, 40], [0, -10]]}, "punch": {"profile": [[24, -10], [24, 40]]}}
    way = {"stroke": stroke, "direction": [-1, 0]}
    foot = {"foot": {"set": "bottom", "fix": ["y"]}}
    return pressed(tools, way, lambda x, y: (np.abs(x - 12) < 2) & (y > 6), boundary=foot)


def forge_rib(remesh=None):
    """A web with a slender rib that buckles in the cavity of its die, and folds onto itself and the web."""
    corners = [[-20, 13], {"to": [6, 13], "radius": 1}, {"to": [6, 20], "radius": 1.5}]
    corners += [{"to": [18, 20], "radius": 1.5}, {"to": [18, 13], "radius": 1}, [44, 13]]
    tools = {"anvil": {"profile": [[60, 0], [-30, 0]]}, "die": {"profile": corners, "position": [0, 8]}}
    way = {"stroke": 16, "direction": [0, -1]}
    return pressed(tools, way, lambda x, y: (np.abs(x - 12) > 1.5) & (y > 5), remesh=remesh, lean=(1, 0))


@pytest.mark.validation
def test_a_u_pressed_shut_touches_itself_without_being_told(tmp_path):
    """The arms meet and press on each other: no metal passes through the other arm."""
    result = run_model(press_u_shut(), tmp_path / "run", threads=1).result
    assert result.summary["status"] == "completed"
    assert "is about to fold onto itself near (1" in (tmp_path / "run" / "run.log").read_text()
    assert len(result.summary["laps"]) == 1
    assert any("a fault of the part" in warning for warning in result.summary["warnings"])
    first = result.points(0)
    inner = (first[:, 1] > 12) & (np.abs(np.abs(first[:, 0] - 12) - 2) < 1e-9)
    now = result.points(-1)[inner]
    left, right = (now[first[inner, 0] < 12], now[first[inner, 0] > 12])
    for x, y, *_ in right:
        assert x > np.interp(y, left[:, 1], left[:, 0]) - 0.02
    assert not any("itself" in name for name in result.history)
    assert abs(result.summary["energy"]["error_percent"]) < 1.0


@pytest.mark.validation
def test_a_run_resumed_after_a_fold_gives_the_same_bits(tmp_path):
    model = press_u_shut(3.5)
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"

    parts = run_in_two_parts(model, tmp_path / "halves", stop_at_fold(tmp_path / "halves"))
    assert_same_bits(parts.folder, tmp_path / "whole")


def check_rib(remesh, folder: Path) -> None:
    """Forge the rib to its end: with a lap, marked in the picture."""
    result = run_model(forge_rib(remesh), folder, threads=1).result
    assert result.summary["status"] == "completed"
    assert len(result.summary["laps"]) >= 1
    assert (result.summary["remeshes"] > 0) == (remesh is not None)
    assert result.field("lap").max() == pytest.approx(1.0, abs=0.5)
    assert abs(result.summary["energy"]["error_percent"]) < 1.0
    picture = plot_contours(result, "equivalent_plastic_strain", -1)
    assert "lap (red)" in picture.get_title()
    mpl.pyplot.close("all")


@pytest.mark.validation
def test_a_rib_that_folds_onto_its_web_is_forged_and_marked(tmp_path):
    """On its first mesh; validation/test_laps.py has new ones."""
    check_rib(None, tmp_path / "run")
