# SPDX-License-Identifier: Apache-2.0
"""Two curved beams that slide over each other: the model of Neto et al. (2016).

Neto, Oliveira, Menezes & Alves, A contact smoothing method for arbitrary surface meshes using Nagata patches, Computer
Methods in Applied Mechanics and Engineering 299 (2016) 283-315. Half rings of 2 mm, the lower one of 12 mm outer radius
clamped at both feet, the upper one of 10 mm upside down above it, so that both touch. The upper one is drawn over the
lower by 31.5 mm along x. Plane strain, 1 mm deep; E = 689.56 MPa, nu = 0.32, yield at 31 MPa, linear hardening of
261.2 MPa.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh import mesh_rectangle
from presswork.mesh.joined import join_meshes
from presswork.model import (
    BodyContact,
    FloatArray,
    Material,
    Mesh,
    Model,
    OutputSettings,
    PrescribedDisplacement,
    SolverSettings,
    Stage,
    Support,
)
from presswork.state import State
from tests.problems.plane_solids import linear_hardening, make_model

LOWER, UPPER, WALL, HEIGHT, WAY = 12.0, 10.0, 2.0, 17.0, 31.5
"""Outer radii, wall thickness, height of the upper beam's feet over the lower's, way of the upper beam [mm]."""
SOFT = Material("soft", 689.5564786, 0.32, linear_hardening(31.0, 261.2))


def arch(outer: float, centre: tuple[float, float], cells: tuple[int, int], *, above: bool) -> Mesh:
    """Half a ring, its bend upwards or, `above`, downwards; the node set "ends" has both feet."""
    around, across = cells
    mesh = mesh_rectangle(np.linspace(0.0, np.pi, around + 1), np.linspace(0.0, WALL, across + 1), element="quad4_fbar")
    angle, depth = mesh.points.T
    radius = outer - WALL + depth
    turn = np.pi + angle if above else np.pi - angle
    points = np.column_stack([centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)])
    cells_of = mesh.blocks[0].connectivity
    edges, order = mesh.boundary_edges, [0, 1]
    if above:  # turned round, the grid would be inside out
        cells_of, order = cells_of[:, ::-1].copy(), [1, 0]
    ends = np.flatnonzero((angle == 0.0) | (angle == angle.max())).astype(np.int32)
    block = replace(mesh.blocks[0], connectivity=cells_of)
    return Mesh(points, (block,), {"ends": ends}, {}, edges[:, order])


def beams(
    mu: float, solver: SolverSettings, *, way: float = WAY, cells: tuple[int, int] = (100, 8), duration: float = 1.0,
    density: float = 0.0,
) -> Model:  # fmt: skip
    """Return the model with Coulomb friction mu between the beams, drawn by `way` [mm]."""
    apart = float(np.sqrt((LOWER + UPPER) ** 2 - HEIGHT**2))
    mesh, bodies = join_meshes(
        {
            "workpiece": arch(LOWER, (LOWER, 0.0), cells, above=False),
            "upper": arch(UPPER, (LOWER - apart, HEIGHT), cells, above=True),
        }
    )
    stage = Stage("slide", duration=duration, prescribed=(PrescribedDisplacement("upper.ends", 0, way),))
    model = make_model(
        mesh,
        replace(SOFT, density=density),
        supports=(Support("ends", (True, True)), Support("upper.ends", (False, True))),
        stages=(stage,),
        solver=solver,
    )
    contact = BodyContact("slide", (1, 0), 0, "coulomb" if mu else "frictionless", mu=mu)
    return replace(model, bodies=bodies, contacts=(contact,), output=OutputSettings(steps=1))


def force_on_feet(model: Model, state: State) -> FloatArray:
    """Return the sum of the reactions at the lower beam's feet (2,) [N]."""
    return np.asarray(state.nodes.reaction[model.mesh.node_sets["ends"]].sum(axis=0))


def slide(model: Model) -> tuple[FloatArray, ImplicitProcedure]:
    """Run; return the way [mm], the forces on the feet and between the beams of each increment (n, 5)."""
    procedure = ImplicitProcedure(model, threads=1)
    way = model.stages[0].prescribed[0].value
    rows = []
    for report in procedure.advance():
        between = procedure.contact_forces()["slide"]
        rows.append([way * report.fraction, *force_on_feet(model, procedure.state), *between])
    return np.array(rows), procedure
