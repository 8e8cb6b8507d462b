# SPDX-License-Identifier: Apache-2.0
"""Tools move before computing as the run will move them, and clashes are found where tools meet, and nowhere else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.examples import copy_example
from presswork.server.drawing import MOTION, check

SOUND = [
    "bar_cogging", "bolt_heading", "can_extrusion", "connecting_rod", "extrusion_cone", "gear_blank", "hammer_forging",
    "hemispherical_punch", "hot_disc", "press_line", "restruck_channel", "square_cup", "strip_rolling", "two_bodies",
]  # fmt: skip


def plan(path: Path, folder: Path) -> list[dict[str, Any]]:
    """Return the moments of a case."""
    folder.mkdir(exist_ok=True)
    found = check(path, folder)
    assert found["is_drawn"], found
    moments: list[dict[str, Any]] = json.loads((folder / MOTION).read_text("utf-8"))["moments"]
    return moments


@pytest.mark.parametrize("name", SOUND)
def test_no_tools_of_a_sound_case_meet(tmp_path: Path, name: str) -> None:
    moments = plan(copy_example(name, tmp_path), tmp_path / "drawn")
    assert len(moments) > 10
    assert not [moment for moment in moments if moment["clash"]]


def test_tools_that_wait_are_placed_by_their_stages_and_end_as_drawn(tmp_path: Path) -> None:
    """Blocker and finisher wait 60 mm above; the former tool is taken away again."""
    moments = plan(copy_example("gear_blank", tmp_path), tmp_path / "drawn")
    names = ["blocker", "finisher", "platen"]
    heights = {name: [m["tools"][i][1] for m in moments if m["time"] in (0, 1, 2, 3)] for i, name in enumerate(names)}
    assert heights["platen"] == pytest.approx([0, -18, 60, 60])
    assert heights["blocker"] == pytest.approx([0, 0, -60, 0])
    assert heights["finisher"] == pytest.approx([0, 0, 0, -60])


def test_rolls_turn_and_tools_come_to_a_touch(tmp_path: Path) -> None:
    rolled = plan(copy_example("strip_rolling", tmp_path), tmp_path / "rolled")
    turns = [tool[2] for tool in rolled[-1]["tools"]]
    assert np.degrees(max(turns)) == pytest.approx(19.5)
    disc = plan(copy_example("hot_disc", tmp_path), tmp_path / "disc")
    places = sorted(tool[1] for tool in disc[-1]["tools"])
    assert places == pytest.approx([-50.0, 17.0], abs=1e-3), "after 13 mm of upsetting a boss at 60 touches at 17"


def test_tools_that_pass_each_other_or_their_mirror_plane_clash(tmp_path: Path) -> None:
    path = copy_example("forging_flash", tmp_path)
    deep = path.with_name("deep.toml")
    deep.write_text(path.read_text("utf-8").replace("stroke = 5.6", "stroke = 7.6"), "utf-8")
    folder = tmp_path / "drawn"
    folder.mkdir()
    found = check(deep, folder)
    assert found["problems"]
    assert found["is_drawn"]
    first = next(m for m in json.loads((folder / MOTION).read_text("utf-8"))["moments"] if m["clash"])
    assert first["clash"]["names"] == ["die"]
    assert first["time"] == pytest.approx(6.6 / 7.6, abs=0.06), "the land is 6.6 mm above the parting plane"


def test_a_punch_that_runs_into_a_ring_beside_the_billet_clashes_where_they_meet(tmp_path: Path) -> None:
    """The ring's face is at y = 8, the punch begins at y = 15 and goes 9 mm."""
    path = copy_example("upsetting_q4", tmp_path)
    ring = '[tools.ring]\nprofile = [[20, 8], [40, 8]]\ncontact = "frictionless"\nfree_side = "left"\n\n'
    path.write_text(path.read_text("utf-8").replace("[boundary.axis]", f"{ring}[boundary.axis]"), "utf-8")
    first = next(moment for moment in plan(path, tmp_path / "drawn") if moment["clash"])
    assert first["clash"]["names"] == ["punch", "ring"]
    assert first["time"] == pytest.approx(7.0 / 9.0, abs=0.06)
