# SPDX-License-Identifier: Apache-2.0
"""Explicit solids on meshes that change: the implicit run's force and shape, momentum, energy, the same bits."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.explicit.arrays import SolidArrays
from presswork.explicit.input_checks import ExplicitError
from presswork.law.history import EQPS
from presswork.process.begin import begin
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.new_meshes import IntervalMeshes
from presswork.recorder import run_model
from presswork.results import Result, read_history
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts


def upsetting(procedure="explicit", remesh=None, **changes):
    """The quarter section of a billet of 10 by 15 mm under a flat platen, 700 + 300 e MPa, mu = 0.1."""
    is_explicit = procedure == "explicit"
    element = "quad4_1pt" if is_explicit else "quad4_fbar"
    steel = {"young": 2e5, "poisson": 0.3, "density": "7850 kg/m^3"}
    return Case(
        **{
            "title": "upsetting",
            "analysis": "axisymmetric",
            "procedure": procedure,
            "workpiece": {"material": "steel", "element": element, "mesh": {"size": [10, 15], "cells": [12, 18]}},
            "materials": {"steel": steel | {"hardening": {"law": "linear", "yield_stress": 700, "modulus": 300}}},
            "tools": {"punch": {"profile": [[0, 15], [60, 15]], "contact": "coulomb", "mu": 0.1}},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
            "stages": [{"name": "press", "duration": 2e-3, "tools": {"punch": {"stroke": 9.0, "direction": [0, -1]}}}],
            "output": {"steps": 4} | ({"rows": 100} if is_explicit else {}),
            "solver": {} if is_explicit else {"max_increment": 0.02},
            "points": {"mark": [5.0, 6.0]},
            "remesh": remesh,
        }
        | changes
    )


@pytest.fixture(scope="module")
def remeshed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("impact") / "run"
    assert run_model(build_model(upsetting(remesh={})), folder, threads=1).status == "completed"
    return folder


def test_force_and_paths_are_those_of_the_implicit_run(remeshed):
    """To 60 % of the height; the side folds onto the platen."""
    recording = begin(build_model(upsetting("implicit", {})), 1)
    rows = [recording.row(report) for report in recording.advance()]
    implicit = {name: np.array([row[name] for row in rows]) for name in ("punch.stroke", "punch.force", "mark.x")}
    history = read_history(remeshed / "history.csv")
    assert history["remeshes"][-1] >= 2
    for stroke in (2.0, 4.0, 6.0, 8.0):
        for name, tolerance in (("punch.force", 0.03), ("mark.x", 0.01)):
            found, expected = (np.interp(stroke, of["punch.stroke"], of[name]) for of in (history, implicit))
            assert found == pytest.approx(expected, rel=tolerance), (stroke, name)


def test_mass_volume_and_energy_are_kept(remeshed):
    result = Result(remeshed)
    history = result.history
    assert abs(history["energy_error_percent"]).max() < 0.5
    assert history["hourglass_energy"][-1] < 0.05 * history["internal_energy"][-1]
    assert history["kinetic_energy"][-1] < 0.01 * history["internal_energy"][-1]
    assert result.summary["mass"]["workpiece_t"] == pytest.approx(7.85e-9 * np.pi * 100 * 15, rel=1e-9)
    meshes = [len(result.mesh_at(step).blocks[0].connectivity) for step in range(len(result.times))]
    assert len(set(meshes)) > 1
    start = result.mesh_at(-1).points
    assert start[:, 0].max() == pytest.approx(10.0, abs=1e-9)
    assert start[:, 1].max() == pytest.approx(15.0, abs=1e-9)


def test_a_new_mesh_keeps_a_rigid_motion():
    case = upsetting(remesh={}, boundary={"axis": {"set": "left", "fix": ["x"]}}, points={})
    case = case.model_copy(update={"workpiece": case.workpiece.model_copy(update={"velocity": (0.0, -30e3)})})
    recording = begin(build_model(case), 1)
    assert isinstance(recording, ExplicitForming)
    before = recording.solids
    assert recording.observers.find(IntervalMeshes).remesh("asked for")
    assert recording.solids is not before
    np.testing.assert_allclose(recording.solids.velocity[:, 1], -30e3, rtol=1e-12)


def test_a_new_mesh_keeps_momentum_and_work():
    """Half way down; the platen's work and that of the stresses go along."""
    recording = begin(build_model(upsetting(remesh={})), 1)
    reports = recording.advance()
    for _ in range(50):
        next(reports)
    solids = recording.solids
    momentum, energies, time = solids.mass @ solids.velocity, solids.energies(), solids.time
    assert np.ptp(solids.velocity[:, 1]) > 1e3
    assert recording.observers.find(IntervalMeshes).remesh("asked for")
    solids = recording.solids
    assert (solids.mass @ solids.velocity)[1] == pytest.approx(momentum[1], rel=1e-12)
    after = solids.energies()
    assert solids.time == time
    assert after.internal == pytest.approx(energies.internal, rel=1e-9)
    assert after.hourglass == pytest.approx(energies.hourglass, rel=1e-9)
    assert after.kinetic == pytest.approx(energies.kinetic, rel=0.02)
    assert after.external == pytest.approx(energies.external, rel=1e-3)


