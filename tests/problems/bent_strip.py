# SPDX-License-Identifier: Apache-2.0
"""A strip bent in its plane of symmetry, free to narrow: the procedure that bends it, and its moment in closed form.

With Poisson's ratio of 0.4999 every layer is in uniaxial tension or compression. Small strains, linear hardening.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Kinematic, Material, Mesh, PrescribedDisplacement, Stage
from tests.problems.plane_solids import linear_hardening
from tests.problems.shells import RY, RZ, X, Y, Z, fixing, patch, shell_model

YOUNG, YIELD, MODULUS, THICKNESS, LENGTH = 2e5, 200.0, 1000.0, 1.0, 20.0
POISSON = 0.4999
INERTIA = THICKNESS**3 / 12
FIRST_YIELD = 2 * YIELD / (YOUNG * THICKNESS)
"""Curvature at first yield [1/mm]."""


def strip(points: int, rule: str = "gauss", cells: int = 8) -> Mesh:
    return patch(lambda u, v: np.column_stack([u, v, 0 * u]), np.linspace(0, LENGTH, cells + 1), np.array([0.0, 1.0]),
                 thickness=THICKNESS, points=points, rule=rule)  # fmt: skip


def steel(poisson: float = POISSON, modulus: float = MODULUS, *, kinematic: bool = False) -> Material:
    """Linear hardening, isotropic, or kinematic with the same first loading."""
    if not kinematic:
        return Material("steel", YOUNG, poisson, linear_hardening(YIELD, modulus))
    back = Kinematic("chaboche", {"C": (modulus,), "gamma": (0.0,)})
    return Material("steel", YOUNG, poisson, linear_hardening(YIELD, 0.0), kinematic=back)


def moment_of(curvature: float, modulus: float = MODULUS) -> float:
    """Moment per width at first loading: elastic core, linear hardening beyond."""
    tangent = YOUNG * modulus / (YOUNG + modulus)
    half = THICKNESS / 2
    core = min(YIELD / (YOUNG * curvature), half)
    elastic = 2 / 3 * YOUNG * curvature * core**3
    outside = (YIELD * (1 - tangent / YOUNG) * (half**2 - core**2)) + 2 / 3 * tangent * curvature * (half**3 - core**3)
    return elastic + outside


def moment_after_reversal(first: float, then: float, modulus: float, *, kinematic: bool) -> float:
    """Moment per width at the curvature `then`, after the largest, `first` > 0; -first <= then < first.

    Kinematic: every layer goes back along its first loading, doubled (Masing's rule), so the moment does. Isotropic: a
    layer that had flowed at s1 flows back at -s1, one that had not at -Y.
    """
    if kinematic:
        return moment_of(first, modulus) - 2 * moment_of(0.5 * (first - then), modulus)
    tangent = YOUNG * modulus / (YOUNG + modulus)
    n = 20_000
    z = (np.arange(n) + 0.5) * 0.5 * THICKNESS / n
    highest = np.maximum(YIELD, YIELD + tangent * (first * z - YIELD / YOUNG))  # size of the yield surface
    peak = np.minimum(YOUNG * first * z, highest)
    back = (first - then) * z
    elastic = (peak + highest) / YOUNG
    stress = peak - YOUNG * np.minimum(back, elastic) - tangent * np.maximum(back - elastic, 0.0)
    return float(2 * (stress * z).sum() * 0.5 * THICKNESS / n)


def bend(
    mesh: Mesh, material: Material, curvatures: Sequence[float], *, increments: int = 10, release: bool = False,
    **solver: Any,
) -> tuple[list[tuple[float, float, str]], ImplicitProcedure]:  # fmt: skip
    """Turn the strip's end to one curvature after the other, and let it go.

    Return curvature, moment per width and stage of every increment, and the procedure at the end.
    """
    held = [("left", fixing(X, Z, RY, RZ)), ("bottom_left", fixing(Y))]
    turns = np.diff([0.0, *curvatures]) * LENGTH
    stages = [Stage(f"bend {i}", prescribed=(PrescribedDisplacement("right", RY, float(turn)),))
              for i, turn in enumerate(turns)]  # fmt: skip
    stages += [Stage("release")] if release else []
    settings = {"initial_increment": 1 / increments, "max_increment": 1 / increments, **solver}
    procedure = ImplicitProcedure(shell_model(mesh, material, held, stages=stages, **settings), threads=1)
    found = []
    nodes = mesh.node_sets["right"]
    for report in procedure.advance():
        state = procedure.state
        found.append(
            (state.nodes.displacement[nodes, RY].mean() / LENGTH, state.nodes.reaction[nodes, RY].sum(), report.stage)
        )
    return found, procedure
