# SPDX-License-Identifier: Apache-2.0
"""Folds found from bending in the square cup: held as it should be, too gently, and hardly at all; some minutes."""

from __future__ import annotations

import pytest

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.recorder import run_model

pytestmark = pytest.mark.validation


@pytest.mark.parametrize(("force", "folds", "ratio"), [("15 kN", False, (0.0, 0.1)), ("4 kN", False, (0.08, 0.2)),
                                                      ("1 kN", True, (1.0, 20.0))])  # fmt: skip
def test_the_cup_folds_where_its_holder_is_hardly_pushed_and_only_there(tmp_path, force, folds, ratio) -> None:
    case = read_case(copy_example("square_cup", tmp_path), [f"stages.0.tools.holder.force={force}"])
    found = run_model(build_model(case), tmp_path / "out", threads=1).result.summary["formability"]
    low, high = ratio
    assert low < found["largest_fold_ratio"]["value"] < high
    assert (found["folds"] > 0) == ("the sheet folds" in found["verdict"]) == folds
