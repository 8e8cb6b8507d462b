# SPDX-License-Identifier: Apache-2.0
"""The example `quench_gear_blank`: hardness, distortion, residual stress and the balance of energy.

`pytest -n0 -s -m validation validation/test_quench.py` prints its figures.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest

from presswork import api
from presswork.case import read_case

pytestmark = pytest.mark.validation


def test_a_gear_blank_is_hard_and_nearly_without_stress(tmp_path: Path) -> None:
    case = read_case(Path(str(files("presswork") / "examples" / "quench_gear_blank.toml")))
    result = api.run(case, tmp_path / "out").result
    last = {name: float(values[-1]) for name, values in result.history.items() if name != "stage"}
    for name in ("rim_top", "rim_bottom", "bore_top"):
        print(name, *(f"{key} {last[f'{name}.{key}']:.4g}" for key in ("x", "y", "hardness", "martensite")))
        assert 650 < last[f"{name}.hardness"] < 720
        assert 0.9 < last[f"{name}.martensite"] < 0.97
    assert last["rim_top.x"] < last["rim_bottom.x"] < 48.0
    assert abs(result.summary["energy"]["error_percent"]) < 1.0
