# SPDX-License-Identifier: Apache-2.0
"""A hot bar pressed between round dies by a crank press, on its first mesh and with new ones."""

from pathlib import Path

import pytest

from presswork import read_case, run
from tests.problems.hot_press import HOT_PRESS

pytestmark = pytest.mark.validation

CASE = """
title = "Fullering of a hot bar, an eighth of it"
analysis = "solid"

[workpiece]
material = "steel"
element = "tet4_mini"
mesh = { kind = "box", size = [30, 10, 10], cells = [12, 4, 4] }

[boundary]
middle_x = { set = "left", fix = ["x"] }
middle_y = { set = "bottom", fix = ["y"] }
middle_z = { set = "back", fix = ["z"] }

[tools.die]
shape = "straight"
profile = [[-30, 40], [-8, 18], { to = [8, 18], radius = 6 }, [30, 40]]
position = "touch"
contact = "frictionless"
heat = { temperature = 250, conductance = "8 kW/(m^2*K)" }

[[stages]]
name = "forge"
press = "maxi"
tools.die = { stroke = 6, direction = [0, 0, -1] }
"""


SIZES = "[remesh]\nsmallest_size = 1\nmax_cells = 6000\n"


@pytest.mark.parametrize("meshes", ["", SIZES, SIZES + "every = 0.2\n"])
def test_a_hot_bar_is_pressed_to_the_end_of_the_stroke(tmp_path: Path, meshes: str):
    path = tmp_path / "fullering.toml"
    path.write_text(CASE + HOT_PRESS + meshes)
    assert run(read_case(path), tmp_path / "out").status == "completed"
