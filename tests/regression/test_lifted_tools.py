# SPDX-License-Identifier: Apache-2.0
"""A punch that rises from a billet which nothing but two tools holds: the billet stays on the die that stands."""

from __future__ import annotations

from typing import Any

import pytest

from presswork import build_model
from presswork.case import Case
from presswork.case.space.schema import SpaceCase
from presswork.implicit.remedy import find_remedy
from presswork.implicit.stepping import ImplicitProcedure

HEIGHT, STROKE = 15.0, 3.0
LAWS: dict[str, dict[str, Any]] = {
    "frictionless": {"contact": "frictionless"},
    "sticking": {"contact": "sticking"},
    "coulomb": {"contact": "coulomb", "mu": 0.15},
    "shear": {"contact": "shear", "m": 0.3},
}


def billet(law: str, element: str, faster: str) -> Case:
    """A billet between two flat tools; the faster one leaves it, the other stands or goes half as fast."""
    way = {"upper": [0, 1], "lower": [0, -1]}
    slower = "lower" if faster == "upper" else "upper"
    return Case.model_validate(
        {
            "title": "billet between two tools",
            "analysis": "axisymmetric",
            "workpiece": {"material": "steel", "element": element, "mesh": {"size": [5.0, HEIGHT], "cells": [4, 9]}},
            "materials": {
                "steel": {
                    "young": 100000.0,
                    "poisson": 0.3,
                    "hardening": {"law": "swift", "K": 200.0, "e0": 0.01, "n": 0.2},
                }
            },
            "boundary": {"axis": {"set": "left", "fix": ["x"]}},
            "tools": {
                "upper": {"profile": [[0, HEIGHT], [20, HEIGHT]], **LAWS[law]},
                "lower": {"profile": [[20, 0], [0, 0]], **LAWS[law]},
            },
            "stages": [
                {"name": "upset", "tools": {"upper": {"stroke": STROKE, "direction": [0, -1]}}},
                {
                    "name": "apart",
                    "tools": {
                        faster: {"stroke": 6.0, "direction": way[faster]},
                        slower: {"stroke": 0.0 if faster == "upper" else 2.0, "direction": way[slower]},
                    },
                },
            ],
        }
    )


@pytest.mark.parametrize("element", ["quad4_fbar", "quad8", "tri3"])
@pytest.mark.parametrize("law", LAWS)
def test_a_billet_stays_on_the_die_that_stands(law: str, element: str) -> None:
    procedure = ImplicitProcedure(build_model(billet(law, element, "upper")), threads=1)
    for _ in procedure.advance():
        pass
    state = procedure.state
    height = (procedure.model.mesh.points + state.nodes.displacement)[:, 1]
    spring_back = height.max() - (HEIGHT - STROKE)
    assert height.min() == pytest.approx(0.0, abs=1e-4)
    assert 0.0 < spring_back < 0.01 * HEIGHT


def test_a_billet_goes_with_the_slower_of_two_tools_that_leave_it() -> None:
    procedure = ImplicitProcedure(build_model(billet("shear", "quad4_fbar", "lower")), threads=1)
    for _ in procedure.advance():
        pass
    height = (procedure.model.mesh.points + procedure.state.nodes.displacement)[:, 1]
    assert height.max() == pytest.approx(HEIGHT - STROKE + 2.0, abs=1e-4)


def block(law: str, element: str, *, lower: float) -> dict[str, Any]:
    """A quarter of a block between two planes in space; the upper one leaves it by 6 mm, the other by `lower`."""
    box = {"kind": "box", "size": [5, 5, HEIGHT], "cells": [2, 2, 5]}
    steel = {"young": 1e5, "poisson": 0.3, "hardening": {"law": "swift", "K": 200.0, "e0": 0.01, "n": 0.2}}
    planes = {"upper": ([0, 0, -1], HEIGHT), "lower": ([0, 0, 1], 0.0)}
    return {
        "title": "block between two tools",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": box, "element": element},
        "materials": {"steel": steel},
        "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}},
        "tools": {
            name: {"shape": "plane", "normal": normal, "position": [0, 0, z], **LAWS[law]}
            for name, (normal, z) in planes.items()
        },
        "stages": [
            {"name": "press", "tools": {"upper": {"stroke": STROKE, "direction": [0, 0, -1]}}},
            {
                "name": "apart",
                "tools": {
                    "upper": {"stroke": 6.0, "direction": [0, 0, 1]},
                    "lower": {"stroke": lower, "direction": [0, 0, -1]},
                },
            },
        ],
    }


@pytest.mark.parametrize(
    ("law", "element"),
    [("frictionless", "hex8_fbar"), ("sticking", "hex8_fbar"), ("coulomb", "hex8_fbar"), ("shear", "tet4_mini")],
)
@pytest.mark.parametrize("lower", [0.0, 2.0])
def test_a_block_in_space_stays_on_the_die_that_stands_or_leaves_it_slower(
    law: str, element: str, lower: float
) -> None:
    """Within 3 micrometres, what the nodes' springs of contact leave."""
    data = block(law, element, lower=lower)
    procedure = ImplicitProcedure(build_model(SpaceCase.model_validate(data)), threads=1)
    for _ in procedure.advance():
        pass
    height = (procedure.model.mesh.points + procedure.state.nodes.displacement[:, :3])[:, 2] + lower
    assert height.min() == pytest.approx(0.0, abs=3e-3)
    assert 0.0 < height.max() - (HEIGHT - STROKE) < 0.01 * HEIGHT


def test_a_body_that_only_tools_hold_is_told_so() -> None:
    """The remedy of a run that gives up names the axes along which nothing but tools holds the body."""
    box = {"kind": "box", "size": [10, 10, 16], "cells": [2, 2, 2]}
    steel = {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 500}}
    data: dict[str, Any] = {
        "title": "block between tools",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": box},
        "materials": {"steel": steel},
        "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}},
        "tools": {"upper": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 16], "contact": "frictionless"},
                  "lower": {"shape": "plane", "normal": [0, 0, 1], "position": [0, 0, 0], "contact": "frictionless"}},
        "stages": [{"name": "press", "tools": {"upper": {"stroke": 1, "direction": [0, 0, -1]}}}],
    }  # fmt: skip
    assert "Only tools hold the body along y" in find_remedy(build_model(billet("shear", "quad8", "upper")), 0)
    told = find_remedy(build_model(SpaceCase.model_validate(data)), 0)
    assert "Only tools hold the body along z" in told
    assert "solver.inertia = 1" in told
    held = data["boundary"] | {"z": {"set": "back", "fix": ["z"]}}
    assert "Only tools" not in find_remedy(build_model(SpaceCase.model_validate({**data, "boundary": held})), 0)