def test_a_new_mesh_keeps_the_peaks_of_plastic_strain_and_damage():
    """Values of a single cell: the largest stays to the bit, the mean over the volume within 2 %."""
    recording = begin(build_model(upsetting(remesh={})), 1)
    reports = recording.advance()
    for _ in range(50):
        next(reports)
    state = recording.solids.state()

    def list_fields(state):
        solids = state[SolidArrays]
        return [solids.find_kept(0, EQPS)[:, 0], solids.damage["damage_cockcroft_latham"][0][:, 0]]

    def find_means():
        volume = recording.observers.find(IntervalMeshes).bodies.find_volumes()[0]
        return [(values * volume).sum() / volume.sum() for values in list_fields(recording.solids.state())]

    for values in list_fields(state):
        values[100] = 1.3 * values.max()
    recording.solids.take_state(state)
    means = find_means()
    assert recording.observers.find(IntervalMeshes).remesh("asked for")
    for before, after in zip(list_fields(state), list_fields(recording.solids.state()), strict=True):
        assert after.max() == before.max() > 0.0
    assert find_means() == pytest.approx(means, rel=0.02)


def test_resumed_between_meshes_gives_the_same_bits(remeshed, tmp_path):
    model = build_model(upsetting(remesh={}))
    half = int(np.flatnonzero(np.diff(read_history(remeshed / "history.csv")["remeshes"]))[1]) + 3

    def stop(progress):
        if (tmp_path / "run" / "history.csv").read_text().count("\n") == half + 1:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "run", threads=1, on_increment=stop).status == "interrupted"
    assert read_history(tmp_path / "run" / "history.csv")["remeshes"][-1] > 0
    assert run_model(model, tmp_path / "run", threads=1, resume=True).status == "completed"
    assert (tmp_path / "run" / "history.csv").read_bytes() == (remeshed / "history.csv").read_bytes()


def test_a_row_that_fails_is_computed_again_on_a_new_mesh(monkeypatch):
    """A cell turns inside out after the row's cycles: its beginning gets a new mesh, and the run goes on."""
    real, calls = ExplicitForming._compute_cycles, []

    def fail_once(recording, number, row, part=(0, 1)):
        found = real(recording, number, row, part)
        calls.append(recording.solids.time)
        if len(calls) == 30:
            raise ExplicitError("cell 7 is turned inside out in cycle 99: shorten the step")
        return found

    monkeypatch.setattr(ExplicitForming, "_compute_cycles", fail_once)
    recording = begin(build_model(upsetting(remesh={})), 1)
    notes = [line for report in recording.advance() for line in recording.log_lines(report) if "remesh" in line]
    assert sum("(cell 7 is turned inside out in cycle 99)" in line for line in notes) == 1
    assert calls[30] == pytest.approx(calls[29], rel=1e-9)
    assert recording.remaining() == 0.0
    assert abs(recording.solids.energies().error_percent) < 0.5


def test_a_row_that_fails_on_one_mesh_is_computed_on_several(monkeypatch, remeshed):
    """Row 30 fails unless it is divided by four: time, force and shape of what follows are those of the whole run."""
    real = ExplicitForming._compute_cycles

    def fail_long(recording, number, row, part=(0, 1)):
        found = real(recording, number, row, part)
        if row == 29 and part[1] < 4:
            raise ExplicitError("cell 7 is turned inside out in cycle 99: shorten the step")
        return found

    monkeypatch.setattr(ExplicitForming, "_compute_cycles", fail_long)
    recording = begin(build_model(upsetting(remesh={})), 1)
    rows, notes = [], []
    for report in recording.advance():
        notes += recording.log_lines(report)
        rows.append(recording.row(report))
    assert any("row 30 took 4 meshes" in line for line in notes)
    history = read_history(remeshed / "history.csv")
    assert [row["time"] for row in rows] == pytest.approx(history["time"], rel=1e-12)
    for row in (28, 29, 30, 60):
        assert rows[row]["punch.force"] == pytest.approx(history["punch.force"][row], rel=0.03)
    assert rows[-1]["x_max"] == pytest.approx(history["x_max"][-1], rel=0.003)


