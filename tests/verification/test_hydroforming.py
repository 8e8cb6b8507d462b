# SPDX-License-Identifier: Apache-2.0
"""Tubes that a fluid presses into dies, against volume and geometry."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from tests.regression.whole_runs import run_stamping, run_to_end

RADIUS, THICKNESS, BORE = 29.5, 1.0, 32.0
"""Middle surface and wall of the tube, and the die's bore [mm]."""


def bore_case(procedure: str) -> dict[str, Any]:
    """A short quarter tube between two frames, which a pressure presses into a plain bore."""
    return {
        "title": "a tube in a bore",
        "analysis": "stamping",
        "procedure": procedure,
        "blank": {
            "shape": "tube", "diameter": 2.0 * RADIUS + THICKNESS, "length": 20, "thickness": THICKNESS,
            "element_size": 4, "material": "steel", "symmetry": ["x", "y"],
        },
        "materials": {
            "steel": {
                "young": 206e3, "poisson": 0.3, "density": "7850 kg/m^3",
                "hardening": {"law": "swift", "K": 500.0, "e0": 0.01, "n": 0.2},
            }
        },
        "boundary": {"ends": {"set": "edge", "fix": ["x"]}, "sides": {"set": "sides", "fix": ["z"]}},
        "tools": {
            "die": {
                "kind": "die", "shape": "section", "plan": "round_x", "position": [0, 0, 0], "mu": 0.0,
                "corners": [[-15, BORE], [15, BORE], [15, BORE + 10], [-15, BORE + 10]],
            }
        },
        "pressure": {"water": {"face": "inside"}},
        "stages": [{"name": "bulge", "duration": 0.004, "pressure": {"water": {"p": 30.0}}}],
        "output": {"steps": 1},
    }  # fmt: skip


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_tube_takes_the_shape_of_a_bore_and_its_wall_the_volume(tmp_path: Path, procedure: str) -> None:
    """Between fixed ends t r is constant, and r = BORE - t/2 but for the die's chords (0.03 mm) and the penalty."""
    tube: Result = run_stamping(bore_case(procedure), tmp_path / "out")
    place = tube.mesh.points + tube.field("displacement", 1)[:, :3]
    radius, thickness = np.hypot(place[:, 1], place[:, 2]), tube.field("thickness", 1)
    final = BORE - 0.5 * thickness.mean()
    np.testing.assert_allclose(radius, final, atol=0.05)
    np.testing.assert_allclose(thickness, THICKNESS * RADIUS / final, rtol=0.005)
    assert tube.summary["warnings"] == []


@pytest.mark.validation
def test_a_fed_tube_fills_its_die_alike_by_both_procedures(tmp_path: Path) -> None:
    """The packaged example: largest thinning within 0.3 points of 14 %, height of the bulge within 0.05 mm."""
    path = copy_example("tube_hydroforming", tmp_path)
    found = []
    for procedure in ("explicit", "implicit"):
        result = run_to_end(build_model(read_case(path, [f'procedure="{procedure}"'])), tmp_path / procedure)
        thinning = result.summary["formability"]["largest_thinning_percent"]["value"]
        found.append((thinning, result.history["pressure.water.height"][-1]))
    assert found[0][0] == pytest.approx(found[1][0], abs=0.3)
    assert found[0][1] == pytest.approx(found[1][1], abs=0.05)
