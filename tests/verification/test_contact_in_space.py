# SPDX-License-Identifier: Apache-2.0
"""Solids in space under rigid tools: against closed forms, and a slice of them against plane strain."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.process.tool_quantities import measure_tools

STEEL = {"young": 200e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}
FLAT = [[0, 10], [40, 10]]
ROUNDED = [[0, 10], {"to": [8, 10], "radius": 3}, [10, 14], [40, 14]]


def press(case: Case | SpaceCase) -> tuple[np.ndarray, np.ndarray]:
    """Return the force of the whole die [N] and the points at the end, of every increment and the last one."""
    procedure = ImplicitProcedure(build_model(case))
    ways, forces = [], []
    for report in procedure.advance():
        ways.append(report.fraction)
        forces.append(measure_tools(procedure, 0)["die"].force)
    at = np.linspace(0.2, 1.0, 5)
    return np.interp(at, ways, forces), procedure.model.mesh.points + procedure.state.nodes.displacement


def in_space(cells: list[int], size: list[float], die: dict[str, Any], fixed: dict[str, str], stroke: float) -> Any:
    return SpaceCase.model_validate(
        {
            "title": "pressed",
            "analysis": "solid",
            "workpiece": {"material": "steel", "mesh": {"size": size, "cells": cells}},
            "materials": {"steel": STEEL},
            "tools": {"die": die},
            "boundary": {name: {"set": name, "fix": [axis]} for name, axis in fixed.items()},
            "stages": [{"name": "press", "tools": {"die": {"stroke": stroke, "direction": [0, 0, -1]}}}],
        }
    )


def in_plane(cells: list[int], die: dict[str, Any], stroke: float) -> Any:
    return Case.model_validate(
        {
            "title": "pressed",
            "analysis": "plane_strain",
            "workpiece": {"material": "steel", "mesh": {"size": [15, 10], "cells": cells}},
            "materials": {"steel": STEEL},
            "tools": {"die": die},
            "boundary": {"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
            "stages": [{"name": "press", "tools": {"die": {"stroke": stroke, "direction": [0, -1]}}}],
        }
    )


def test_a_block_between_smooth_tools_stays_a_block() -> None:
    """Uniaxial compression to half the height: the force is the flow stress on the area that volume leaves."""
    die = {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "contact": "frictionless"}
    fixed = {"left": "x", "bottom": "y", "back": "z"}
    force, points = press(in_space([2, 2, 2], [10, 10, 8], die, fixed, 4.0))
    elastic = 565 * (0.007 + np.log(2.0)) ** 0.26 / 200e3
    flow = 565 * (0.007 + np.log(2.0) - elastic) ** 0.26
    assert force[-1] == pytest.approx(4 * 200 * (1 - 0.4 * elastic) * flow, rel=2e-4)
    assert np.ptp(points[points[:, 0] > 13.0][:, 0]) < 1e-3


@pytest.mark.parametrize(
    ("profile", "law", "off"),
    [
        (FLAT, {"contact": "shear", "m": 0.2}, 2e-3),
        (FLAT, {"contact": "coulomb", "mu": 0.1}, 2e-3),
        (ROUNDED, {"contact": "frictionless"}, 5e-3),
    ],
    ids=["shear", "coulomb", "rounded"],
)
def test_a_slice_in_space_is_plane_strain(profile: Any, law: dict[str, Any], off: float) -> None:
    """The same cells with exact contact in the plane: forces on the way to 30 %, the shape to 0.5 % of its height.

    Beyond that the side rolls over onto the tool, and a node that comes to it an increment earlier moves the force.
    """
    fixed = {"left": "x", "bottom": "y", "top": "y", "back": "z"}
    space, points = press(
        in_space([15, 1, 10], [15, 1, 10], {"shape": "straight", "profile": profile, **law}, fixed, 3.0)
    )
    plane, own = press(in_plane([15, 10], {"profile": profile, **law}, 3.0))
    np.testing.assert_allclose(space, plane, rtol=off)
    front = points[points[:, 1] < 1e-9][:, [0, 2]]
    nearest = np.linalg.norm(front[:, None] - own[None], axis=2).min(axis=1)
    assert nearest.max() < 0.05


def test_stiff_metal_takes_as_many_rounds_of_multipliers_as_it_needs() -> None:
    """An elastic block in one increment: every round leaves a part of the penetration, and none is cut back for it."""
    die = {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "contact": "frictionless"}
    case = in_space([3, 3, 3], [10, 10, 8], die, {"left": "x", "bottom": "y", "back": "z"}, 0.4)
    hardening = {"law": "linear", "yield_stress": 5e6}
    steel = {"young": 200e3, "poisson": 0.3, "magnitudes": "any", "hardening": hardening}
    data = case.model_dump(exclude_unset=True) | {"materials": {"steel": steel}}
    data["solver"] = {"initial_increment": 1.0, "max_increment": 1.0}
    procedure = ImplicitProcedure(build_model(SpaceCase.model_validate(data)))
    report = next(procedure.advance())
    assert len(report.log.augmented) >= 3
    assert not report.cutbacks
    strain = -np.log(0.95)
    exact = 400.0 * np.exp(0.6 * strain) * 200e3 * strain
    assert measure_tools(procedure, 0)["die"].force == pytest.approx(exact, rel=2e-3)
