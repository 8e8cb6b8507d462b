# SPDX-License-Identifier: Apache-2.0
"""Plates that collapse plastically under uniform pressure: quarter meshes, and the load against deflection.

Perfectly plastic; Young's modulus is so large that the plate collapses before its deflection matters.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.implicit.arc_length import ArcLengthProcedure
from presswork.mesh.topology import find_boundary_edges
from presswork.model import CellBlock, ElementName, FloatArray, Material, Mesh, Model, Section
from tests.problems.plane_solids import linear_hardening
from tests.problems.shells import RX, RY, X, Y, Z, fixing, patch, shell_model, symmetry

YOUNG, YIELD, THICKNESS, SIZE = 2e9, 200.0, 1.0, 50.0
"""SIZE: radius, or half the side."""
POINTS = 5
COLLAPSED = 2e-3
"""Deflection over thickness, ten times and more that of first yield, at which the load has long been constant."""
STEEL = Material("steel", YOUNG, 0.3, linear_hardening(YIELD, 0.0))


def plastic_moment(points: int = POINTS) -> float:
    """Moment per width of a section that has flowed altogether, by Gauss's rule itself: 0.945 of the exact Y t^2/4."""
    position, weight = np.polynomial.legendre.leggauss(points)
    return float(YIELD * THICKNESS**2 / 4 * (weight * np.abs(position)).sum())


def towards_edge(n: int) -> FloatArray:
    """n cells from 0 to 1, finer towards 1, where a clamped plate has its hinge."""
    return 1.0 - (1.0 - np.linspace(0, 1, n + 1)) ** 2


def quarter_square(n: int, *, finer_edge: bool, element: ElementName = "shell4_mitc") -> Mesh:
    lines = SIZE * (towards_edge(n) if finer_edge else np.linspace(0, 1, n + 1))
    return patch(lambda x, y: np.column_stack([x, y, 0 * x]), lines, lines, element=element, thickness=THICKNESS,
                 points=POINTS)  # fmt: skip


def quarter_disc(n: int) -> Mesh:
    """n cells of MITC4 along each side of an inner square, and n from it to the rim: 3 n^2 in all."""
    t = np.linspace(0, 1, n + 1)
    u, v = np.meshgrid(t, t, indexing="ij")
    angle = np.pi / 4 * v
    # the square's sides bend in a little, so that cells at its corner keep their angles
    square = np.stack([0.5 * u * (1 - 0.1 * v**2), 0.5 * v * (1 - 0.1 * u**2)])
    inner, rim = square[:, -1:], np.stack([np.cos(angle), np.sin(angle)])
    out = np.meshgrid(towards_edge(n), t, indexing="ij")[0]
    side = (1 - out) * inner + out * rim  # from the square's right side outwards
    grids = [square, side, side[::-1, :, ::-1]]
    found: dict[tuple[float, float], int] = {}
    cells = []
    for grid in grids:
        index = np.array([[found.setdefault((round(x, 9), round(y, 9)), len(found)) for x, y in zip(*row, strict=True)]
                          for row in grid.transpose(1, 0, 2)])  # fmt: skip
        quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
        cells.append(quads.reshape(-1, 4))
    plane = SIZE * np.array(list(found))
    block = CellBlock("shell4_mitc", np.concatenate(cells).astype(np.int32), 0, Section(THICKNESS, POINTS))
    near = 1e-6 * SIZE
    on = {"left": plane[:, 0] < near, "bottom": plane[:, 1] < near, "right": np.hypot(*plane.T) > SIZE - near,
          "bottom_left": np.hypot(*plane.T) < near, "all": plane[:, 0] >= 0}  # fmt: skip
    sets = {name: np.flatnonzero(mask).astype(np.int32) for name, mask in on.items()}
    points = np.column_stack([plane, np.zeros(len(plane))])
    return Mesh(points, (block,), {**sets, "top": sets["right"]}, {}, find_boundary_edges([block.connectivity]))


def pressed_plate(mesh: Mesh, pressure: float, *, clamped: bool, **solver: Any) -> Model:
    """A plate on supports that let its edges move in, under a pressure [MPa]."""
    edge = fixing(Z, RX, RY) if clamped else fixing(Z)
    held = [("left", symmetry(X)), ("bottom", symmetry(Y)), ("right", edge), ("top", edge)]
    return shell_model(mesh, STEEL, held, pressures=[("all", pressure)], **solver)


def collapse_load(mesh: Mesh, expected: float, *, clamped: bool) -> float:
    """Return the pressure at which the middle goes down without end; `expected` gives the first arc its length."""
    model = pressed_plate(mesh, 2.0 * expected, clamped=clamped, control="arc_length", initial_increment=0.2,
                          target_iterations=6)  # fmt: skip
    procedure = ArcLengthProcedure(model, threads=1)
    middle = mesh.node_sets["bottom_left"]
    for report in procedure.advance():
        if procedure.state.nodes.displacement[middle, 2][0] > COLLAPSED * THICKNESS:
            return 2.0 * expected * report.fraction
    raise AssertionError("the plate did not collapse")
