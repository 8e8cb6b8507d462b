# SPDX-License-Identifier: Apache-2.0
"""Damage from the case file to the picture: history, summary, log, resume, new meshes, faulty input."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.errors import CaseError
from presswork.evolution.points import find_evolved
from presswork.examples import copy_example
from presswork.observe.damage import DamagePeaks
from presswork.process.begin import begin
from presswork.process.implicit.increments import IncrementRun
from presswork.study.calibrate_damage import calibrate_damage
from presswork.view.all_plots import plot_all
from presswork.view.plots.mesh_plot import plot_mesh

CASE = """
title = "a billet is upset"
analysis = "axisymmetric"
[workpiece]
material = "steel"
element = "quad4_fbar"
mesh = {size = [10, 15], cells = [8, 12]}
[materials.steel]
young = 200e3
poisson = 0.3
hardening = {law = "swift", K = 565, e0 = 0.007, n = 0.26}
damage = {DAMAGE}
[tools.punch]
profile = [[0, 15], [30, 15]]
contact = "shear"
m = 0.6
[boundary.axis]
set = "left"
fix = ["x"]
[boundary.middle]
set = "bottom"
fix = ["y"]
[[stages]]
name = "upset"
tools.punch = {stroke = 7.5, direction = [0, -1]}
[solver]
initial_increment = 0.05
max_increment = 0.05
[output]
steps = 2
checkpoint_every = 3
"""


def read(folder, damage, more=""):
    path = folder / "billet.toml"
    path.write_text(CASE.replace("{DAMAGE}", damage) + more)
    return read_case(path)


def test_an_upset_billet_cracks_first_at_its_equator(tmp_path) -> None:
    """Kudo & Aoi 1967 saw cracks of upset cylinders begin at the equator, on the free surface."""
    model = build_model(read(tmp_path, "{critical = 0.1}"))
    result = run_model(model, tmp_path / "out", threads=1).result
    told = result.summary["damage"]["damage_cockcroft_latham"]
    first = told["first_exceeded"]
    x, y = first["at_mm"]
    assert y < 1.0
    assert x > 12.0
    assert 0.0 < first["strokes_mm"]["punch"] < 7.5
    assert first["value"] > 0.1
    assert told["largest"]["value"] == pytest.approx(result.history["damage_cockcroft_latham_max"][-1])
    assert "a crack begins there" in result.summary["warnings"][0]
    assert "warning: stage 'upset', punch at" in (tmp_path / "out" / "run.log").read_text()
    assert result.field("damage_cockcroft_latham").max() <= told["largest"]["value"]


def test_a_resumed_run_gives_the_same_bits(tmp_path) -> None:
    model = build_model(read(tmp_path, "{critical = 0.1}"))
    run_model(model, tmp_path / "whole", threads=1)
    calls = 0

    def stop_at_fifteen(progress) -> None:
        nonlocal calls
        calls += 1
        if calls == 15:
            raise KeyboardInterrupt

    run_model(model, tmp_path / "cut", threads=1, on_increment=stop_at_fifteen)
    cut = run_model(model, tmp_path / "cut", threads=1, resume=True).result
    assert (tmp_path / "cut/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()
    assert "first_exceeded" in cut.summary["damage"]["damage_cockcroft_latham"]


@pytest.mark.parametrize(
    ("damage", "key"),
    [
        ("{critical = -0.2}", "critical"),
        ('{criterion = "cockcroft_latham", A = 0.3}', "A"),
        ('{criterion = "oyane"}', "A"),
        ('{criterion = "mcclintock"}', "damage"),
        ('{criterion = "johnson_cook", d1 = 0.05, d2 = 3.4, d3 = -2.1, d5 = 0.6}', "melting"),
        ('{criterion = "johnson_cook", d1 = 0.05, d2 = 3.4, d3 = -2.1, d4 = 0.002}', "reference_rate"),
        ('{criterion = "johnson_cook", d1 = -4, d2 = 3.4, d3 = -2.1}', "d1"),
    ],
)
def test_faulty_criteria_are_refused(tmp_path, damage: str, key: str) -> None:
    with pytest.raises(CaseError) as error:
        build_model(read(tmp_path, damage))
    assert any(key in problem.key for problem in error.value.problems)


def test_damage_passes_to_new_meshes(tmp_path) -> None:
    """A run with eight new meshes has the damage to which runs without converge, within 2 %.

    Without new meshes the largest damage is 0.1742, 0.1783, 0.1788, 0.1791 and 0.1795 at 8 x 12, 16 x 24, 24 x 36,
    32 x 48 and 48 x 72 cells. With new meshes at every 0.17, 0.2, 0.23, 0.26 and 0.3 of the stroke it is 0.1821,
    0.1821, 0.1820, 0.1828 and 0.1827.
    """
    case = read_case(read(tmp_path, "{critical = 10}", "[remesh]\nevery = 0.2\n").source)
    result = run_model(build_model(case), tmp_path / "out", threads=1).result
    assert result.summary["remeshes"] >= 4
    assert result.history["damage_cockcroft_latham_max"][-1] == pytest.approx(0.1795, rel=0.02)


def test_new_meshes_keep_the_peak_and_the_mean(tmp_path, monkeypatch) -> None:
    """The example of a hub, whose damage differs much between the points of a cell, to its third new mesh."""
    changes = []

    def measure(procedure) -> tuple[float, float]:
        volume, damage = procedure.state.cells.volume[0], find_evolved(procedure.state)["damage_cockcroft_latham"][0]
        return float(damage.max()), float((damage * volume).sum() / volume.sum())

    def look(self, procedure, origin, position) -> None:
        changes.append(np.divide(measure(procedure), measure(self.procedure)))
        begin_on(self, procedure, origin, position)

    begin_on = IncrementRun.begin_on
    monkeypatch.setattr(IncrementRun, "begin_on", look)
    recording = begin(build_model(read_case(copy_example("forging_hub", tmp_path))), 1)
    peaks = []
    for _ in recording.advance():
        peaks.append(recording.observers.find(DamagePeaks).find(recording)[0].value)
        if len(changes) == 3:
            break
    assert len(changes) == 3
    np.testing.assert_allclose(changes, 1.0, atol=0.02)
    assert (np.diff(peaks) > -0.02 * np.array(peaks[:-1])).all(), "what was passed once is not taken back"


@pytest.mark.validation
def test_the_critical_value_of_a_test_is_found_again(tmp_path) -> None:
    """A run with the value found tells its first crack at the stroke that it was found from."""
    case = read(tmp_path, "{critical = 10}", "").source
    found = calibrate_damage(case, 5.0, settings=["output.steps=20"])
    assert 0.05 < found.value < 1.0
    assert calibrate_damage(found.folder, 5.0).value == found.value
    at_place = calibrate_damage(found.folder, 5.0, at=found.place)
    assert at_place.value == pytest.approx(found.value, rel=0.1), "the mean of a cell, not of its neighbourhood"
    model = build_model(read(tmp_path, f"{{critical = {found.value}}}"))
    told = run_model(model, tmp_path / "again", threads=1).result.summary["damage"]["damage_cockcroft_latham"]
    assert told["first_exceeded"]["strokes_mm"]["punch"] == pytest.approx(5.0, abs=0.05 * 7.5 + 1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"stroke": 50.0}, "has gone 7.5 mm"),
        ({"stroke": 5.0, "tool": "punsh"}, "no such tool"),
        ({"stroke": 5.0, "criterion": "oyane"}, "no such damage"),
    ],
)
def test_a_test_that_cannot_tell_is_refused(tmp_path_factory, tmp_path, options, words) -> None:
    run_model(build_model(read(tmp_path, "{critical = 10}")), tmp_path / "out", threads=1)
    with pytest.raises(CaseError, match=words):
        calibrate_damage(tmp_path / "out", **options)


def test_the_first_crack_is_marked_on_the_picture(tmp_path) -> None:
    result = run_model(build_model(read(tmp_path, "{critical = 0.1}")), tmp_path / "out", threads=1).result
    pictures = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert "mesh_damage_cockcroft_latham_002.png" in pictures
    ax = plot_mesh(result, "damage_cockcroft_latham")
    assert "first crack (x) at punch" in ax.get_title()
    crack = result.summary["damage"]["damage_cockcroft_latham"]["first_exceeded"]
    marks = [c.get_offsets()[0] for c in ax.collections if len(c.get_offsets()) == 1 and c.get_zorder() == 7]
    centre = result.points()[result.mesh.blocks[0].connectivity[crack["cell"]]].mean(axis=0)
    np.testing.assert_allclose(np.asarray(marks[0]), centre)
    assert "first crack" not in plot_mesh(result, "damage_cockcroft_latham", 0).get_title()
