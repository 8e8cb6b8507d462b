# SPDX-License-Identifier: Apache-2.0
"""A solid in space from its case file to the picture: history, saved steps, resume, threads."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.view.all_plots import plot_all
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end

TEXT = """
title = "a block is stretched"
analysis = "solid"
[workpiece]
material = "steel"
mesh = {size = [8, 4, 4], cells = [4, 2, 2]}
[materials.steel]
young = 200e3
poisson = 0.3
hardening = {law = "swift", K = 565, e0 = 0.007, n = 0.26}
[boundary.grip]
set = "left"
fix = ["x", "y", "z"]
[[stages]]
name = "pull"
displacement = [{set = "right", component = "x", value = 1}, {set = "right", component = "z", value = 0.5}]
[solver]
initial_increment = 0.05
max_increment = 0.05
[output]
steps = 2
checkpoint_every = 3
"""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("case") / "block.toml"
    path.write_text(TEXT)
    return build_model(read_case(path))


def test_a_run_leaves_history_fields_and_pictures(model, tmp_path) -> None:
    result = run_model(model, tmp_path / "out", threads=1).result
    history = result.history
    assert history["grip.force_x"][-1] == pytest.approx(-history["right.force_x"][-1], rel=1e-3)
    assert abs(result.summary["energy"]["error_percent"]) < 1.5
    assert result.points().shape == (45, 3)
    assert result.field("stress_yz").shape == (16,)
    assert np.abs(result.field("stress_yz")).max() > 1.0
    assert result.field("reaction_force")[:, 0].max() > 0.0
    frame = result.to_dataframe("cell")
    assert {"x", "y", "z", "stress_xz"} <= set(frame.columns)
    pictures = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"solid_equivalent_plastic_strain_002.png", "force_displacement.png"} <= pictures


def test_results_are_hexahedra_that_vtk_reads(model, tmp_path) -> None:
    vtk = pytest.importorskip("vtkmodules.vtkIOHDF")
    run_model(model, tmp_path / "out", threads=1)
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(tmp_path / "out" / "results.vtkhdf"))
    reader.Update()
    grid = reader.GetOutputDataObject(0).GetBlock(0)
    assert grid.GetNumberOfCells() == 16
    assert grid.GetCellType(0) == 12


def test_a_resumed_run_gives_the_same_bits(model, tmp_path) -> None:
    whole = run_to_end(model, tmp_path / "whole").folder
    parts = run_in_two_parts(model, tmp_path / "cut", 5)
    assert_same_bits(parts.folder, whole)


def test_threads_do_not_change_a_bit(model, tmp_path) -> None:
    for threads in (1, 2):
        run_model(model, tmp_path / str(threads), threads=threads)
    assert (tmp_path / "1/history.csv").read_bytes() == (tmp_path / "2/history.csv").read_bytes()


def test_a_face_that_is_let_go_springs_back(tmp_path) -> None:
    """What held it fades over the next stage; the energy is that of its way."""
    path = tmp_path / "block.toml"
    path.write_text(TEXT.replace("[solver]", '[[stages]]\nname = "release"\n[solver]'))
    result = run_model(build_model(read_case(path)), tmp_path / "out", threads=1).result
    assert result.summary["status"] == "completed"
    drawn, free = (
        result.history["right.displacement_x"][result.history["stage"] == s][-1] for s in ("pull", "release")
    )
    assert drawn == pytest.approx(1.0)
    assert 0.01 < drawn - free < 0.05, "about the elastic strain, a quarter of a per cent of 8 mm"
    assert abs(result.history["grip.force_x"][-1]) < 1e-3 * abs(result.history["grip.force_x"]).max()
    assert abs(result.summary["energy"]["error_percent"]) < 1.5
