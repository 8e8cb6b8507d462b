# SPDX-License-Identifier: Apache-2.0
"""Sectors of bodies whose n parts are the same by turning and not by mirrors, against the whole body."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case.errors import CaseError
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray
from presswork.process.begin import begin

WHOLE: dict[str, Any] = {
    "title": "a disc is pressed and twisted",
    "analysis": "solid",
    "workpiece": {
        "material": "steel",
        "mesh": {"kind": "cylinder", "radius": 10, "height": 8, "angle": 360, "cells": [3, 8, 3]},
    },
    "materials": {
        "steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 700, "e0": 0.01, "n": 0.2}}
    },
    "tools": {
        "die": {
            "shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "axis": [0, 0, 1],
            "contact": "coulomb", "mu": 0.3,
        }
    },
    "boundary": {"base": {"set": "back", "fix": ["x", "y", "z"]}},
    "stages": [{"name": "twist", "tools": {"die": {"stroke": 0.4, "direction": [0, 0, -1], "turn": 40}}}],
    "solver": {"max_increment": 0.25, "initial_increment": 0.25},
}  # fmt: skip


def cut(angle: int, around: int) -> dict[str, Any]:
    case = copy.deepcopy(WHOLE)
    case["workpiece"]["mesh"] |= {"angle": angle, "cells": [3, around, 3]}
    case["boundary"]["cut"] = {"set": "last_plane", "cyclic": "first_plane"}
    return case


def run(case: dict[str, Any]) -> tuple[FloatArray, FloatArray, dict[str, Any]]:
    """Return where the nodes began and where they ended, and the last row of the history."""
    taken = begin(build_model(SpaceCase(**case)), threads=1)
    rows = [taken.row(report) for report in taken.advance()]
    procedure = taken.procedure  # type: ignore[attr-defined]
    assert isinstance(procedure, ImplicitProcedure)
    start = procedure.model.mesh.points
    return start, start + procedure.state.nodes.displacement, rows[-1]


@pytest.fixture(scope="module")
def whole() -> tuple[FloatArray, FloatArray, dict[str, Any]]:
    return run(WHOLE)


@pytest.mark.parametrize(("angle", "around"), [(90, 2), (180, 4)])
def test_a_sector_that_is_twisted_moves_as_the_whole_does(angle: int, around: int, whole: Any) -> None:
    start, end, row = run(cut(angle, around))
    all_start, all_end, all_row = whole
    same = np.array([np.argmin(np.linalg.norm(all_start - x, axis=1)) for x in start])
    np.testing.assert_allclose(all_start[same], start, atol=1e-9)
    np.testing.assert_allclose(end, all_end[same], atol=1e-3)
    assert row["die.force"] == pytest.approx(all_row["die.force"], rel=1e-4)
    assert row["die.torque"] == pytest.approx(all_row["die.torque"], rel=1e-4)
    assert row["die.force_x"] == row["die.force_y"] == 0.0


def test_the_two_faces_move_alike() -> None:
    start, end, _ = run(cut(90, 2))
    first = np.flatnonzero((np.abs(start[:, 1]) < 1e-9) & (start[:, 0] > 1e-9))
    turned = end[first] @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    for x, there in zip(start[first], turned, strict=True):
        partner = np.argmin(np.linalg.norm(start - [0.0, x[0], x[2]], axis=1))
        np.testing.assert_allclose(end[partner], there, atol=1e-4)
    assert np.abs(end[first, 1]).max() > 0.3  # they do not stay flat


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"angle": 100, "cells": [3, 4, 3]}, "spans 100 degrees, no n-th part of a whole turn"),
        ({"angle": 360, "cells": [3, 8, 3]}, "no such|first_plane"),
    ],
)
def test_sectors_that_make_no_whole_are_refused(change: dict[str, Any], told: str) -> None:
    case = cut(90, 2)
    case["workpiece"]["mesh"] |= change
    with pytest.raises(CaseError, match=told):
        build_model(SpaceCase(**case))


def test_mirrors_beside_a_cyclic_sector_and_heat_are_refused() -> None:
    case = cut(90, 2)
    case["boundary"]["mirror"] = {"set": "first_plane", "fix": ["y"]}
    with pytest.raises(CaseError, match="planes of symmetry along z too"):
        build_model(SpaceCase(**case))
    with pytest.raises(CaseError, match="give either fix or cyclic"):
        SpaceCase(**(WHOLE | {"boundary": {"base": {"set": "back"}}}))
