# SPDX-License-Identifier: Apache-2.0
"""An implicit stamping optimised by the derivatives of its runs, beside differences of runs."""

from __future__ import annotations

from pathlib import Path

import pytest
import tomli_w

from presswork.study import optimise
from tests.problems.differentiated import draw_under_holder

STUDY = """
case = "strip.toml"
goals = [{{minimise = "max_thinning_percent"}}]
limits = [{{measure = "last:tip.z", at_least = -0.12}}]
search = {{method = "gradient", slopes = "{slopes}", runs = 60}}
[[variables]]
key = "stages.0.tools.holder.force"
lower = "0.4 kN"
upper = "4 kN"
[[variables]]
keys = ["tools.die.edge_radius", "tools.holder.edge_radius"]
lower = 5
upper = 8
[[variables]]
key = "tools.punch.edge_radius"
lower = 4
upper = 7
"""


@pytest.mark.validation
def test_thinnest_cell_within_a_limit_of_springback(tmp_path: Path) -> None:
    """The holder's force, and the radii of the tools."""
    case = draw_under_holder()
    case["implicit"] = {"initial_increment": 0.05, "max_increment": 0.05, "max_iterations": 40, "force_tolerance": 1e-8}
    (tmp_path / "strip.toml").write_text(tomli_w.dumps(case))
    found = {}
    for slopes in ("exact", "differences"):
        study = tmp_path / f"{slopes}.toml"
        study.write_text(STUDY.format(slopes=slopes))
        found[slopes] = optimise(study, tmp_path / slopes, jobs=1)
        best = found[slopes].best
        assert best is not None
        assert best.outcome is not None
        print(slopes, len(found[slopes].runs), best.values, best.measures["max_thinning_percent"], found[slopes].reason)
    exact, other = (found[slopes].best.outcome.goal for slopes in ("exact", "differences"))  # type: ignore[union-attr]
    assert exact == pytest.approx(other, rel=0.02)
    assert len(found["exact"].runs) <= len(found["differences"].runs) / 2
