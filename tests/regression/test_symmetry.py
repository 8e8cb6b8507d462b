# SPDX-License-Identifier: Apache-2.0
"""A symmetric process computed as a quarter, as a half and whole: the same forces, draw-in and fields.

In explicit runs the three do the same operations but for the order of sums, so they differ by rounding errors alone:
those of double precision, in which a fault of some 1e-8 would show.
The implicit procedure iterates to a tolerance, which is what its runs differ by.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from presswork import Case, Result
from presswork.case import build_model
from tests.regression.whole_runs import run_stamping, run_to_end

STEEL = {"young": "210 GPa", "poisson": 0.3, "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}
TOOL = {"shape": "rectangular", "mu": 0.144}
CUP: dict[str, Any] = {
    "title": "coarse square cup",
    "analysis": "stamping",
    "procedure": "explicit",
    "blank": {"shape": "rectangle", "size": [100, 100], "thickness": 0.8, "element_size": 8, "material": "steel"},
    "materials": {"steel": STEEL},
    "tools": {
        "punch": {"kind": "punch", "size": [51, 51], "corner_radius": 10, "edge_radius": 4, **TOOL},
        "die": {"kind": "die", "size": [54, 54], "corner_radius": 11.5, "edge_radius": 4, **TOOL},
        "holder": {"kind": "holder", "size": [54, 54], "corner_radius": 11.5, "edge_radius": 1, **TOOL},
    },
    "stages": [{"name": "draw", "velocity": "10 m/s",
                "tools": {"punch": {"stroke": 10}, "holder": {"force": "15 kN"}}}],
    "explicit": {"precision": "double"},
    "output": {"rows": 40, "steps": 1},
    "limits": {"penetration": 5},  # shells as long as this cut into the radii; both sides of the comparison do
}  # fmt: skip
BEADS = [{"points": [[-42, -42], [42, -42], [42, 42], [-42, 42], [-42, -42]], "force": 40}]
CIRCLE = {"shape": "circle", "diameter": 100, "thickness": 0.8, "element_size": 8, "material": "steel"}
OUTLINE = {"shape": "outline", "thickness": 0.8, "element_size": 8, "material": "steel"}
CORNERS = "-50 -30\n-30 -45\n30 -45\n50 -30\n50 30\n30 45\n-30 45\n-50 30\n"


def draw(folder: Path, planes: list[str], blank: dict[str, Any], **changes: Any) -> Result:
    """Draw the cup, cut by symmetry planes."""
    own = {**CUP, **changes}
    if blank.get("shape") == "outline":
        blank = {**blank, "path": str(folder.with_suffix(".txt"))}
        Path(blank["path"]).write_text(CORNERS)
    return run_stamping(own, folder, blank={**({} if "shape" in blank else own["blank"]), **blank, "symmetry": planes})


def largest_difference(whole: Result, part: Result) -> float:
    """Of forces, strokes, displacements and thickness, each over its largest."""
    columns = [name for name in part.history if name.endswith((".force", ".stroke"))]
    pairs = [(whole.history[name], part.history[name]) for name in columns]
    meshes = [result.mesh_at() for result in (whole, part)]
    to_points = cKDTree(meshes[0].points).query(meshes[1].points)
    centres = [mesh.points[block.connectivity].mean(axis=1) for mesh in meshes for block in mesh.blocks]
    to_cells = cKDTree(centres[0]).query(centres[1])
    size = np.abs(meshes[1].points).max()
    assert max(to_points[0].max(), to_cells[0].max()) < 1e-12 * size, "the part's mesh is not that of the whole"
    for name, places in (("displacement", to_points[1]), ("thickness", to_cells[1])):
        pairs.append((whole.field(name)[places], part.field(name)))
    return max(float(np.abs(a - b).max() / (np.abs(a).max() or 1.0)) for a, b in pairs)


@pytest.mark.parametrize(("planes", "blank", "changes"), [
    (["x", "y"], {}, {}),
    (["x"], {}, {}),
    (["y"], {}, {"beads": BEADS}),
    (["x", "y"], {"cells": "triangles"}, {"beads": BEADS}),
    (["x", "y"], {}, {"explicit": {"element": "shell4_mitc_plus", "precision": "double"}}),
    (["x", "y"], CIRCLE, {}),
    (["x", "y"], OUTLINE, {}),
    (["x"], OUTLINE, {}),
    (["x", "y"], {"refine": {"levels": 1}}, {}),
], ids=["quarter", "half", "half with beads", "quarter, triangles and beads", "quarter, fully integrated",
        "circle", "outline", "half outline", "refined"])  # fmt: skip
def test_symmetry_costs_nothing_in_an_explicit_cup(tmp_path: Path, planes, blank, changes) -> None:
    """Shells of 8 mm at 10 m/s, twice as long as the tools' radii: nodes, edges and friction on the planes."""
    whole, part = (draw(tmp_path / str(len(p)), p, blank, **changes) for p in ([], planes))
    assert whole.history["punch.force"].max() > 30e3
    assert largest_difference(whole, part) < 1e-8


