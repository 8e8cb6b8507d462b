# SPDX-License-Identifier: Apache-2.0
"""A strip pulled through drawbeads: in steady state the pull is their force per length times the width, and friction.

Closed form, by equilibrium of the strip; it stays elastic, so its width keeps within 1e-4.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.recorder import run_model

WIDTH, FORCE = 10.0, 50.0
LAG = 10 / (4 - 1.5) * 1.5 * (0.25 - np.pi**-2)
"""Way [mm] that is free while the stage starts: the force grows straight, the velocity as half a cosine."""
STRIP: dict[str, Any] = {
    "title": "strip through a bead",
    "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [60, WIDTH], "thickness": 0.8, "element_size": 2.5, "material": "steel",
              "symmetry": ["y"]},
    "materials": {"steel": {"young": "206 GPa", "poisson": 0.3,
                            "hardening": {"law": "linear", "yield_stress": 300, "modulus": 1000}}},
    "boundary": {"flat": {"set": "all", "fix": ["z"]}},
    "beads": [{"points": [[3, -20], [3, 20]], "force": FORCE}],
    "stages": [{"name": "pull", "duration": 4e-3, "ramp": 1.5e-3,  # starts slowly: no waves run up and down the strip
                "displacement": [{"set": "right", "component": "x", "value": 10}]}],
    "output": {"rows": 40, "steps": 2},
    "implicit": {"max_increment": 0.05},
}  # fmt: skip
PULL = {"explicit": 5e-3, "implicit": 1e-4}
"""Of the pull: a little of the waves is left in the explicit strip."""
BOTH = pytest.mark.parametrize("procedure", ["explicit", "implicit"])


def pull(folder: Path, **changes: Any) -> Result:
    model = build_model(StampingCase.model_validate({**copy.deepcopy(STRIP), **changes}))
    outcome = run_model(model, folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def pull_at(result: Result, step: int = -1) -> np.ndarray:
    """Return the force that pulls the right end (3,) [N], of what is modelled."""
    right = np.isclose(result.mesh.points[:, 0], 30)
    return result.field("reaction_force", step)[right].sum(axis=0)


@BOTH
def test_the_pull_is_force_per_length_times_width(tmp_path, procedure) -> None:
    """A line longer than the strip holds with the part that lies on it; what it takes is force times way."""
    result = pull(tmp_path / "out", procedure=procedure)
    h = result.history
    late = (h["time"] > 0.45 * h["time"][-1]) & (h["time"] < 0.9 * h["time"][-1])
    np.testing.assert_allclose(h["bead_1.force"][late], FORCE * WIDTH, rtol=1e-9)
    assert 2 * pull_at(result, 1)[0] == pytest.approx(FORCE * WIDTH, rel=PULL[procedure])
    taken = h["friction_energy" if procedure == "explicit" else "friction_work"][-1]
    way = (
        10 - FORCE / 0.8 / 206e3 * 27 - LAG
    )  # of what is beneath: that of the right end, less what the strip stretches
    assert taken == pytest.approx(0.5 * FORCE * WIDTH * way, rel=1e-3)
    assert abs(h["energy_error_percent"][-1]) < 0.01


@BOTH
def test_friction_under_the_holder_is_added(tmp_path, procedure) -> None:
    """Two beads and a holder of 1 kN on a die, mu = 0.1 on both faces: 500 + 300 + 2 x 0.1 x 1000 N."""
    away = {"shape": "strip", "width": 4, "edge_radius": 1, "mu": 0.1, "face_width": 200}
    tools = {"die": {"kind": "die", "position": [-100, 0, -0.4], **away},
             "holder": {"kind": "holder", "position": [-100, 0, 0.4], **away}}  # fmt: skip
    stages = [{"name": "close", "duration": 1e-3, "tools": {"holder": {"force": 1000}}},
              {**STRIP["stages"][0], "displacement": [{"set": "right", "component": "x", "value": 2}]}]  # fmt: skip
    beads = [{"points": [[x, -5], [x, 5]], "force": f, "stages": ["pull"]} for x, f in ((-8, 50), (2, 30))]
    result = pull(tmp_path / "out", procedure=procedure, tools=tools, stages=stages, beads=beads, boundary={})
    assert 2 * pull_at(result, 3)[0] == pytest.approx(1000.0, rel=PULL[procedure])
    h = result.history
    assert h["bead_1.force"][h["stage"] == "close"].max() < 1e-9
    pulled = (h["stage"] == "pull") & (h["time"] < 0.9 * h["time"][-1]) & (h["time"] > 0.6 * h["time"][-1])
    for column, wanted in (("die.force_x", 100), ("holder.force_x", 100), ("bead_1.force", 500), ("bead_2.force", 300)):
        np.testing.assert_allclose(h[column][pulled], wanted, rtol=1e-2)


@BOTH
def test_a_line_aslant_holds_across_itself(tmp_path, procedure) -> None:
    """At 45 degrees it is sqrt(2) times as long; along x that is force x width again, and as much to the side."""
    blank = {**STRIP["blank"], "symmetry": []}
    beads = [{"points": [[-5, -5], [5, 5]], "force": FORCE}]
    boundary = {"guided": {"set": "all", "fix": ["y", "z"]}}
    output = {"rows": 40, "steps": 40}
    result = pull(tmp_path / "out", procedure=procedure, blank=blank, beads=beads, boundary=boundary, output=output)
    # at full speed; the mean over a quarter of the stroke, for waves run up and down the strip
    steady = range(int(0.375 * len(result.times)), int(0.65 * len(result.times)))
    across = np.mean([result.field("reaction_force", step).sum(axis=0) for step in steady], axis=0)
    assert result.history["bead_1.force"][-5] == pytest.approx(FORCE * WIDTH * np.sqrt(2), rel=1e-9)
    along = np.mean([pull_at(result, step)[0] for step in steady])
    assert along == pytest.approx(FORCE * WIDTH, rel=PULL[procedure])
    assert across[1] == pytest.approx(-FORCE * WIDTH, rel=PULL[procedure])


@BOTH
def test_a_sheet_that_has_left_the_line_is_free(tmp_path, procedure) -> None:
    """Its end is 6 mm behind the line at first, and 4 mm ahead of it at the end. Along its way a line holds nothing."""
    beads = [{"points": [[-24, -5], [-24, 5]], "force": FORCE}, {"points": [[-20, 3], [20, 3]], "force": FORCE}]
    result = pull(tmp_path / "out", procedure=procedure, beads=beads)
    h, force = result.history, result.history["bead_1.force"]
    assert np.interp(0.5 * h["time"][-1], h["time"], force) == pytest.approx(FORCE * WIDTH, rel=1e-9)
    assert force[h["time"] > 0.7 * h["time"][-1]].max() == 0.0
    taken = h["friction_energy" if procedure == "explicit" else "friction_work"][-1]
    late = 0.5 / (6 - LAG) if procedure == "implicit" else 5e-3  # an increment of 0.5 mm sees the end pass
    assert taken == pytest.approx(0.5 * FORCE * WIDTH * (6 - LAG), rel=late)
