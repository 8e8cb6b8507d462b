# SPDX-License-Identifier: Apache-2.0
"""A hot round billet pressed into a round hole by a crank press, on new meshes: in axisymmetry and in space."""

from pathlib import Path

import numpy as np
import pytest

from presswork import read_case, run
from presswork.results import Result
from tests.problems.hot_press import HOT_PRESS

pytestmark = pytest.mark.validation

OUTPUT = """
[output]
steps = 5
"""
TOUCHING = """
contact = "shear"
m = 0.3

[tools.NAME.heat]
temperature = 200
warms_up = true
conductance = [[0, "2 kW/(m^2*K)"], [100, "20 kW/(m^2*K)"]]
conductivity = 25
specific_heat = "460 J/(kg*K)"
density = "7800 kg/m^3"
"""
PROFILE = "profile = [[5, 25], { to = [5, 10], radius = 3 }, [40, 10]]"
ROUND = """
title = "A hot billet pressed into a round hole"
analysis = "axisymmetric"

[workpiece]
material = "steel"
element = "quad4_fbar"
mesh = { size = [12, 10], cells = [24, 20] }

[boundary]
axis = { set = "left", fix = ["x"] }

[remesh]
smallest_size = 0.25

[[stages]]
name = "press"
press = "maxi"
tools.die = { stroke = 5, direction = [0, -1] }

[tools.anvil]
profile = [[40, 0], [0, 0]]
"""
IN_SPACE = """
title = "A hot billet pressed into a round hole, a quarter"
analysis = "solid"

[workpiece]
material = "steel"
element = "tet4_mini"
mesh = { kind = "cylinder", radius = 12, height = 10, angle = 90, cells = [6, 8, 6] }

[boundary]
middle_x = { set = "left", fix = ["x"] }
middle_y = { set = "bottom", fix = ["y"] }

[remesh]
smallest_size = 0.7
max_cells = 8000

[[stages]]
name = "press"
press = "maxi"
tools.die = { stroke = 5, direction = [0, 0, -1] }

[tools.anvil]
shape = "plane"
normal = [0, 0, 1]
"""


def press(folder: Path, case: str, die: str) -> Result:
    text = (
        case
        + TOUCHING.replace("NAME", "anvil")
        + "\n[tools.die]\n"
        + die
        + TOUCHING.replace("NAME", "die")
        + HOT_PRESS
        + OUTPUT
    )
    folder.mkdir()
    (folder / "case.toml").write_text(text)
    outcome = run(read_case(folder / "case.toml"), folder / "out")
    assert outcome.status == "completed"
    return outcome.result


def test_forces_in_space_are_those_of_axisymmetry(tmp_path: Path) -> None:
    flat = "profile = [[0, 25], [5, 25], { to = [5, 10], radius = 3 }, [40, 10]]\n"
    die = 'shape = "round"\n' + PROFILE + "\n"
    results = press(tmp_path / "round", ROUND, flat), press(tmp_path / "space", IN_SPACE, die)
    stroke = np.linspace(0.5, 4.5, 17)
    force, expected = (np.interp(stroke, r.history["die.stroke"], r.history["die.force"]) for r in results[::-1])
    print("force over that of axisymmetry:", np.round(force / expected, 4))
    assert all(r.history["remeshes"][-1] > 1 for r in results)
    np.testing.assert_allclose(force, expected, rtol=0.025)
