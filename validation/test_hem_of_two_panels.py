# SPDX-License-Identifier: Apache-2.0
"""The packaged hem with an inner panel that deforms, too: both panels are one blank, and touch each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.case import StampingCase, build_model, read_case
from presswork.examples import copy_example
from tests.regression.whole_runs import run_to_end

SHEET = 0.8
OUTER, INNER = (35.0, 100), (23.5, 47)
"""Half of each panel along x [mm], and its shells."""


def write_panels(path: Path) -> None:
    """Write half of both, 6 mm wide, the inner one on the outer one, whose middle is z = 0."""
    nodes, cells, first = ["*NODE"], ["*ELEMENT, TYPE=S4, ELSET=panels"], 1
    for height, (length, n) in ((0.0, OUTER), (SHEET, INNER)):
        for i in range(n + 1):
            for j in range(5):
                number = first + 5 * i + j
                nodes.append(f"{number}, {i * length / n:.6g}, {-3 + 1.5 * j}, {height}")
                if i < n and j < 4:
                    cells.append(f"{len(cells)}, {number}, {number + 5}, {number + 6}, {number + 1}")
        first += 5 * (n + 1)
    path.write_text("\n".join([*nodes, *cells, ""]))


def make_case(folder: Path) -> StampingCase:
    """The packaged case; its punch leaves room for the inner panel, and a pad holds that instead of a rigid one."""
    data = read_case(copy_example("hemmed_panel", folder)).model_dump(mode="python", exclude_unset=True)
    write_panels(folder / "panels.inp")
    data["blank"] = {"shape": "file", "path": str(folder / "panels.inp"), "thickness": SHEET,
                     "material": "numisheet93_mild_steel", "symmetry": ["x"]}  # fmt: skip
    flange, hem = data["operations"]
    punch = [(0.0, 0.8), (23.95, 0.8), (23.95, 0.0), (25.0, 0.0), (25.0, 15.0), (0.0, 15.0)]
    flange["tools"]["punch"] |= {"corners": punch, "radius": (0.0, 0.0, 0.0, 1.0, 0.0, 0.0)}
    for name, side in (("punch", 0.5), ("die", -0.5), ("anvil", -0.5)):
        flange["tools"][name]["position"] = (0.0, 0.0, side * SHEET)
    del hem["tools"]["inner"]
    hem["tools"]["pad"] = {"kind": "holder", "shape": "section", "radius": (0.0, 0.5, 0.0, 0.0),
                           "corners": [(0.0, 0.0), (12.0, 0.0), (12.0, 10.0), (0.0, 10.0)]}  # fmt: skip
    hem["stages"][0]["tools"] = {"pad": {"force": 200}}
    return StampingCase.model_validate(data)


@pytest.mark.validation
def test_a_hem_of_two_panels_is_as_thick_as_its_three_sheets(tmp_path: Path) -> None:
    result = run_to_end(build_model(make_case(tmp_path)), tmp_path / "out")
    hem, history = result.summary["hem"], result.history
    least, most = hem["formed"]["thickness_mm"]
    steel = float(np.abs(history["hem_steel.force"]).max())
    overlap = float(history["overlap"].max())
    print(f"\nthickness {least:.3f} to {most:.3f} mm, edge {hem['formed']['edge_mm']['mean']:.3f} mm out, "
          f"rolled in {hem['roll_in_mm']['mean']:.3f} mm, {steel:.0f} N, overlap {overlap:.4f} mm")  # fmt: skip
    assert 3 * SHEET - 0.03 < least < most < 3 * SHEET + 0.05
    assert overlap < 0.05 * SHEET
    assert abs(hem["formed"]["opening_degrees"]["mean"]) < 0.1
    inner = result.points(-1)[len(result.points(-1)) - 5 * (INNER[1] + 1) :]
    assert np.ptp(inner[:, 2]) < 0.5 * SHEET  # it stays in the fold, and flat but for its springback
