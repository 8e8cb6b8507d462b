# SPDX-License-Identifier: Apache-2.0
"""One run on several ranks of MPI: what refuses it, and, where petsc4py is installed, whole runs."""

import importlib.util
import json
import os
import subprocess
import sys
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import typer

from presswork import build_model, read_case
from presswork.cli.run import run
from presswork.outcome import StartError
from presswork.process.on_ranks import begin_on_ranks
from presswork.ranks.world import RanksError, start_petsc
from presswork.results import load_checkpoint, read_history
from tests.problems.divided_loops import read
from tests.problems.divided_shells import describe_implicit_cup, list_runs
from tests.problems.ranks import explain_no_mpi, run_module_on_ranks, run_on_ranks
from tests.problems.upset_block import describe_block

MPI_MISSING = "petsc4py is not installed" if importlib.util.find_spec("petsc4py") is None else explain_no_mpi()
needs_mpi = pytest.mark.skipif(bool(MPI_MISSING), reason=f"{MPI_MISSING} (apt install python3-petsc4py openmpi-bin)")
HEX = 'element = "hex8_fbar"\nmesh = {size = [4, 4, 3], cells = [3, 3, 2]}'
TET = 'element = "tet4_mini"\nmesh = {size = [4, 4, 3], cells = [2, 2, 2]}'
SOLVER = """
[solver]
initial_increment = 0.5
max_increment = 0.5
linear_solver = "{kind}"
[output]
steps = 1
checkpoint_every = 1
[remesh]
enabled = false
"""


def _write(folder, workpiece=HEX, kind="direct"):
    case = folder / "block.toml"
    stage = "tools.die = {stroke = 0.2, direction = [0, 0, -1]}"
    case.write_text(describe_block(workpiece, 3, 0.3, stage, tail=SOLVER.format(kind=kind)))
    return case


def _model(folder, **changes):
    return build_model(read_case(_write(folder)))


def test_more_ranks_than_cells_are_refused(tmp_path):
    with pytest.raises(StartError, match=r"19 ranks, but the mesh has only 18 cells: start at most that many"):
        begin_on_ranks(_model(tmp_path), 1, SimpleNamespace(rank=0, size=19))


def test_what_is_not_divided_is_refused(tmp_path):
    line = replace(_model(tmp_path), solver=replace(_model(tmp_path).solver, control="arc_length"))
    with pytest.raises(StartError, match="asks for arc length: ranks of MPI share the forming of solids and of sheets"):
        begin_on_ranks(line, 1, SimpleNamespace(rank=0, size=2))
    cup = read(describe_implicit_cup())
    steel = replace(cup.materials[0], umat=SimpleNamespace())
    with pytest.raises(StartError, match="asks for a UMAT: "):
        begin_on_ranks(replace(cup, materials=(steel,)), 1, SimpleNamespace(rank=0, size=2))


def test_a_missing_petsc4py_names_the_way_out(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "petsc4py", None)
    with pytest.raises(RanksError, match=r"an implicit run on 4 ranks needs petsc4py .*python3-petsc4py"):
        start_petsc(SimpleNamespace(rank=0, size=4))
    with pytest.raises(StartError, match="needs petsc4py"):
        begin_on_ranks(_model(tmp_path), 1, SimpleNamespace(rank=0, size=4))


def test_a_missing_mpi4py_names_the_way_out(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "4")
    monkeypatch.setitem(sys.modules, "mpi4py", None)
    with pytest.raises(typer.Exit) as ended:
        run(_write(tmp_path))
    said = " ".join(capsys.readouterr().err.split())
    assert ended.value.exit_code == 2
    assert "a run on 4 ranks needs mpi4py and an MPI" in said
    assert 'pip install "presswork[mpi]"' in said
    assert not (tmp_path / "block").exists()


