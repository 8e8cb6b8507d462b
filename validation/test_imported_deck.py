# SPDX-License-Identifier: Apache-2.0
"""A deck of another program, imported and run, answers as the same job drawn in presswork's own words."""

import copy
import tomllib

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

from presswork import build_model, read_case, run_model
from presswork.cli import app
from tests.problems.dyna_deck import NOSE, OPENING, PUNCH, SHOULDER, write_deck

pytestmark = pytest.mark.validation

DRAWN = {
    "punch": {"kind": "punch", "diameter": 2 * PUNCH, "edge_radius": NOSE},
    "holder": {"kind": "holder", "diameter": 2 * OPENING, "edge_radius": 0.5},
    "die": {"kind": "die", "diameter": 2 * OPENING, "edge_radius": SHOULDER},
}


def test_an_imported_cup_is_drawn_as_one_of_drawn_tools(tmp_path) -> None:
    """Punch force 0.7 %, thickness 0.1 %: tools of facets beside exact ones (arcs of 7.5 and 3.75 degrees)."""
    (tmp_path / "cup.k").write_text(write_deck())
    assert CliRunner().invoke(app, ["import", str(tmp_path / "cup.k")]).exit_code == 0
    folder = tmp_path / "cup"
    data = tomllib.loads((folder / "case.toml").read_text())
    drawn = copy.deepcopy(data)
    for name, tool in DRAWN.items():
        drawn["tools"][name] = {"shape": "round", "mu": data["tools"][name]["mu"], **tool}
    (folder / "drawn.toml").write_text(tomli_w.dumps(drawn))
    imported, own = (
        run_model(build_model(read_case(folder / f"{name}.toml")), tmp_path / name, threads=1).result
        for name in ("case", "drawn")
    )
    force = [result.history["punch.force"][-40:].mean() for result in (imported, own)]
    assert force[0] == pytest.approx(force[1], rel=0.02)
    thickness = [result.field("thickness") for result in (imported, own)]
    assert np.abs(thickness[0] - thickness[1]).mean() < 0.003
