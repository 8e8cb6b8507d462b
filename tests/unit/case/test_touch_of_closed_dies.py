# SPDX-License-Identifier: Apache-2.0
"""A die that is drawn where it closes, through the workpiece, is placed where its cavity touches the workpiece."""

from __future__ import annotations

import pytest

from presswork.case import build_model
from tests.unit.case.test_resistance import AXIS, plane_case


@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("up", [1.0, -1.0])
def test_a_die_drawn_closed_is_placed_in_touch(up: float, turned: bool, analysis: str) -> None:
    """A billet of 20 mm between y = -5 and 15 stands in one cavity of depth 5 mm; the other one moves on it."""
    cavity = [[-1, 5 * up], [6, 5 * up], [6.5, up], [30, up]]
    other = [[-1, -5 * up], [6, -5 * up], [6.5, -up], [30, -up]]
    moving = {"profile": cavity[::-1] if turned else cavity, "contact": "sticking", "position": "touch"}
    mesh = {"size": [5, 20], "cells": [2, 8], "origin": [0, -5 if up > 0 else -15]}
    model = build_model(
        plane_case(
            {"moving": moving, "standing": {"profile": other, "contact": "sticking"}},
            AXIS,
            {"moving": {"stroke": 10, "direction": [0, -up]}},
            analysis=analysis,
            workpiece={"material": "steel", "mesh": mesh},
            limits={"stop": False},
        )
    )
    assert model.tools[0].position[:2] == pytest.approx((0.0, 10.0 * up), abs=1e-6)
