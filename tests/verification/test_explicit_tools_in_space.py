# SPDX-License-Identifier: Apache-2.0
"""Explicit solids in space between planes that stand askew and tools that turn, are pushed or rest on springs.

Against the implicit procedure, against axisymmetry, and sectors against the whole body.
"""

from __future__ import annotations

import copy
import itertools
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case.errors import CaseError
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.process.begin import begin
from tests.problems import sectors
from tests.regression.whole_runs import compare_with_restart

Data = dict[str, Any]
STEEL = {
    "young": 200e3, "poisson": 0.3, "density": "7850 kg/m^3",
    "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26},
}  # fmt: skip
BLOCK: Data = {
    "title": "a block is upset",
    "analysis": "solid",
    "workpiece": {"material": "steel", "mesh": {"size": [10, 10, 7.5], "cells": [4, 4, 4]}},
    "materials": {"steel": STEEL},
    "tools": {
        "die": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 7.5], "contact": "coulomb", "mu": 0.1}
    },
    "boundary": {
        "x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}, "z": {"set": "back", "fix": ["z"]},
    },
    "stages": [{"name": "press", "duration": "1 ms", "tools": {"die": {"stroke": 3, "direction": [0, 0, -1]}}}],
    "output": {"steps": 1},
}  # fmt: skip
DISC: Data = copy.deepcopy(BLOCK) | {
    "workpiece": {
        "material": "steel",
        "mesh": {"kind": "cylinder", "radius": 10, "height": 8, "angle": 360, "cells": [3, 8, 3]},
    },
    "tools": {
        "die": {
            "shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "axis": [0, 0, 1],
            "contact": "coulomb", "mu": 0.3,
        }
    },
    "boundary": {"base": {"set": "back", "fix": ["x", "y", "z"]}},
    "stages": [
        {"name": "twist", "duration": "1 ms", "tools": {"die": {"stroke": 0.4, "direction": [0, 0, -1], "turn": 40}}}
    ],
}  # fmt: skip


def to_explicit(case: Data, **explicit: Any) -> Data:
    changes = {"procedure": "explicit", "output": {"steps": 1, "rows": 20}}
    return copy.deepcopy(case) | changes | {"explicit": {"target_step": "0.4 us", **explicit}}


def run(case: Data, kind: Any = SpaceCase) -> tuple[Any, list[Data]]:
    taken = begin(build_model(kind(**case)), threads=1)
    return taken, [taken.row(report) for report in taken.advance()]


def compare_forces(slow: list[Data], fast: list[Data], quantity: str = "die.force", by: str = "die.stroke") -> Any:
    """Return the ratio of what explicit rows and implicit increments have, from the middle to 9/10 of the way."""
    x, y = (np.array([row[name] for row in slow]) for name in (by, quantity))
    rows = list(itertools.pairwise(fast[9:18]))
    return np.array([row[quantity] / np.interp(0.5 * (before[by] + row[by]), x, y) for before, row in rows])


def test_a_sector_between_planes_askew_is_upset_as_in_axisymmetry() -> None:
    friction = {"contact": "coulomb", "mu": 0.1}
    flat, space = sectors.upsetting(50.0, (6, 6, 8), friction, stroke=6.0)
    ends = []
    for case, kind in ((flat, Case), (space, SpaceCase)):
        case["materials"] = {"steel": STEEL}
        case["stages"][0]["duration"] = "1 ms"
        case["workpiece"]["element"] = "quad4_1pt" if kind is Case else "hex8_1pt"
        ends.append(run(to_explicit(case), kind))
    (_, one), (sector, other) = ends
    ratio = np.array([b["punch.force"] / a["punch.force"] for a, b in zip(one[4:18], other[4:18], strict=True)])
    np.testing.assert_allclose(ratio, 1.0, atol=0.01)
    x, start = sector.solids.position, sector.model.mesh.points
    assert np.hypot(x[:, 0], x[:, 1]).max() == pytest.approx(one[-1]["x_max"], rel=0.005)
    on_plane = sector.model.mesh.node_sets["last_plane"]
    normal = np.array([-np.sin(np.radians(50.0)), np.cos(np.radians(50.0)), 0.0])
    assert np.abs(x[on_plane] @ normal).max() < 1e-9
    assert np.abs((x - start)[on_plane]).max() > 1.0
    assert abs(other[-1]["energy_error_percent"]) < 0.5


