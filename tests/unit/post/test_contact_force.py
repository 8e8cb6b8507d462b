# SPDX-License-Identifier: Apache-2.0
"""The tool force by integration of the contact traction is the reaction in the history."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, Result, run
from presswork.model import ElementName
from presswork.post import integrate_contact_force
from presswork.results import ResultError

ELEMENTS = [
    "tri3", "tri6_6pt", "tri6_7pt", "quad4", "quad4_fbar", "quad4_1pt", "quad8", "quad8_2x2", "quad9", "quad9_2x2",
]  # fmt: skip
ANALYSES = ("axisymmetric", "plane_strain")
FLAT = [[-1, 15], [30, 15]]
CURVED = [{"to": [-40, 55]}, {"to": [40, 55], "centre": [0, 55], "turn": "left"}]
FRICTION = {
    "frictionless": {"contact": "frictionless"},
    "sticking": {"contact": "sticking"},
    "shear": {"contact": "shear", "m": 0.3},
    "coulomb": {"contact": "coulomb", "mu": 0.15},
}


def press(folder: Path, element: str, analysis: str, profile: object, law: str, **changes: object) -> Result:
    """Press the quarter of a billet by 3 mm; its side touches nothing."""
    case = {
        "title": "press",
        "analysis": analysis,
        "workpiece": {"material": "steel", "element": element, "mesh": {"size": [10, 15], "cells": [5, 6]}},
        "materials": {
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
            }
        },
        "tools": {"punch": {"profile": profile, **FRICTION[law]}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "press", "tools": {"punch": {"move": [0, -3]}}}],
        "output": {"steps": 4},
    }
    if analysis == "plane_strain":
        case["depth"] = 7.0
    outcome = run(Case(**{**case, **changes}), folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def assert_forces_agree(result: Result, tolerance: float = 1e-6) -> None:
    history = result.history
    for tool in result.tools:
        for step, time in list(enumerate(result.times))[1:]:
            row = int(np.argmin(np.abs(history["time"] - time)))
            reaction = np.array([history[f"{tool}.force_x"][row], history[f"{tool}.force_y"][row]])
            force = integrate_contact_force(result, tool, step)
            np.testing.assert_allclose(force, reaction, rtol=0, atol=tolerance * np.linalg.norm(reaction))
            assert np.linalg.norm(reaction) > 0


def assert_surface_carries(result: Result) -> None:
    """No node has more shear than the metal's k there, or pulls; k is taken from the cells round the node."""
    nodes = np.concatenate([block.connectivity.ravel() for block in result.mesh.blocks])
    per_cell = result.mesh.blocks[0].connectivity.shape[1]
    for step in range(1, len(result.times)):
        flow = 700 + 300 * result.field("equivalent_plastic_strain", step)
        count = np.bincount(nodes)
        k = np.bincount(nodes, np.repeat(flow, per_cell)) / np.maximum(count, 1) / np.sqrt(3)
        assert (np.abs(result.field("contact_shear", step)) <= 1.02 * k).all()
        assert result.field("contact_pressure", step).min() >= 0.0


@pytest.mark.parametrize(
    ("profile", "law", "analysis", "element"),
    [
        *((CURVED, "shear", "axisymmetric", element) for element in ELEMENTS),
        *((CURVED, "shear", "plane_strain", element) for element in ("tri3", "tri6_7pt", "quad4", "quad8", "quad9")),
        *((FLAT, "sticking", analysis, element) for analysis in ANALYSES for element in ("tri3", "quad8_2x2")),
    ],
)
def test_integrated_traction_is_the_reaction(
    tmp_path: Path, element: ElementName, analysis: str, profile: object, law: str
) -> None:
    result = press(tmp_path / "out", element, analysis, profile, law)
    assert_forces_agree(result)
    assert_surface_carries(result)
    if analysis == "axisymmetric" and law == "sticking":
        assert integrate_contact_force(result)[0] > 0, "a sticking punch is pulled outwards all round the ring"


