# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra whose mesh changes in the run."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.errors import CaseError
from presswork.case.space.schema import SpaceCase
from presswork.examples import copy_example
from presswork.mesh.checks import MeshError
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.report.write import write_report
from presswork.view.all_plots import plot_all
from tests.problems.upset_block import describe_block
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

TEXT = describe_block(
    'element = "tet4_mini"\nmesh = {kind = "box", size = [4, 4, 5], cells = [3, 3, 4]}',
    5,
    0.2,
    "duration = 1.0\ntools.die = {stroke = 1.0, direction = [0, 0, -1]}",
    tail="[points]\ncore = [0.1, 0.1, 2.5]\n[solver]\nmax_increment = 0.05\n"
    "[output]\nsteps = 2\ncheckpoint_every = 3\n",
)
FORCED = TEXT + "[remesh]\nevery = 0.25\n"


def make(folder, text):
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    return build_model(read_case(folder / "case.toml"))


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return make(tmp_path_factory.mktemp("case"), FORCED)


@pytest.fixture(scope="module")
def result(model, tmp_path_factory):
    return run_model(model, tmp_path_factory.mktemp("out"), threads=1).result


@pytest.fixture(scope="module")
def untouched(tmp_path_factory):
    made = make(tmp_path_factory.mktemp("case"), TEXT)
    return run_model(made, tmp_path_factory.mktemp("out"), threads=1).result


def test_history_counts_meshes_and_the_log_gives_their_reasons(result, untouched):
    assert result.history["remeshes"][-1] >= 3
    assert untouched.history["remeshes"][-1] == 0
    log = (result.folder / "run.log").read_text()
    assert log.count("remesh ") == result.summary["remeshes"]
    assert "remesh 1 (due):" in log


def test_forces_and_volume_are_those_of_a_run_on_one_mesh(result, untouched):
    force, other = (
        np.interp(np.linspace(0.2, 1.0, 9), r.history["time"], r.history["die.force"]) for r in (result, untouched)
    )
    np.testing.assert_allclose(force, other, rtol=0.015)
    volumes = [r.summary["volume"]["change_percent"] for r in (result, untouched)]
    assert volumes[0] == pytest.approx(volumes[1], abs=0.02)
    assert abs(result.summary["energy"]["error_percent"]) < abs(untouched.summary["energy"]["error_percent"]) + 1.0


def test_displacements_count_from_the_start_and_marked_points_go_with_the_metal(result, untouched):
    moved = result.field("displacement")[:, 2]
    assert moved.min() == pytest.approx(-1.0, abs=0.01)
    assert len(moved) != len(untouched.field("displacement"))
    for column in ("core.equivalent_plastic_strain", "core.z"):
        assert result.history[column][-1] == pytest.approx(untouched.history[column][-1], rel=0.03)


def test_pictures_and_page_show_each_step_on_its_mesh(result, tmp_path):
    pictures = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"solid_equivalent_plastic_strain_002.png", "force_stroke.png"} <= pictures
    page = write_report([result], tmp_path / "report.html")
    assert page.stat().st_size > 100_000


def test_a_resumed_run_and_two_threads_give_the_same_bits(model, result, tmp_path):
    parts = run_in_two_parts(model, tmp_path / "cut", 10, threads=(2, 1))
    assert_same_bits(parts.folder, result.folder)


def test_a_mesh_that_cannot_be_made_is_not_tried_finer_unless_the_run_would_end(model, monkeypatch):
    """Each try is three meshes, of which the last has cells of two thirds of the size."""
    run, tried = begin_forming(model, threads=1), []
    meshes = run.observers.find(NewMeshes)

    def refuse(old, own, part, *, may_yield):
        tried.append(part)
        raise MeshError("flat", "smaller cells")

    monkeypatch.setattr(meshes, "_try_mesh", refuse)
    assert not meshes.remesh("a cell")
    assert tried == [1.0]
    assert not meshes.remesh("the next increment fails", must=True)
    assert tried == [1.0, *meshes.bodies.parts]


def test_metal_that_rises_into_a_die_gets_meshes_that_follow_its_radius(tmp_path):
    """The first third of the example, in which the edges of the first mesh come to span the die's radius of 3 mm."""
    copy_example("deep_spike_forging", tmp_path)
    case = SpaceCase.from_toml(tmp_path / "deep_spike_forging.toml", ["stages.0.tools.die.stroke=2", "output.steps=1"])
    result = run_model(build_model(case), tmp_path / "out", threads=1).result
    assert result.history["remeshes"][-1] >= 1
    assert result.history["die.force"][-1] == pytest.approx(299e3, rel=0.03)
    assert result.summary["volume"]["change_percent"] == pytest.approx(
        result.summary["volume"]["elastic_part_percent"], abs=1e-3
    )
    log = (result.folder / "run.log").read_text()
    assert "times too long near (" in log


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ("[remesh]\nsize = 9.0", "remesh.size.*exceeds the least extent of the body"),
        ("[remesh]\nsize = 1.0\nsmallest_size = 2.0", "remesh.smallest_size.*exceeds the largest edge"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(tmp_path, keys, told):
    with pytest.raises(CaseError, match=told):
        make(tmp_path, TEXT + keys)


def test_hexahedra_keep_their_mesh(tmp_path):
    with pytest.raises(CaseError, match="cells of hex8_fbar keep their mesh: new ones are made of tetrahedra"):
        make(tmp_path, FORCED.replace("tet4_mini", "hex8_fbar"))