def test_a_tool_that_turns_twists_a_disc_as_in_the_implicit_procedure() -> None:
    case = copy.deepcopy(DISC)
    case["workpiece"]["element"] = "hex8_fbar"
    slow = run(case)[1]
    fast, rows = run(to_explicit(case))
    np.testing.assert_allclose(compare_forces(slow, rows), 1.0, atol=0.02)
    np.testing.assert_allclose(compare_forces(slow, rows, "die.torque", "die.angle"), 1.0, atol=0.02)
    assert rows[-1]["die.angle"] == pytest.approx(40.0, rel=1e-9)
    assert abs(rows[-1]["energy_error_percent"]) < 0.5
    np.testing.assert_allclose(fast.snapshot().tool_rotation["die"], [0.0, 0.0, np.radians(40.0)], atol=1e-9)


@pytest.mark.parametrize(("angle", "around"), [(90, 2), (180, 4)])
def test_a_cyclic_sector_moves_as_the_whole_does(angle: int, around: int) -> None:
    whole, all_rows = run(to_explicit(DISC))
    case = to_explicit(DISC)
    case["workpiece"]["mesh"] |= {"angle": angle, "cells": [3, around, 3]}
    case["boundary"]["cut"] = {"set": "last_plane", "cyclic": "first_plane"}
    sector, rows = run(case)
    start, there = sector.model.mesh.points, whole.model.mesh.points
    same = [np.argmin(np.linalg.norm(there - x, axis=1)) for x in start]
    np.testing.assert_allclose(sector.solids.position, whole.solids.position[same], atol=1e-8)
    for name in ("die.force", "die.torque", "internal_energy"):
        share = 360 / angle if name == "internal_energy" else 1.0
        assert share * rows[-1][name] == pytest.approx(all_rows[-1][name], rel=1e-7)


def test_a_tool_that_is_turned_at_the_start_is_that_tool() -> None:
    plain = run(to_explicit(BLOCK))[1]
    case = to_explicit(BLOCK)
    case["tools"]["die"] |= {"normal": [0, 1, 0], "rotation": {"axis": [1, 0, 0], "angle": -90}}
    turned = run(case)[1]
    assert [row["die.force"] for row in turned] == pytest.approx([row["die.force"] for row in plain], rel=1e-6)


@pytest.mark.parametrize("boundary", [BLOCK["boundary"], sectors.PLANES])
def test_a_force_pushes_a_tool_as_far_as_in_the_implicit_procedure(boundary: Data) -> None:
    """Of a block and of a sector; the force is that on the whole tool."""
    case = copy.deepcopy(BLOCK)
    whole = 1.0
    if boundary is sectors.PLANES:
        case["workpiece"]["mesh"] = {"kind": "cylinder", "radius": 10, "height": 7.5, "angle": 45, "cells": [4, 4, 4]}
        case["boundary"], whole = boundary, 3.0
    case["stages"][0]["tools"]["die"] = {"force": 0.25e6 * whole, "direction": [0, 0, -1]}
    slow = run(case)[1]
    rows = run(to_explicit(case, damping=5e3, target_step="0.1 us"))[1]
    forces, ways = (np.array([row[f"die.{name}"] for row in slow]) for name in ("force", "stroke"))
    assert slow[-1]["die.force"] == pytest.approx(0.25e6 * whole, rel=1e-6)
    for time in (0.6, 0.75, 0.9):
        stroke = np.interp(1e-3 * time, [row["time"] for row in rows], [row["die.stroke"] for row in rows])
        assert np.interp(stroke, ways, forces) == pytest.approx(0.25e6 * whole * time, rel=0.02)
    assert rows[-1]["die.force"] == pytest.approx(0.975 * 0.25e6 * whole, rel=0.02)  # mean of the last row
    assert abs(rows[-1]["energy_error_percent"]) < 0.5


def test_a_spring_gives_way_as_in_the_implicit_procedure() -> None:
    case = copy.deepcopy(BLOCK)
    del case["boundary"]["z"]
    spring = {"stiffness": 4e5, "preload": 1e5, "direction": [0, 0, -1]}
    case["tools"]["low"] = {"shape": "plane", "normal": [0, 0, 1], "contact": "coulomb", "mu": 0.1, "spring": spring}
    slow, rows = run(case)[1], run(to_explicit(case))[1]
    np.testing.assert_allclose(compare_forces(slow, rows), 1.0, atol=0.02)
    np.testing.assert_allclose(compare_forces(slow, rows, "low.force"), 1.0, atol=0.02)
    at_rest = [row for row in rows if row["low.force"] < 0.9e5]
    assert at_rest
    assert all(row["low.stroke"] < 1e-6 for row in at_rest[:-1])
    assert rows[14]["low.stroke"] == pytest.approx((rows[14]["low.force"] - 1e5) / 4e5, rel=0.05)


