# SPDX-License-Identifier: Apache-2.0
"""Sheets formed by increments on 2 and 4 ranks of MPI, with the settings that users have, beside one process."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from presswork.results import load_checkpoint, read_history
from tests.problems.divided_shells import RELEASED, describe_implicit_cup
from tests.problems.ranks import explain_no_mpi, run_on_ranks

MISSING = "petsc4py is not installed" if importlib.util.find_spec("petsc4py") is None else explain_no_mpi()
pytestmark = [pytest.mark.validation, pytest.mark.skipif(bool(MISSING), reason=MISSING)]
STATE = ("nodes.displacement", "cells.stress.0", "cells.eqps.0", "shells.thickness.0")


def test_a_cup_drawn_and_let_go_on_ranks_is_that_of_one_process(tmp_path: Path) -> None:
    """A quarter of a square cup in shells of 5 mm, 5 mm deep, trimmed, springs back."""
    case = tmp_path / "cup.toml"
    case.write_text(describe_implicit_cup(5, 5.0) + RELEASED)
    for ranks in (1, 2, 4):
        run_on_ranks(ranks, case, tmp_path / str(ranks))
    one, history = load_checkpoint(tmp_path / "1" / "checkpoint.h5")[0], read_history(tmp_path / "1" / "history.csv")
    for ranks in (2, 4):
        other = load_checkpoint(tmp_path / str(ranks) / "checkpoint.h5")[0]
        for name in (f"{part}.{array}" for part in ("forming", "springback") for array in STATE):
            apart = np.abs(other[name] - one[name]).max() / np.abs(one[name]).max()
            print(f"{ranks} ranks, {name}: {apart:.1e}")
            assert apart < 1e-8, name
        found = read_history(tmp_path / str(ranks) / "history.csv")
        assert found["iterations"].tolist() == history["iterations"].tolist()
        np.testing.assert_allclose(found["punch.force"], history["punch.force"], rtol=1e-6, atol=1e-6)
