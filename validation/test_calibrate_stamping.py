# SPDX-License-Identifier: Apache-2.0
"""Numbers of a stamping from a curve that the case itself has computed with others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tomli_w

from presswork.case.stamping.schema import StampingCase
from presswork.study.calibrate_curve import calibrate_curve
from tests.problems.differentiated import draw_under_holder, run_case, set_value

pytestmark = pytest.mark.validation

TRUE = {
    "materials.steel.hardening.K": 610.0,
    "materials.steel.hardening.n": 0.23,
    "tools.die.mu": 0.12,
    "blank.thickness": 1.04,
}


@pytest.mark.parametrize(
    ("column", "keys"),
    [("punch.force", list(TRUE)), ("end.draw_in", ["tools.die.mu", "blank.thickness"])],
)
def test_numbers_of_a_drawn_strip_are_found_from_its_punch_force_or_draw_in(
    column: str, keys: list[str], tmp_path: Path
) -> None:
    """First guesses are 4 to 17 % off; the curve has six digits."""
    data = draw_under_holder()
    data.pop("springback")
    data["implicit"] |= {"force_tolerance": 1e-8, "displacement_tolerance": 1e-7}
    case, curve = tmp_path / "case.toml", tmp_path / "curve.csv"
    case.write_text(tomli_w.dumps(data), encoding="utf-8")
    for key in keys:
        data = set_value(data, key, TRUE[key])
    history = run_case(StampingCase, data, tmp_path / "truth").history
    points = np.column_stack([history["punch.stroke"], history[column]])
    np.savetxt(curve, points, delimiter=",", header=f"punch.stroke,{column}", comments="", fmt="%.6g")
    fit = calibrate_curve(
        curve,
        case,
        tmp_path / "fit",
        keys=keys,
        on_run=lambda number, values, misfit: print(f"{number} {misfit:.1e} {values}"),
    )
    assert fit.runs <= 8
    assert fit.misfit < 1e-4
    for key in keys:
        assert fit.values[key] == pytest.approx(TRUE[key], rel=1e-3), key
