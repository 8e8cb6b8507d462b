# SPDX-License-Identifier: Apache-2.0
"""The example connecting_rod, hands off: the die that validation/connecting_rod.py draws is filled."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.examples import copy_example
from validation.connecting_rod import draw_files

pytestmark = pytest.mark.validation


def test_the_rod_fills_its_die(tmp_path):
    path = copy_example("connecting_rod", tmp_path)
    preform = draw_files(tmp_path / "drawn")
    assert (tmp_path / "drawn/connecting_rod_die.stl").read_bytes() == (
        tmp_path / "connecting_rod_die.stl"
    ).read_bytes()
    case = read_case(path)
    assert np.array(case.workpiece.mesh.outline)[: len(preform)] * [1, -1] == pytest.approx(np.array(preform))
    done = run_model(build_model(case), tmp_path / "run", threads=1)
    assert done.status == "completed"
    told = done.result.summary
    assert told["die_fill"]["die"]["wall_filled"] > 0.98
    assert told["die_fill"]["die"]["flash_thickness_mm"] == pytest.approx(1.8, abs=0.01)
    assert told["remeshes"] >= 3
    volume = told["volume"]
    assert abs(volume["change_percent"] - volume["elastic_part_percent"]) < 0.5
    assert abs(told["energy"]["error_percent"]) < 2.0
