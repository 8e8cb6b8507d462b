# SPDX-License-Identifier: Apache-2.0
"""The holder force of a square cup for the least thinning with wrinkles below 0.2 mm, against a dense sweep."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.examples import copy_example
from presswork.study import optimise, run_sweep

HOLDER = "stages.0.tools.holder.force"
SET = ["blank.element_size=4", "output.steps=1", "stages.0.tools.punch.stroke=14", "stages.0.velocity=10000"]
STUDY = f"""
case = "square_cup.toml"
set = {SET}
variables = [{{key = "{HOLDER}", lower = "2 kN", upper = "40 kN"}}]
goals = [{{minimise = "max_thinning_percent"}}]
limits = [{{measure = "wrinkle_height", at_most = 0.2}}]
search = {{runs = 20}}
"""


@pytest.mark.validation
def test_holder_force_of_least_thinning_is_that_of_a_dense_sweep(tmp_path: Path) -> None:
    """Thinning rises with the force and wrinkles fall with it, so that the optimum is where they come to the limit."""
    case = copy_example("square_cup", tmp_path)
    study = tmp_path / "cup.toml"
    study.write_text(STUDY)
    found = optimise(study, tmp_path / "optimum")
    assert found.best is not None
    swept = run_sweep(
        case, {HOLDER: [f"{force} kN" for force in (5.8, 6.0, 6.2, 6.4, 6.6)]}, tmp_path / "sweep", settings=SET
    )
    forces = [float(str(row[HOLDER]).split()[0]) for row in swept.rows]
    heights = [row["wrinkle_height"] for row in swept.rows]
    thinning = [row["max_thinning_percent"] for row in swept.rows]
    assert all(np.diff(thinning) > 0.0)
    assert all(np.diff(heights) < 0.0)
    least = float(np.interp(-0.2, -np.array(heights), forces))
    print(f"optimum {found.best.values[HOLDER]:.4g} kN in {len(found.runs)} runs, sweep {least:.4g} kN")
    assert least <= found.best.values[HOLDER] == pytest.approx(least, abs=0.01 * 38.0)
