# SPDX-License-Identifier: Apache-2.0
"""Before computing, tools that forces and springs place go with others, those of later operations with the part."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.server.estimated_part import EstimatedPart
from tests.unit.server.test_motion import plan

LINE = [
    "draw_die",
    "draw_holder",
    "draw_punch",
    "flange_die",
    "flange_pad",
    "flange_punch",
    "pierce_pad",
    "pierce_post",
]
BLOCK = """
title = "block on a cushion"
analysis = "plane_strain"
[workpiece]
element = "quad4_fbar"
material = "steel"
mesh = {{kind = "rectangle", size = [10, 6], cells = [4, 3]}}
[materials.steel]
young = 200000
poisson = 0.3
hardening = {{law = "linear", yield_stress = 700, modulus = 300}}
[tools.punch]
profile = [[-5, 6], [25, 6]]
contact = "frictionless"
[tools.cushion]
profile = [[40, 4], [20, 4], [20, 0], [-5, 0]]
contact = "frictionless"
{cushion}
[boundary]
left = {{set = "left", fix = ["x"]}}
[[stages]]
name = "press"
tools.punch = {{stroke = 5, direction = [0, -1]}}
{stage}
"""


class At:
    """A tool that has not turned."""

    turned = 0.0

    def __init__(self, *moved: float) -> None:
        self.moved = np.array(moved)


def last(moments: list[dict[str, Any]], number: int) -> list[float]:
    """Return the pose of a tool at the end."""
    found: list[float] = moments[-1]["tools"][number]
    return found


def test_holder_goes_back_with_the_die_and_stands_if_it_stands(tmp_path: Path) -> None:
    path = copy_example("square_cup", tmp_path)
    moments = plan(path, tmp_path / "standing")
    assert last(moments, 1) == pytest.approx([0.0] * 6, abs=0.01)
    lifted = path.with_name("lifted.toml")
    lifted.write_text(
        path.read_text("utf-8").replace("tools.punch = {stroke = 20}", "tools.die = {stroke = 20}"), "utf-8"
    )
    moments = plan(lifted, tmp_path / "lifted")
    die, holder, punch = moments[-1]["tools"]
    assert die[2] == pytest.approx(20.0)
    assert holder[2] == pytest.approx(20.0, abs=0.01), "the sheet lies between them"
    assert punch[2] == 0.0
    assert moments[len(moments) // 2]["tools"][1][2] == pytest.approx(
        moments[len(moments) // 2]["tools"][0][2], abs=0.01
    )


@pytest.mark.parametrize("placed", ["spring", "force"])
def test_a_punch_carries_the_cushion_that_it_comes_upon(tmp_path: Path, placed: str) -> None:
    """The cushion's face is 2 mm below the punch, which goes 5 mm: it goes down the last 3."""
    spring, force = (
        "spring = {stiffness = 100, direction = [0, -1]}",
        "tools.cushion = {force = 100, direction = [0, 1]}",
    )
    path = tmp_path / "block.toml"
    words = {"spring": (spring, ""), "force": ("", force)}[placed]
    path.write_text(BLOCK.format(cushion=words[0], stage=words[1]), "utf-8")
    moments = plan(path, tmp_path / "drawn")
    ways, gone = np.array([[tool[1] for tool in moment["tools"]] for moment in moments]).T
    np.testing.assert_allclose(ways, np.minimum(0.0, gone + 2.0), atol=1e-6)


def test_tools_of_later_operations_stand_at_the_part_that_the_drawing_leaves(tmp_path: Path) -> None:
    """The punch has drawn the bottom 16 mm deep, the flange has stayed; the sheet is 0.8 mm thick."""
    moments = plan(copy_example("press_line", tmp_path), tmp_path / "drawn")
    start = {m["label"]: dict(zip(LINE, m["tools"], strict=True)) for m in moments if m["label"].endswith("start")}
    pierced, flanged = start["pierce: start"], start["flange: start"]
    assert pierced["pierce_pad"][2] == pytest.approx(-15.6, abs=0.1)
    assert pierced["pierce_post"][2] == pytest.approx(-16.4, abs=0.1)
    assert abs(flanged["flange_die"][2]) < 1.0
    assert abs(flanged["flange_punch"][2]) < 1.0


def test_a_clash_in_a_later_operation_is_marked_where_it_is(tmp_path: Path) -> None:
    """A flanging punch of 72 mm inside comes down upon a ring of 76; its radius and the ring's pass 6 mm before."""
    path = copy_example("press_line", tmp_path)
    tight = path.with_name("tight.toml")
    tight.write_text(path.read_text("utf-8").replace("inner_diameter = 78", "inner_diameter = 72"), "utf-8")
    moments = plan(tight, tmp_path / "tight")
    met = [moment for moment in moments if moment["clash"]]
    assert all(moment["label"].startswith("flange: down") for moment in met)
    assert set(met[0]["clash"]["names"]) == {"flange_punch", "flange_die"}
    assert -8.0 < met[0]["tools"][LINE.index("flange_punch")][2] < -4.0


def test_a_taut_sheet_touches_its_tools_and_is_straight_between(tmp_path: Path) -> None:
    model = build_model(read_case(copy_example("restruck_channel", tmp_path)))
    part, operation = EstimatedPart(model), model.of_operation(0)
    part.form(operation, {"draw_punch": At(0, 0, -25.0), "draw_die": At(0, 0, 0), "draw_holder": At(0, 0, 0)})
    x, _, z = part._points.T
    assert z[x < 18.0] == pytest.approx(-25.0, abs=0.01), "under the punch"
    assert z[x > 33.0] == pytest.approx(0.0, abs=0.01), "between die and holder"
    wall = (x > 25.3) & (x < 26.2)
    assert (np.diff(z[np.argsort(x)]) > -0.01).all()
    assert wall.sum() == 0 or (z[wall] < -2.0).all()