def test_nothing_slides_on_a_tool_that_sticks() -> None:
    case = copy.deepcopy(BLOCK)
    case["workpiece"]["element"] = "hex8_fbar"
    case["tools"]["die"] = {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 7.5], "contact": "sticking"}
    slow, (fast, rows) = run(case)[1], run(to_explicit(case))
    np.testing.assert_allclose(compare_forces(slow, rows), 1.0, atol=0.03)
    top = np.flatnonzero(fast.model.mesh.points[:, 2] == 7.5)
    moved = (fast.solids.position - fast.model.mesh.points)[top]
    assert np.abs(moved[:, :2]).max() < 1e-3
    assert rows[-1]["friction_energy"] == pytest.approx(0.0, abs=1e-4 * rows[-1]["internal_energy"])


def test_a_second_stage_puts_the_tool_where_it_touches() -> None:
    case = to_explicit(BLOCK)
    away, again = {"move": [0, 0, 5]}, {"stroke": 1, "direction": [0, 0, -1], "position": "touch"}
    first = case["stages"][0] | {"tools": {"die": {"stroke": 2, "direction": [0, 0, -1]}}}
    case["stages"] = [
        first,
        {"name": "up", "duration": "0.2 ms", "tools": {"die": away}},
        {"name": "again", "duration": "0.5 ms", "tools": {"die": again}},
    ]
    taken, rows = run(case)
    ends = [rows[i]["z_max"] for i in (19, 39, 59)]
    assert ends[0] == pytest.approx(5.5, abs=1e-3)
    assert ends[1] == pytest.approx(ends[0], abs=0.05)  # it springs back
    assert ends[2] == pytest.approx(ends[1] - 1.0, abs=0.02)
    assert rows[-1]["die.stroke"] == pytest.approx(1.0, abs=1e-6)
    assert rows[41]["die.force"] > 0.0
    case["stages"][2]["tools"]["die"]["position"] = [0, 0, 3]
    with pytest.raises(Exception, match=r"is put .* mm into the workpiece when its stage begins"):
        run(case)
    assert taken.walls[0].displacement[2] == pytest.approx(ends[2] - 7.5, abs=0.02)


MOVED: Data = {
    "turned": {"die": {"stroke": 0.4, "direction": [0, 0, -1], "turn": 10}},
    "pushed": {"die": {"force": 2e5, "direction": [0, 0, -1]}},
}


@pytest.mark.parametrize("threads", [2, 3])
@pytest.mark.parametrize("motion", MOVED)
def test_any_number_of_threads_and_a_restart_give_the_same_bits(motion: str, threads: int) -> None:
    """A sector with cyclic faces whose die turns or is pushed, on a lower one that rests on a spring."""
    case = to_explicit(DISC)
    case["workpiece"]["mesh"] |= {"angle": 90, "cells": [8, 12, 8]}
    case["boundary"] = {"cut": {"set": "last_plane", "cyclic": "first_plane"}}
    spring = {"stiffness": 4e5, "preload": 1e3, "direction": [0, 0, -1]}
    case["tools"]["low"] = {"shape": "plane", "normal": [0, 0, 1], "contact": "coulomb", "mu": 0.1, "spring": spring}
    case["stages"][0] |= {"duration": "20 us", "tools": MOVED[motion]}
    case["explicit"] = {}
    case["output"] = {"steps": 1, "rows": 4}
    one = compare_with_restart(build_model(SpaceCase(**case)), 2, threads)
    assert np.abs(one["walls.floating.1"]).max() > 0.0


def test_what_the_explicit_procedure_cannot_do_in_space_is_refused() -> None:
    case = to_explicit(BLOCK)
    case["stages"][0]["force"] = [{"set": "front", "value": [0, 0, 1]}]
    with pytest.raises(CaseError, match=r"stages\.0\.force: the explicit procedure has tools"):
        build_model(SpaceCase(**case))
