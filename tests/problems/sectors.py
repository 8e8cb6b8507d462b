# SPDX-License-Identifier: Apache-2.0
"""Round bodies between round tools, in axisymmetry and as a sector in space, and how the two compare."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork import build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.model import FloatArray
from presswork.process.begin import begin

STEEL = {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300}}
PLANES = {
    "first": {"set": "first_plane", "fix": ["y"]},
    "last": {"set": "last_plane", "fix": ["normal"]},
    "middle": {"set": "back", "fix": ["z"]},
}
Data = dict[str, Any]


def upsetting(angle: float, cells: tuple[int, int, int], friction: Data, *, stroke: float = 7.5) -> tuple[Data, Data]:
    """Return half a cylinder of 10 x 15 mm as cases in axisymmetry and in space; cells: radial, around, along."""
    radial, around, along = cells
    flat = {
        "title": "a cylinder is upset",
        "analysis": "axisymmetric",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 15], "cells": [radial, along]}},
        "materials": {"steel": STEEL},
        "tools": {"punch": {"profile": [[0, 15], [40, 15]], **friction}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "upset", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}],
        "output": {"steps": 1},
    }
    mesh = {"kind": "cylinder", "radius": 10 * widen(angle / around), "height": 15, "angle": angle, "cells": cells}
    return flat, in_space(flat, mesh)


def ring(angle: float, cells: tuple[int, int, int], friction: Data, *, stroke: float = 3.0) -> tuple[Data, Data]:
    """Return a ring 6:3:2 of 18, 9 and 6 mm (a half of it) as both cases."""
    radial, around, along = cells
    flat, _ = upsetting(angle, cells, friction, stroke=stroke)
    flat["workpiece"]["mesh"] = {"origin": [9, 0], "size": [9, 6], "cells": [radial, along]}
    flat["tools"]["punch"]["profile"] = [[0, 6], [60, 6]]
    flat["boundary"] = {"middle": {"set": "bottom", "fix": ["y"]}}
    wide = widen(angle / around)
    radii = {"inner_radius": 9 * wide, "outer_radius": 18 * wide}
    return flat, in_space(flat, {"kind": "ring", **radii, "height": 6, "angle": angle, "cells": cells})


def widen(degrees: float) -> float:
    """Return the factor on radii that gives chords of so many degrees the area of the circle."""
    turn = np.radians(degrees)
    return float(np.sqrt(turn / np.sin(turn)))


def in_space(flat: Data, mesh: Data) -> Data:
    """Return an axisymmetric case with tools that press along the axis as one in space, on another mesh."""
    case = copy.deepcopy(flat)
    case["analysis"] = "solid"
    case["workpiece"]["mesh"] = mesh
    case["tools"] = {name: {"shape": "round", **tool} for name, tool in case["tools"].items()}
    case["boundary"] = PLANES
    for stage in case["stages"]:
        for motion in stage["tools"].values():
            x, y = motion["direction"]
            motion["direction"] = [x, 0, y]
    return case


@dataclass(frozen=True)
class Comparison:
    """Of a body in space with that in axisymmetry."""

    stroke: FloatArray
    """Tenths of the whole, from the second on (9,) [mm]."""
    force: FloatArray
    """In axisymmetry (9,) [N]."""
    force_ratio: FloatArray
    """(9,)"""
    radius_ratio: float
    """Largest radius at the end."""
    hole_ratio: float
    """Least radius at the end; 1 where there is no hole."""
    lateral_force: float
    """Of the whole tool in space, across its way [N]."""


def compare(flat: Data, space: Data, tool: str = "punch") -> Comparison:
    """Compute both cases and compare forces, and profiles at the end."""
    curves, ends = [], []
    for case in (Case(**flat), SpaceCase(**space)):
        run = begin(build_model(case), threads=1)
        rows = [run.row(report) for report in run.advance()]
        curves.append(np.array([[row[f"{tool}.stroke"], row[f"{tool}.force"]] for row in rows]).T)
        ends.append((run.model.mesh.points + run.procedure.state.nodes.displacement, rows[-1]))  # type: ignore[attr-defined]
    (x, _), (y, last) = ends
    stroke = np.linspace(0.2, 1.0, 9) * curves[0][0, -1]
    force, other = (np.interp(stroke, *curve) for curve in curves)
    flat_radius, radius = x[:, 0], np.hypot(y[:, 0], y[:, 1])
    hole = float(radius.min() / flat_radius.min()) if flat_radius.min() > 1e-9 else 1.0
    lateral = float(np.hypot(last[f"{tool}.force_x"], last[f"{tool}.force_y"]))
    return Comparison(stroke, force, other / force, float(radius.max() / flat_radius.max()), hole, lateral)
