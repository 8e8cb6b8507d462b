# SPDX-License-Identifier: Apache-2.0
"""Folds found from bending in the square cup: held as it should be, too gently, and hardly at all; some minutes."""

from __future__ import annotations

import pytest

from presswork.case import StampingCase, build_model, read_case
from presswork.examples import copy_example
from presswork.recorder import run_model

pytestmark = pytest.mark.validation


@pytest.mark.parametrize(("force", "folds", "ratio"), [("15 kN", False, (0.0, 0.02)), ("4 kN", False, (0.04, 0.2)),
                                                      ("1 kN", True, (1.0, 20.0))])  # fmt: skip
def test_the_cup_folds_where_its_holder_is_hardly_pushed_and_only_there(tmp_path, force, folds, ratio) -> None:
    case = read_case(copy_example("square_cup", tmp_path), [f"stages.0.tools.holder.force={force}"])
    found = run_model(build_model(case), tmp_path / "out", threads=1).result.summary["formability"]
    low, high = ratio
    assert low <= found["largest_fold_ratio"]["value"] < high
    assert (found["folds"] > 0) == ("the sheet folds" in found["verdict"]) == folds


@pytest.mark.parametrize("symmetry", [["x", "y"], ["x"], []])
def test_a_dome_has_no_folds_whatever_part_is_modelled(tmp_path, symmetry) -> None:
    """4 mm deep, of coarse shells, by increments; its height is that of a curve of the radius within 0.03 mm."""

    def tool(kind: str, diameter: float, edge: float) -> dict[str, object]:
        return {"kind": kind, "shape": "round", "diameter": diameter, "edge_radius": edge, "mu": 0.1}

    case = {
        "title": "dome", "analysis": "stamping", "procedure": "implicit",
        "blank": {"shape": "rectangle", "size": [40, 40], "thickness": 0.8, "element_size": 2.5,
                  "material": "numisheet93_mild_steel", "symmetry": symmetry},
        "tools": {"punch": tool("punch", 20, 10), "die": tool("die", 24, 6), "holder": tool("holder", 24, 1)},
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 4}, "holder": {"force": "4 kN"}}}],
        "output": {"steps": 1},
    }  # fmt: skip
    outcome = run_model(build_model(StampingCase.model_validate(case)), tmp_path / "out", threads=1)
    found = outcome.result.summary["formability"]
    assert found["folds"] == 0
    assert found["largest_fold_ratio"]["value"] < 0.1
