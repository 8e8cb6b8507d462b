# SPDX-License-Identifier: Apache-2.0
"""Explicit runs on several ranks of MPI: the bits of one process, resume on another number, and what is refused."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.outcome import StartError
from presswork.process.on_ranks import begin_on_ranks
from presswork.results import load_checkpoint, read_history
from tests.problems.divided_loops import (
    HEX,
    MOVED,
    PUSHED,
    SHARES,
    describe_explicit_block,
    describe_section,
    heat_up,
    read,
)
from tests.problems.hems import describe_fast_hem
from tests.problems.ranks import explain_no_mpi, run_module_on_ranks, run_on_ranks
from tests.problems.square_cup import BEAD, describe_cup
from tests.problems.touching_bodies import FLYING, describe_bodies

COLUMNS = ("punch.force", "holder.force", "holder.stroke", "die.force_z", "bead_1.force")


@pytest.fixture
def needs_mpi():
    if reason := explain_no_mpi():
        pytest.skip(reason)


def _write(folder):
    case = folder / "cup.toml"
    case.write_text(describe_cup(8) + BEAD)
    return case


def _compare(first, second, columns):
    """Compare all that the next cycle depends on; a zero has no sign here."""
    one, two = (load_checkpoint(folder / "checkpoint.h5")[0] for folder in (first, second))
    assert set(one) == set(two)
    for name in one:
        if name.endswith(SHARES):
            np.testing.assert_allclose(two[name], one[name], rtol=1e-12, atol=1e-9, err_msg=name)
        else:
            np.testing.assert_array_equal(two[name], one[name], err_msg=name)
    found, wanted = (read_history(folder / "history.csv") for folder in (second, first))
    for name in (name for name in wanted if name.endswith("_energy")):
        np.testing.assert_allclose(found[name], wanted[name], rtol=1e-10, err_msg=name)
    for name in columns:
        np.testing.assert_array_equal(found[name], wanted[name], err_msg=name)


@pytest.mark.validation
@pytest.mark.usefixtures("needs_mpi")
def test_a_cup_with_holder_and_drawbead_has_the_bits_of_one_process_on_two_ranks_and_when_four_go_on(
    tmp_path,
):
    case = _write(tmp_path)
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.thinning=0.001", status=3)
    assert 0 < len(read_history(tmp_path / "two" / "history.csv")["time"]) < 10
    run_on_ranks(4, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two", COLUMNS)
    assert "4 ranks: " in (tmp_path / "two" / "run.log").read_text()


@pytest.mark.validation
@pytest.mark.usefixtures("needs_mpi")
def test_a_hot_block_under_a_pushed_die_has_the_bits_of_one_process_on_two_ranks_and_when_three_go_on(tmp_path):
    case = tmp_path / "block.toml"
    case.write_text(heat_up(describe_explicit_block(HEX, PUSHED.replace("2e-4", "6e-5"))))
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.hydrostatic_stress=0.3", status=3)
    assert 0 < len(read_history(tmp_path / "two" / "history.csv")["time"]) < 10
    run_on_ranks(3, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two", ("die.force", "die.stroke", "anvil.force_x", "x.force_x", "x_max"))


@pytest.mark.validation
@pytest.mark.usefixtures("needs_mpi")
def test_a_cylinder_that_gets_new_meshes_has_the_bits_of_one_process_on_two_ranks_and_when_three_go_on(tmp_path):
    case = tmp_path / "section.toml"
    case.write_text(describe_section().replace("enabled = false", "every = 0.3"))
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.hydrostatic_stress=1.0", status=3)
    one, two = (read_history(tmp_path / name / "history.csv") for name in ("one", "two"))
    assert 0 < two["remeshes"][-1] < one["remeshes"][-1]
    run_on_ranks(3, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two", ("die.force", "anvil.force", "remeshes", "x_max"))


@pytest.mark.validation
@pytest.mark.usefixtures("needs_mpi")
def test_blocks_that_strike_each_other_have_the_bits_of_one_process_on_two_ranks_and_when_three_go_on(tmp_path):
    case = tmp_path / "struck.toml"
    case.write_text(describe_bodies(FLYING, element="hex8_1pt"))
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.hydrostatic_stress=0.3", status=3)
    assert 0 < len(read_history(tmp_path / "two" / "history.csv")["time"]) < 12
    run_on_ranks(3, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two", ("joint.force_x", "joint.force_z", "x_max", "z_max"))
    assert abs(read_history(tmp_path / "two" / "history.csv")["joint.force_z"]).max() > 1e3


@pytest.mark.validation
@pytest.mark.usefixtures("needs_mpi")
def test_a_hem_pressed_on_its_panel_has_the_bits_of_one_process_on_two_ranks_and_when_three_go_on(tmp_path):
    """Stopped while the flange lies on the panel: shells touch shells."""
    case = tmp_path / "hem.toml"
    case.write_text(describe_fast_hem())
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.penetration=0.008", status=3)
    one, two = (read_history(tmp_path / name / "history.csv") for name in ("one", "two"))
    assert 0.0 < two["overlap"][-1] == one["overlap"][len(two["overlap"]) - 1]
    assert len(two["overlap"]) < len(one["overlap"])
    run_on_ranks(3, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two", ("overlap", "hem_steel.force", "hem_prehem.force"))


@pytest.mark.validation
@pytest.mark.usefixtures("needs_mpi")
def test_three_ranks_share_solids_shells_pushed_tools_and_mass_scaling_and_tell_failures_as_one_process():
    found = json.loads(run_module_on_ranks(3, "tests.problems.divided_loops"))
    for run, apart in found["apart"].items():
        wrong = {name: by for name, by in apart.items() if by > (1e-11 if name.endswith(SHARES) else 0.0)}
        assert not wrong, run
    (shells, shells_shared), (cells, cells_shared) = found["failed"]
    assert "has no finite position" in shells
    assert "is turned inside out in cycle" in cells
    assert (shells_shared, cells_shared) == (shells, cells)


def _begin(tmp_path, size=2, **changes):
    model = replace(build_model(read_case(_write(tmp_path))), **changes)
    return begin_on_ranks(model, 1, SimpleNamespace(rank=0, size=size))


def test_what_ranks_do_not_share_is_refused(tmp_path):
    model = build_model(read_case(_write(tmp_path)))
    with pytest.raises(StartError, match=r'asks for device = "host": ranks of MPI share .* without mpiexec'):
        _begin(tmp_path, explicit=replace(model.explicit, device="host"))
    with pytest.raises(StartError, match=r'asks for explicit\.step_bound = "mesh"'):
        _begin(tmp_path, explicit=replace(model.explicit, step_bound="mesh"))
    solid = read(describe_explicit_block(HEX, MOVED))
    with pytest.raises(StartError, match='asks for device = "host"'):
        begin_on_ranks(replace(solid, explicit=replace(solid.explicit, device="host")), 1, SimpleNamespace(rank=0))


def test_more_ranks_than_shells_are_refused(tmp_path):
    with pytest.raises(StartError, match="50 ranks, but the mesh has only 49 cells: start at most that many"):
        _begin(tmp_path, size=50)
