# SPDX-License-Identifier: Apache-2.0
"""A notch that is pressed shut in space: new meshes leave out what has closed, and the part has a lap."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.results import Result

NOTCHED = """
title = "a block with a notch is pressed"
analysis = "solid"
[workpiece]
material = "steel"
element = "tet4_mini"
[workpiece.mesh]
kind = "extruded"
outline = [[0, 0], [8, 0], [8, 2.2], [5, 4], [8, 5.8], [8, 8], [0, 8]]
element_size = 1.2
height = 1.2
cells = 1
[materials.steel]
young = 200e3
poisson = 0.3
hardening = {law = "swift", K = 565, e0 = 0.007, n = 0.26}
[tools.die]
shape = "plane"
normal = [0, -1, 0]
position = [0, 8, 0]
contact = "shear"
m = 0.2
[tools.anvil]
shape = "plane"
normal = [0, 1, 0]
contact = "shear"
m = 0.2
[boundary]
x = {set = "left", fix = ["x"]}
z0 = {set = "back", fix = ["z"]}
z1 = {set = "front", fix = ["z"]}
[[stages]]
name = "press"
tools.die = {stroke = 1.3, direction = [0, -1, 0]}
[solver]
max_increment = 0.17
[output]
steps = 1
[remesh]
size = 1.2
smallest_size = 1.0
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Result:
    folder = tmp_path_factory.mktemp("notch")
    (folder / "case.toml").write_text(NOTCHED)
    return run_model(build_model(read_case(folder / "case.toml")), folder / "run", threads=1).result


def test_a_notch_is_pressed_shut_to_the_end(result):
    """With contact of the body with itself alone the run gave up where the notch was half shut."""
    assert result.summary["status"] == "completed"
    assert 10 in result.history["remesh_cause"]
    volume = result.summary["volume"]
    assert volume["change_percent"] == pytest.approx(volume["elastic_part_percent"], abs=0.01)


def test_what_has_closed_is_a_lap_in_summary_and_field(result):
    (lap,) = result.summary["laps"]
    assert 5.0 < lap["x_mm"] < 8.0
    assert lap["z_mm"] == pytest.approx(0.6, abs=0.2)
    assert 0.3 < lap["area_mm2"] < 3.5 * 1.2, "the notch is 3.5 mm deep along its side"
    assert any("a lap, a fault of the part" in warning for warning in result.summary["warnings"])
    marked = result.points(-1)[result.field("lap") > 0.5]
    assert len(marked) >= 3
    assert np.abs(marked[:, 1] - lap["y_mm"]).max() < 1.5
    assert result.field("lap", 0).max() == 0.0
