# SPDX-License-Identifier: Apache-2.0
"""Explicit runs on several ranks of MPI: the bits of one process, resume on another number, and what is refused."""

import numpy as np
import pytest

from presswork.results import load_checkpoint, read_history
from tests.problems.ranks import explain_no_mpi, run_on_ranks

CUP = """
title = "A quarter of a square cup"
analysis = "stamping"
procedure = "explicit"
[blank]
shape = "rectangle"
size = [100, 100]
thickness = 0.8
element_size = 5
material = "steel"
symmetry = ["x", "y"]
[materials.steel]
young = "210 GPa"
poisson = 0.3
hardening = {law = "swift", K = 565.32, e0 = 0.007117, n = 0.2589}
[tools.punch]
kind = "punch"
shape = "rectangular"
size = [51, 51]
corner_radius = 10
edge_radius = 4
mu = 0.144
[tools.die]
kind = "die"
shape = "rectangular"
size = [54, 54]
corner_radius = 11.5
edge_radius = 4
mu = 0.144
[tools.holder]
kind = "holder"
shape = "rectangular"
size = [54, 54]
corner_radius = 11.5
edge_radius = 1
mu = 0.144
[[stages]]
name = "draw"
velocity = "2 m/s"
tools.punch = {stroke = 2}
tools.holder = {force = "15 kN"}
[output]
steps = 1
rows = 10
"""
SHARES = ("loop.work", "contact.damping", "contact.friction", "contact.squeeze", "contact.external", "contact.drag")
"""Each rank counts its own; their sum is rounded."""


@pytest.fixture
def needs_mpi():
    if reason := explain_no_mpi():
        pytest.skip(reason)


def _write(folder, text=CUP):
    case = folder / "cup.toml"
    case.write_text(text)
    return case


def _compare(first, second):
    """Compare all that the next cycle depends on; a zero has no sign here."""
    one, two = (load_checkpoint(folder / "checkpoint.h5")[0] for folder in (first, second))
    assert set(one) == set(two)
    for name in one:
        if name in SHARES:
            np.testing.assert_allclose(two[name], one[name], rtol=1e-12, atol=1e-9, err_msg=name)
        elif not name.startswith("run."):
            np.testing.assert_array_equal(two[name], one[name], err_msg=name)
    found, wanted = (read_history(folder / "history.csv") for folder in (second, first))
    for name in ("punch.force", "holder.force", "holder.stroke", "die.force_z"):
        np.testing.assert_array_equal(found[name], wanted[name], err_msg=name)


@pytest.mark.usefixtures("needs_mpi")
def test_a_cup_with_a_pushed_holder_has_the_bits_of_one_process_on_two_ranks_and_when_four_go_on(tmp_path):
    case = _write(tmp_path)
    run_on_ranks(1, case, tmp_path / "one")
    run_on_ranks(2, case, tmp_path / "two", "--set", "limits.thinning=0.001", status=3)
    assert 0 < len(read_history(tmp_path / "two" / "history.csv")["time"]) < 10
    run_on_ranks(4, case, tmp_path / "two", "--resume")
    _compare(tmp_path / "one", tmp_path / "two")
    assert "4 ranks: " in (tmp_path / "two" / "run.log").read_text()