def test_an_mpiexec_of_another_mpi_is_named(tmp_path):
    """As the mpiexec of MPICH starts a process, whose mpi4py takes another MPI and so is alone."""
    if reason := explain_no_mpi():
        pytest.skip(reason)
    program = [sys.executable, "-c", "from presswork.cli import main; main()", "run", str(_write(tmp_path))]
    done = subprocess.run(program, env={**os.environ, "PMI_SIZE": "4"}, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "mpiexec has started 4 processes, of which each sees 1: mpi4py was made for another MPI" in " ".join(
        done.stderr.split()
    )


@needs_mpi
@pytest.mark.parametrize("kind", ["direct", "multigrid"])
@pytest.mark.parametrize("workpiece", [HEX, TET], ids=["hex8", "tet4"])
def test_two_ranks_find_the_answer_of_one_process(tmp_path, workpiece, kind):
    """One process takes factors: its own multigrid ends at a residual of 1e-4."""
    run_on_ranks(1, _write(tmp_path, workpiece), tmp_path / "one")
    run_on_ranks(2, _write(tmp_path, workpiece, kind), tmp_path / "two")
    one, two = (read_history(tmp_path / name / "history.csv") for name in ("one", "two"))
    assert one["iterations"].tolist() == two["iterations"].tolist()
    np.testing.assert_allclose(two["die.force"], one["die.force"], rtol=1e-8)
    _compare(tmp_path / "one", tmp_path / "two")
    log = (tmp_path / "two" / "run.log").read_text()
    assert "2 ranks: " in log
    assert "PETSc's reason" not in log, "iterations have converged"


@needs_mpi
@pytest.mark.parametrize(
    "remesh",
    [{"enabled": "false"}, {"size": "3", "bodies.ring.size": "3", "every": "0.5"}],
    ids=["one_mesh", "new_meshes"],
)
def test_two_ranks_share_hot_bodies_that_touch_in_the_plane(tmp_path, remesh):
    """A core in a ring of other heat, of which each rank has one: `bimetal_upsetting` on coarse meshes."""
    case = files("presswork") / "examples" / "bimetal_upsetting.toml"
    settings = {f"remesh.{key}": value for key, value in remesh.items()} | {
        "workpiece.mesh.cells": "[3,4]", "bodies.ring.mesh.cells": "[3,5]",
        "stages.0.tools.die.stroke": "0.3", "output.steps": "1",
        "solver.initial_increment": "0.5", "solver.max_increment": "0.5",
    }  # fmt: skip
    options = [text for key, value in settings.items() for text in ("--set", f"{key}={value}")]
    for ranks, name in ((1, "one"), (2, "two")):
        run_on_ranks(ranks, Path(str(case)), tmp_path / name, *options)
    others = "heat.temperature", "cells.stress.1", "body_contact.pressure"
    _compare(tmp_path / "one", tmp_path / "two", *others, in_any_order="every" in remesh)
    meshes = read_history(tmp_path / "two" / "history.csv").get("remeshes", np.zeros(1))
    assert (meshes[-1] > 0) == ("every" in remesh)


@needs_mpi
def test_a_block_in_space_gets_the_meshes_of_one_process_on_two_ranks_and_when_three_go_on(tmp_path):
    """New meshes enlarge rounding: one process that takes SuperLU for PARDISO finds another stress by 1.5e-4."""
    case = _write(tmp_path, TET)
    case.write_text(case.read_text().replace("enabled = false", "every = 0.2").replace("stroke = 0.2", "stroke = 0.4"))
    often = ("--set", "solver.max_increment=0.1", "--set", "solver.initial_increment=0.1")
    run_on_ranks(1, case, tmp_path / "one", *often)
    run_on_ranks(2, case, tmp_path / "two", *often, "--set", "limits.hydrostatic_stress=0.55", status=3)
    one, two = (read_history(tmp_path / name / "history.csv") for name in ("one", "two"))
    assert 0 < two["remeshes"][-1] < one["remeshes"][-1]
    run_on_ranks(3, case, tmp_path / "two", "--resume", *often)
    two = read_history(tmp_path / "two" / "history.csv")
    assert two["cells"].tolist() == one["cells"].tolist()
    np.testing.assert_allclose(two["die.force"], one["die.force"], rtol=1e-6)
    _compare(tmp_path / "one", tmp_path / "two", atol=1e-4)


@needs_mpi
@pytest.mark.parametrize(("ranks", "kind"), [(2, "direct"), (4, "multigrid")])
def test_a_repeated_run_on_ranks_gives_the_same_bits(tmp_path, ranks, kind):
    """Coarse matrices of four ranks are summed up in one order."""
    case = _write(tmp_path, HEX.replace("[3, 3, 2]", "[5, 5, 4]") if kind == "multigrid" else HEX, kind)
    for name in ("first", "second"):
        run_on_ranks(ranks, case, tmp_path / name)
    first, second = (load_checkpoint(tmp_path / name / "checkpoint.h5")[0] for name in ("first", "second"))
    assert set(first) == set(second)
    assert all(first[name].tobytes() == second[name].tobytes() for name in first)


@needs_mpi
def test_a_run_on_two_ranks_is_resumed_by_one_process(tmp_path):
    case = _write(tmp_path)
    run_on_ranks(1, case, tmp_path / "whole")
    run_on_ranks(2, case, tmp_path / "parts", "--set", "limits.hydrostatic_stress=0.01", status=3)
    assert 0 < len(read_history(tmp_path / "parts" / "history.csv")["time"]) < 2
    run_on_ranks(1, case, tmp_path / "parts", "--resume")
    _compare(tmp_path / "whole", tmp_path / "parts")


def _compare(first, second, *others, atol=1e-8, in_any_order=False):
    """in_any_order: cells of a new mesh, whose numbers may hang on the last bits of its nodes."""
    whole, _ = load_checkpoint(first / "checkpoint.h5")
    parts, _ = load_checkpoint(second / "checkpoint.h5")
    for name in ("nodes.displacement", "nodes.reaction", "cells.stress.0", "cells.eqps.0", *others):
        scale = np.abs(whole[name]).max()
        if in_any_order and name.startswith("cells."):
            whole[name], parts[name] = (np.sort(values, axis=None) for values in (whole[name], parts[name]))
        np.testing.assert_allclose(parts[name], whole[name], atol=atol * scale, rtol=0, err_msg=name)


@needs_mpi
@pytest.mark.parametrize(("ranks", "name"), [(3 if n in ("beads", "plates") else 2, n) for n in list_runs()])
def test_ranks_share_shells(ranks, name):
    """Drawing, springback, two operations, heat, triangles with damage, a formed part, self-contact, a roof."""
    beside_one, repeated = json.loads(run_module_on_ranks(ranks, "tests.problems.divided_shells", name))[name]
    assert not any(repeated.values()), "a repeated run has the same bits"
    beside_one.pop(next(name for name in beside_one if name.endswith("progress.iterations")))
    for array, apart in beside_one.items():
        is_state = array.endswith(("displacement", ".0", ".director"))
        assert apart < (1e-8 if is_state else 1e-7), array


@needs_mpi
def test_a_cup_drawn_by_increments_on_two_ranks_is_resumed_by_three(tmp_path):
    case = tmp_path / "cup.toml"
    case.write_text(describe_implicit_cup() + "checkpoint_every = 4\n")
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.thinning=0.0001", status=3)
    one, two = (read_history(tmp_path / name / "history.csv") for name in ("one", "two"))
    assert 0 < len(two["time"]) < len(one["time"])
    run_on_ranks(3, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two", "shells.thickness.0", "cells.history.0", "space_tools.travel")
    one, two = (read_history(tmp_path / name / "history.csv") for name in ("one", "two"))
    np.testing.assert_allclose(two["punch.force"], one["punch.force"], rtol=1e-6)
    assert "3 ranks: " in (tmp_path / "two" / "run.log").read_text()
