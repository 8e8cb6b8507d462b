# SPDX-License-Identifier: Apache-2.0
"""The example `blanking` at three clearances and on three meshes: force, work, stroke at fracture, zones of the edges.

`pytest -n0 -s -m validation validation/test_blanking.py` prints the figures of docs/verification/separation.md.
"""

import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from presswork import Case, build_model
from presswork.recorder import run_model

pytestmark = pytest.mark.validation
RULE = 0.8 * 690.0 * 2.0 * 3.14159265 * 20.0
"""0.8 UTS t L [N]."""


@cache
def blank(clearance: float = 10.0, smallest: float = 0.025, window: float = 0.05) -> dict[str, Any]:
    """Return what the summary has of a separation; clearance: of the thickness [%]; sizes of cells [mm]."""
    data = tomllib.loads((files("presswork") / "examples" / "blanking.toml").read_text("utf-8"))
    radius = 10.0 + 0.02 * clearance
    die = data["tools"]["die"]["profile"]
    die[0][0] = die[1]["to"][0] = radius
    data["tools"]["holder"]["profile"][1][0] = data["tools"]["holder"]["profile"][2][0] = radius + 0.2
    data["remesh"]["smallest_size"] = smallest
    data["remesh"]["windows"] = [{"box": [9.8, -1, radius + 0.2, 2], "size": window}]
    data["output"]["steps"] = 1
    with TemporaryDirectory() as folder:
        outcome = run_model(build_model(Case(**data)), Path(folder) / "run", threads=1)
        assert outcome.status == "completed", outcome.reason
        found = outcome.result.summary["separation"]
    print(
        f"\n{clearance:g} % {smallest:g} {window:g}: {found['largest_force_N'] / 1e3:.2f} kN, {found['work_J']:.2f} J"
    )
    print({key: found[key]["stroke_mm"] for key in ("first_crack", "parted")})
    for edge in found["edges"]:
        print({key: round(value, 3) for key, value in edge.items() if key != "piece"}, edge["piece"])
    return dict(found)


@pytest.mark.parametrize("clearance", [5.0, 10.0, 15.0])
def test_the_largest_force_is_that_of_the_rule_of_thumb(clearance: float) -> None:
    found = blank(clearance)
    assert found["pieces"] == 2
    assert found["largest_force_N"] == pytest.approx(RULE, rel=0.1)


def test_more_clearance_takes_less_force_and_a_longer_stroke() -> None:
    found = [blank(clearance) for clearance in (5.0, 10.0, 15.0)]
    forces = [of["largest_force_N"] for of in found]
    assert forces == sorted(forces, reverse=True)
    strokes = [of["parted"]["stroke_mm"] for of in found]
    assert strokes == sorted(strokes)


def test_force_and_stroke_at_fracture_hardly_depend_on_the_mesh() -> None:
    coarse, middle, fine = blank(10.0, 0.032, 0.065), blank(10.0), blank(10.0, 0.02, 0.04)
    for found in (coarse, middle):
        assert found["largest_force_N"] == pytest.approx(fine["largest_force_N"], rel=0.02)
        assert found["work_J"] == pytest.approx(fine["work_J"], rel=0.05)
        for key in ("first_crack", "parted"):
            assert found[key]["stroke_mm"] == pytest.approx(fine[key]["stroke_mm"], rel=0.05)
