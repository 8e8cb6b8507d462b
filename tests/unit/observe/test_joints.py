# SPDX-License-Identifier: Apache-2.0
"""A joint of two sheets whose sizes are drawn: interlock, neck and bottom; and what cannot be one."""

import copy
import tomllib
from importlib.resources import files

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.case.errors import CaseError
from presswork.observe.joints import measure_joint

UPPER_FACE = [[0, -0.9], [3.0, -0.9], [3.2, -0.7], [3.2, -0.5], [3.05, 0.0], [3.05, 0.7], [3.5, 1.0], [8, 1.0]]
UPPER_BACK = [[8, 2.0], [3.5, 2.0], [2.7, 1.5], [2.6, -0.6], [0, -0.6]]
LOWER_FACE = [[0, -1.2], [3.9, -1.5], [4.0, -0.2], [4.2, 0.0], [8, 0.0]]


def refine(line):
    """Divide each side of a line by ten."""
    line = np.array(line, dtype=float)
    parts = [line[i] + np.arange(10)[:, None] / 10 * (line[i + 1] - line[i]) for i in range(len(line) - 1)]
    return np.concatenate([*parts, line[-1:]])


UPPER = np.concatenate([refine(UPPER_FACE), refine(UPPER_BACK)])
LOWER = np.concatenate([refine(LOWER_FACE), refine(UPPER_FACE)[::-1]])


@pytest.mark.parametrize("turn", [0, 7, 61])
@pytest.mark.parametrize("below", [False, True])
def test_a_joint_has_the_sizes_that_are_drawn(turn, below):
    """The face goes out to 3.2 mm and back to 3.05 mm; the wall is thinnest there."""
    outlines = [np.roll(UPPER, turn, axis=0), np.roll(LOWER, turn, axis=0)]
    if below:
        outlines = [(outline * (1.0, -1.0))[::-1] for outline in outlines]
    joint = measure_joint(*outlines)
    assert joint.interlock == pytest.approx(0.15)
    assert joint.bottom == pytest.approx(0.6)
    assert joint.neck == pytest.approx((3.05 - 2.6 - 0.1 * 1.29 / 2.1) / np.hypot(1, 0.1 / 2.1), abs=0.003)


def test_flat_sheets_have_no_interlock():
    upper = np.array([[0, 1.0], [8, 1], [8.001, 2], [0, 2]])
    lower = upper - (0, 1)
    joint = measure_joint(refine([*upper, upper[0]])[:-1], refine([*lower, lower[0]])[:-1])
    assert (joint.interlock, joint.bottom, joint.neck) == pytest.approx((0.0, 2.0, 1.0))


def refused(**changes):
    data = tomllib.loads((files("presswork") / "examples" / "clinching.toml").read_text("utf-8"))
    data = copy.deepcopy(data) | changes
    with pytest.raises(CaseError) as caught:
        build_model(Case(**data))
    return {problem.key: problem.expected for problem in caught.value.problems}


def test_a_joint_is_measured_in_axisymmetry_and_on_the_axis():
    assert "in axisymmetry" in refused(analysis="plane_strain")["contacts.sheets.joint"]
    ring = {"material": "steel", "mesh": {"origin": [1, 0], "size": [6, 1], "cells": [48, 8]}}
    assert "on the axis" in refused(bodies={"lower": ring})["contacts.sheets.joint"]
    itself = {"between": ["lower", "lower"], "contact": "frictionless", "joint": True}
    both = {"sheets": {"between": ["workpiece", "lower"], "contact": "frictionless"}, "fold": itself}
    assert "between two bodies" in refused(contacts=both)["contacts.fold.joint"]