def test_a_quarter_in_single_precision_is_the_whole_to_its_rounding(tmp_path: Path) -> None:
    """6e-6 found: a hundred units in the last place."""
    single = {"explicit": {"precision": "single"}}
    whole, part = (draw(tmp_path / str(len(p)), p, {}, **single) for p in ([], ["x", "y"]))
    assert largest_difference(whole, part) < 1e-4


@pytest.mark.parametrize("planes", [["x", "y"], ["y"]])
def test_symmetry_costs_nothing_in_an_implicit_cup(tmp_path: Path, planes: list[str]) -> None:
    """Equilibrium is found within force_tolerance, 1e-3 of the largest force, and not to rounding errors."""
    stages = [{"name": "draw", "tools": {"punch": {"stroke": 4}, "holder": {"force": "15 kN"}}}]
    implicit = {"max_increment": 0.05, "contact_stiffness": 0.01}
    whole, part = (
        draw(tmp_path / str(len(p)), p, {}, procedure="implicit", stages=stages, implicit=implicit)
        for p in ([], planes)
    )
    assert whole.history["punch.force"].max() > 5e3
    assert largest_difference(whole, part) < 1e-4


@pytest.mark.parametrize("mesh_element", ["quad4_1pt", "tri3"])
def test_symmetry_costs_nothing_in_the_impact_of_a_solid(tmp_path: Path, mesh_element: str) -> None:
    """A block in plane strain upset by a hammer with a narrow face, half of it and whole; forces are of the whole."""
    results = []
    for name, low, cells in (("half", 0, 4), ("whole", -5, 8)):
        case = {
            "title": "a hammer on a block", "analysis": "plane_strain", "procedure": "explicit", "depth": 10,
            "workpiece": {"material": "steel", "element": mesh_element,
                          "mesh": {"origin": [low, 0], "size": [5 - low, 5], "cells": [cells, 4]}},
            "materials": {"steel": {"young": 210e3, "poisson": 0.3, "density": 7.85e-9,
                                    "hardening": {"law": "linear", "yield_stress": 500, "modulus": 100}}},
            "tools": {"hammer": {"profile": [[-20, 7], [-2, 5], [2, 5], [20, 7]],
                                 "contact": "coulomb", "mu": 0.2},
                      "anvil": {"profile": [[-20, 0], [20, 0]], "contact": "coulomb", "mu": 0.2}},
            "boundary": {"middle": {"set": "left", "fix": ["x"]}} if low == 0 else {},
            "stages": [{"name": "blow", "duration": 1e-4, "tools": {"hammer": {"stroke": 1.5, "direction": [0, -1]}}}],
            "output": {"rows": 20, "steps": 2},
        }  # fmt: skip
        results.append(run_to_end(build_model(Case.model_validate(case)), tmp_path / name))
    half, whole = results
    for name in ("hammer.force", "anvil.force", "y_max"):
        largest = np.abs(whole.history[name]).max()
        np.testing.assert_allclose(half.history[name], whole.history[name], rtol=0, atol=1e-9 * largest, err_msg=name)
    places = cKDTree(whole.mesh.points).query(half.mesh.points)[1]
    np.testing.assert_allclose(half.field("displacement"), whole.field("displacement")[places], rtol=0, atol=1e-9)
