# SPDX-License-Identifier: Apache-2.0
"""Dies with closed-form stress: rings with interference, a block under a disc, and a run that presses on a tool."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork import build_model
from presswork.case.plane.schema import Case
from presswork.dies.hand_over import ToolLoad
from presswork.dies.meshes import mesh_body
from presswork.dies.structure import DieStructure
from presswork.mesh.edges import edge_areas
from presswork.model import DieBody, DiePart, DieSteel
from presswork.recorder import run_model
from presswork.results import Result

STEEL, CARBIDE = DieSteel(young=210e3, poisson=0.3), DieSteel(young=560e3, poisson=0.22)
BODY = {"size": 2.0, "outer": 40.0, "top": 45.0, "held": ["top"], "young": 210e3, "poisson": 0.3}


def make_rings(core, interference, radii=(10.0, 20.0, 40.0), height=4.0, size=0.6, steel=STEEL) -> DieStructure:
    """A core and a ring round it, between two planes on one of which they slide."""
    bore, middle, outer = radii
    profile = np.array([[bore, 0.0, bore, height, 0.0, 0.0, 0.0]])  # metal on its right
    parts = (
        DiePart(steel=core, outer=middle, held=("bottom",)),
        DiePart(steel=steel, outer=outer, held=("bottom",), interference=interference),
    )
    body = DieBody(size, parts)
    return DieStructure(mesh_body(profile, body), body, "axisymmetric", 1.0)


def press_line(start, end, n: int, pressure: float, *, is_ring: bool, depth: float = 1.0) -> ToolLoad:
    """The forces of a pressure on n edges between two points of a workpiece, towards the right of the line."""
    points = np.linspace(start, end, n + 1)
    edges = np.column_stack([np.arange(n), np.arange(1, n + 1)])
    area = np.zeros(n + 1)
    np.add.at(area, edges, edge_areas(points, edges, None if is_ring else depth))
    along = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
    return ToolLoad(points, pressure * area[:, None] * np.array([along[1], -along[0]]), np.zeros(n + 1, dtype=np.int64))


def upset(folder: Path, analysis: str = "axisymmetric", body=BODY, **tools) -> Result:
    """A block of 10 x 10 mm, upset by 5 % under a smooth punch: 500 MPa everywhere."""
    fixed = {"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}}
    punch = {"profile": [[-5.0 if analysis == "plane_strain" else 0.0, 10.0], [30.0, 10.0]], "contact": "frictionless"}
    case = {
        "title": "pressed",
        "analysis": analysis,
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "rectangle", "size": [10, 10], "cells": [5, 5]},
        },
        "materials": {"steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 500}}},
        "tools": {"punch": punch | ({"body": body} if body else {}), **tools},
        "boundary": fixed,
        "stages": [{"name": "press", "tools": {"punch": {"stroke": 0.5, "direction": [0, -1]}}}],
        "solver": {"initial_increment": 0.25, "max_increment": 0.25},
        "output": {"steps": 4},
    }
    return run_model(build_model(Case.model_validate(case)), folder).result
