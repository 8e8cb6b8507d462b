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
from presswork.model import FloatArray
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


WALL, SQUARE = 50.0, 50.5
"""Middle surface of a tube 1 mm thick, and half the width of a square die that just goes round it [mm]."""


def write_square_die(path: Path) -> None:
    """Write a closed block with a square bore along x, as STL."""
    turn = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    facets = []
    for (ay, az), (by, bz) in zip(turn, turn[1:] + turn[:1], strict=True):
        bore = [(x, SQUARE * y, SQUARE * z) for x in (-10, 10) for y, z in ((ay, az), (by, bz))]
        out = [(x, 70 * y, 70 * z) for x in (-10, 10) for y, z in ((ay, az), (by, bz))]
        for a, b, c, d in (
            (bore[0], bore[2], bore[3], bore[1]),
            (out[1], out[3], out[2], out[0]),
            (bore[2], out[2], out[3], bore[3]),
            (bore[1], out[1], out[0], bore[0]),
        ):
            facets += [(a, b, c), (a, c, d)]
    lines = ["solid die"]
    for facet in facets:
        corners = "".join("vertex {} {} {}\n".format(*corner) for corner in facet)
        lines.append(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet")
    path.write_text("\n".join([*lines, "endsolid die\n"]))


def measure_corners(tube: Result, exponent: float, *, sticks: bool) -> FloatArray:
    """Return rows of radius over that of the tube, wall, its theory, pressure, that by radius and wall (n, 5).

    The free arc is a part of a circle under p = (2/sqrt 3) sigma t/r; all its metal has the same strain. Sticking metal
    leaves it as it was when it touched: t/t0 = (r/r0)^(4/pi - 1); without friction the whole wall thins by the length.
    """
    points, cells = tube.mesh.points, tube.mesh.blocks[0].connectivity
    middle = np.abs(points[cells]).mean(axis=1)
    at_corner = int(np.argmin(np.abs(np.arctan2(middle[:, 2], middle[:, 1]) - 0.25 * np.pi)))
    rows = []
    for step in range(1, len(tube.times)):
        place, wall = points + tube.field("displacement", step)[:, :3], tube.field("thickness", step)[at_corner]
        pressure = np.interp(tube.times[step], tube.history["time"], tube.history["pressure.water.p"])
        far = np.hypot(place[:, 1], place[:, 2]).max()
        radius = (np.sqrt(2.0) * (SQUARE - 0.5 * wall) - far) / (np.sqrt(2.0) - 1.0)
        share = radius / WALL
        thinned = share ** (4.0 / np.pi - 1.0) if sticks else 2.0 * np.pi / (8.0 - (8.0 - 2.0 * np.pi) * share)
        stress = 500.0 * (1e-4 - 2.0 / np.sqrt(3.0) * np.log(wall)) ** exponent
        rows.append((share, wall, thinned, pressure, 2.0 / np.sqrt(3.0) * stress * wall / radius))
    return np.array(rows)


@pytest.mark.validation
@pytest.mark.parametrize(
    ("procedure", "mu", "exponent", "largest"),
    [("implicit", 0.0, 0.2, 24.0), ("explicit", 0.0, 0.2, 24.0), ("explicit", 0.95, 0.5, 20.0)],
)
def test_a_tube_fills_the_corners_of_a_square_die(
    tmp_path: Path, procedure: str, mu: float, exponent: float, largest: float
) -> None:
    """Wall and pressure of a membrane within 1 and 2 % from a radius of 0.85 to one of 0.3; the wall is r/50 thick.

    A sticking arc necks once its strain passes n, so n is 0.5 there.
    """
    write_square_die(tmp_path / "die.stl")
    case = bore_case(procedure)
    case["blank"] |= {"diameter": 2.0 * WALL + THICKNESS, "length": 6, "element_size": 3}
    case["materials"]["steel"]["hardening"] |= {"e0": 1e-4, "n": exponent}
    case["tools"] = {
        "die": {"kind": "die", "shape": "file", "path": str(tmp_path / "die.stl"), "position": [0, 0, 0], "mu": mu}
    }
    case["stages"] = [{"name": "fill", "duration": 0.02, "pressure": {"water": {"p": largest}}}]
    case["output"] = {"steps": 20}
    tube = run_stamping(case, tmp_path / "out")
    rows = measure_corners(tube, exponent, sticks=mu > 0.0)
    rows = rows[(rows[:, 0] < 0.85) & (rows[:, 0] > 0.3)]
    assert len(rows) > 5
    np.testing.assert_allclose(rows[:, 1], rows[:, 2], rtol=0.01)
    np.testing.assert_allclose(rows[:, 3], rows[:, 4], rtol=0.02)
    assert tube.summary["warnings"] == [], "the forces of a die all round cancel, and it is touched all the same"
    assert tube.history["pressure.water.contact"][-1] > 0.5