@pytest.mark.parametrize("law", ["frictionless", "coulomb"])
def test_integrated_traction_is_the_reaction_under_other_laws(tmp_path: Path, law: str) -> None:
    assert_forces_agree(press(tmp_path / "out", "tri6_7pt", "axisymmetric", CURVED, law))


def test_a_tool_that_a_symmetry_plane_cuts_counts_twice(tmp_path: Path) -> None:
    result = press(tmp_path / "out", "quad4_fbar", "plane_strain", FLAT, "sticking")
    assert result.info["mirrored_x"] == "punch"
    force = integrate_contact_force(result)
    np.testing.assert_allclose(force, [0.0, -2 * result.field("contact_force")[:, 1].sum()], rtol=1e-12)


@pytest.mark.parametrize("element", ["quad4_fbar", "quad8_2x2", "tri6_6pt"])
@pytest.mark.parametrize("split", [True, False], ids=["two tools", "one tool with an inner corner"])
def test_a_corner_node_divides_its_force_between_the_tools(tmp_path: Path, element: str, split: bool) -> None:
    """A block in a container: the corner node is held by wall and floor, of one tool or of two."""
    punch = {"profile": [[-5, 10], [30, 10]], "contact": "frictionless"}
    floor = {"profile": [[-1, 0], [10, 0]], "contact": "frictionless"}
    wall = {"profile": [[10, 0], [10, 20]], "contact": "frictionless", "free_side": "left"}
    container = {"profile": [[-1, 0], [10, 0], [10, 20]], "contact": "frictionless"}
    tools = {"punch": punch, **({"floor": floor, "wall": wall} if split else {"container": container})}
    result = press(
        tmp_path / "out",
        element,
        "plane_strain",
        FLAT,
        "frictionless",
        tools=tools,
        workpiece={"material": "steel", "element": element, "mesh": {"size": [10, 10], "cells": [4, 4]}},
        boundary={"middle": {"set": "left", "fix": ["x"]}},
        stages=[{"name": "press", "tools": {"punch": {"move": [0, -0.05]}}}],
    )
    assert_forces_agree(result)
    pressure = result.field("contact_pressure")
    bottom, right = (result.mesh.points[:, i] == v for i, v in ((1, 0.0), (0, 10.0)))
    stress = result.field("stress")
    floor_nodes = bottom & (result.mesh.points[:, 0] <= 5.0)  # quadratic edges smooth over the corner
    wall_nodes = right & (np.abs(result.mesh.points[:, 1] - 6.0) <= 1.0)
    np.testing.assert_allclose(pressure[floor_nodes], -stress[:, 1].mean(), rtol=1e-6)
    np.testing.assert_allclose(pressure[wall_nodes], -stress[:, 0].mean(), rtol=1e-6)
    corner = pressure[bottom & right][0]
    assert corner == pytest.approx(-0.5 * (stress[:, 0].mean() + stress[:, 1].mean()), rel=0.02)


def test_a_tool_must_be_named_where_there_are_several(tmp_path: Path) -> None:
    result = press(tmp_path / "out", "quad4_fbar", "axisymmetric", FLAT, "sticking")
    with pytest.raises(ResultError, match="has no tool die; name one of: punch"):
        integrate_contact_force(result, "die")


def test_no_contact_gives_no_force(tmp_path: Path) -> None:
    away = {"punch": {"profile": [[-1, 15.5], [30, 15.5]], "contact": "frictionless"}}
    result = press(tmp_path / "out", "quad4_fbar", "axisymmetric", FLAT, "frictionless", tools=away)
    np.testing.assert_array_equal(integrate_contact_force(result, step=0), 0.0)
    np.testing.assert_allclose(np.nanmin(result.field("gap", 0)), 0.5)
    assert result.field("contact_status", 0).max() == 0
