# SPDX-License-Identifier: Apache-2.0
"""A deck of Abaqus: the cup of dyna_deck.py, in instances, its die drawn elsewhere and turned into its place."""

from __future__ import annotations

import numpy as np

from tests.problems.dyna_deck import HOLDING, STROKE, THICKNESS, Grid, make_grids

MATERIAL = """*Material, name=Steel
*Density
 7.85e-09,
*Elastic
207000., 0.3
*Plastic
200., 0.
300., 0.1
400., 0.5
*Potential
1., 1.0402, 1.2, 1.02, 1., 1.
"""
TAIL = """*Amplitude, name=Speed
0., 0., 0.0001, 0., 0.0012, 1., 0.0062, 1.,
0.0073, 0.
*Amplitude, name=Force, definition=SMOOTH STEP
0., 0., 0.0001, 1.
*Surface Interaction, name=Oil
*Friction
 0.1,
*Step, name=Draw, nlgeom=YES
*Dynamic, Explicit
, 0.0073
*Boundary
Symmetry_x, XSYMM
Symmetry_y, 2, 2
Symmetry_y, 4, 4
Symmetry_y, 6, 6
*Boundary, amplitude=Speed, type=VELOCITY
punch-1.Reference, 3, 3, {speed}
*Boundary
die-1.Reference, 1, 6
holder-1.Reference, 1, 2
*Cload, amplitude=Force
holder-1.Reference, 3, {force}
*Contact Pair, interaction=Oil, mechanical constraint=PENALTY
Sheet, Punch
*Contact Pair, interaction=Oil, mechanical constraint=PENALTY
Sheet, Holder
*Contact Pair, interaction=Oil, mechanical constraint=PENALTY
Sheet, Die
*Output, field
*End Step
"""


def _describe_mesh(grid: Grid, points: np.ndarray, kind: str) -> list[str]:
    lines = ["*Node", *(f"{i}, {p[0]:.9g}, {p[1]:.9g}, {p[2]:.9g}" for i, p in enumerate(points, 1))]
    lines += [f"*Element, type={kind}, elset=All"]
    return [*lines, *(f"{i}, {', '.join(str(n + 1) for n in cell)}" for i, cell in enumerate(grid.cells, 1))]


def write_deck(material: str = MATERIAL, tail: str = TAIL) -> str:
    """Return the deck."""
    parts: list[str] = ["*Heading", "a round cup", "** PARTS"]
    assembly: list[str] = ["*Assembly, name=Assembly"]
    for name, grid in make_grids().items():
        points = grid.points
        place: list[str] = []
        if name == "die":  # drawn turned by -30 degrees about z and 100 mm off
            c, s = np.cos(np.radians(30.0)), np.sin(np.radians(30.0))
            points = points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]).T - [100.0, 0.0, 0.0]
            place = ["100., 0., 0.", "0., 0., 0., 0., 0., 1., 30."]
        parts += [f"*Part, name={name}"]
        parts += _describe_mesh(grid, points, "S4R" if name == "blank" else "R3D4")
        if name == "blank":
            parts += ["*Shell Section, elset=All, material=Steel", f"{THICKNESS}, 5"]
            for axis in (0, 1):
                labels = np.flatnonzero(np.abs(points[:, axis]) < 1e-9) + 1
                parts += [f"*Nset, nset=Symmetry_{'xy'[axis]}", *(f"{label}," for label in labels)]
        else:
            label = len(points) + 1
            parts += ["*Node, nset=Reference", f"{label}, 0., 0., 0.", "*Rigid Body, ref node=Reference, elset=All"]
        parts += ["*Surface, type=ELEMENT, name=Face", "All, SPOS", "*End Part"]
        assembly += [f"*Instance, name={name}-1, part={name}", *place, "*End Instance"]
        surface = "Sheet" if name == "blank" else name.capitalize()
        assembly += [f"*Elset, elset=_{name}, instance={name}-1, generate", f"1, {len(grid.cells)}, 1"]
        assembly += [f"*Surface, type=ELEMENT, name={surface}", f"_{name}, SPOS"]
    for axis in "xy":
        assembly += [f"*Nset, nset=Symmetry_{axis}, instance=blank-1", f"Symmetry_{axis},"]
    assembly += ["*End Assembly"]
    text = tail.format(speed=f"{-STROKE / 6.1e-3:.9g}", force=f"{-HOLDING / 4:g}")
    return "\n".join([*parts, *assembly, material.rstrip("\n"), text])