def test_triangles_become_quadrilaterals_with_the_same_force():
    """The first mesh is of triangles, which is stiffer; after its new mesh the force is that of quadrilaterals."""
    forces = {}
    for element in ("tri3", "quad4_1pt"):
        mesh = {"size": [10, 15], "cells": [8, 12]}
        billet = {"material": "steel", "element": element, "mesh": mesh}
        keys = {"every": 0.25, "size": 1.25}
        recording = begin(build_model(upsetting(remesh=keys, workpiece=billet, output={"steps": 2, "rows": 40})), 1)
        rows = [recording.row(report) for report in recording.advance()]
        assert recording.model.mesh.blocks[0].element == "quad4_1pt"
        assert rows[-1]["remeshes"] >= 3
        assert abs(recording.solids.energies().error_percent) < 1.0
        forces[element] = np.array([row["punch.force"] for row in rows])
    late = slice(20, None)
    assert forces["tri3"][late].mean() == pytest.approx(forces["quad4_1pt"][late].mean(), rel=0.02)


@pytest.mark.validation
def test_the_error_asked_for_changes_the_cells():
    cells = {}
    for error in (0.0, 0.05):
        keys = {"every": 0.5, "size": 1.5, "smallest_size": 0.4, "error": error}
        recording = begin(build_model(upsetting(remesh=keys, output={"steps": 2, "rows": 40})), 1)
        cells[error] = [recording.row(report)["cells"] for report in recording.advance()][-1]
    assert cells[0.05] > 1.3 * cells[0.0]


def hot(remesh):
    steel = {
        "young": 2e5, "poisson": 0.3, "density": "7850 kg/m^3",
        "hardening": {"law": "linear", "yield_stress": 100, "modulus": 100},
        "thermal": {"conductivity": "30 W/(m K)", "specific_heat": "650 J/(kg K)"},
    }  # fmt: skip
    tool = {"profile": [[0, 15], [60, 15]], "contact": "coulomb", "mu": 0.1}
    tool["heat"] = {"temperature": 200, "conductance": "10 kW/(m^2 K)"}
    return upsetting(
        remesh=remesh, materials={"steel": steel}, tools={"punch": tool}, heat={"initial_temperature": 1000},
        stages=[{"name": "press", "duration": 5e-3, "tools": {"punch": {"stroke": 7.0, "direction": [0, -1]}}}],
        output={"steps": 2, "rows": 50, "checkpoint_every": 1},
    )  # fmt: skip


@pytest.mark.validation
def test_hot_runs_keep_their_heat_on_new_meshes(tmp_path):
    """Heat stored is heat come in, and temperatures are those of the run on its first mesh."""
    once, often = (begin(build_model(hot(keys)), 1) for keys in ({"enabled": False}, {"every": 0.2, "size": 1.2}))
    rows = [[run.row(report) for report in run.advance()] for run in (once, often)]
    assert rows[1][-1]["remeshes"] >= 3
    summary = often.summary({name: np.array([row[name] for row in rows[1]]) for name in rows[1][0]})
    assert summary["heat"]["balance_error"] < 1e-8
    for name, tolerance in (("temperature_mean", 1.0), ("temperature_min", 25.0)):
        assert rows[1][-1][name] == pytest.approx(rows[0][-1][name], abs=tolerance)
    assert rows[1][-1]["heat_stored"] == pytest.approx(rows[0][-1]["heat_stored"], rel=0.05)


@pytest.mark.validation
def test_a_hot_run_resumed_between_meshes_gives_the_same_bits(tmp_path):
    model = build_model(hot({"every": 0.3, "size": 1.2}))
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"

    history = tmp_path / "halves/history.csv"
    parts = run_in_two_parts(model, tmp_path / "halves", lambda _: history.read_text().count("\n") == 24)
    assert_same_bits(parts.folder, tmp_path / "whole")


def test_without_keys_the_first_mesh_stays_until_a_row_fails(monkeypatch):
    real, calls = ExplicitForming._compute_cycles, []

    def fail_once(recording, number, row, part=(0, 1)):
        found = real(recording, number, row, part)
        calls.append(row)
        if len(calls) == 30:
            raise ExplicitError("cell 7 is turned inside out in cycle 99: shorten the step")
        return found

    recording = begin(build_model(upsetting()), 1)
    rows = [recording.row(report) for report, _ in zip(recording.advance(), range(40), strict=False)]
    assert rows[-1]["remeshes"] == 0
    monkeypatch.setattr(ExplicitForming, "_compute_cycles", fail_once)
    recording = begin(build_model(upsetting()), 1)
    remeshes = [recording.row(report)["remeshes"] for report, _ in zip(recording.advance(), range(32), strict=False)]
    assert remeshes[28] == 0
    assert remeshes[-1] == 1
