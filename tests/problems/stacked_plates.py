# SPDX-License-Identifier: Apache-2.0
"""Two plates in one mesh, of which the upper lies a little above the lower: a sheet that may touch itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.explicit.shells import ExplicitShells
from presswork.model import Hardening, Material, Model, OutputSettings, SheetSelfContact, SolverSettings, Stage, Support
from presswork.ranks.world import World
from tests.problems.explicit_shells import DENSITY, elastic_options, grid, mises
from tests.problems.shells import CLAMPED, patch

YOUNG, THICKNESS, SIDE, GAP = 210e3, 0.8, 8.0, 0.02
SETTINGS = SolverSettings(symmetric=False, initial_increment=0.05, max_increment=0.05, force_tolerance=1e-7)


def stack(stages: tuple[Stage, ...], supports: tuple[Support, ...], mu: float, *, upper: int = 8) -> Model:
    """Return two plates in one mesh, GAP off each other; the lower one, of 8 x 8 shells, is clamped all over."""
    low, high = (
        patch(
            lambda u, v, z=z: np.column_stack([u, v, z + 0 * u]),
            np.linspace(0.0, SIDE, n + 1),
            np.linspace(0.0, SIDE, n + 1),
            thickness=THICKNESS,
        )
        for n, z in ((8, 0.0), (upper, THICKNESS + GAP))
    )
    n = len(low.points)
    cells = np.concatenate([low.blocks[0].connectivity, high.blocks[0].connectivity + n])
    mesh = replace(
        low,
        points=np.concatenate([low.points, high.points]),
        blocks=(replace(low.blocks[0], connectivity=cells.astype(np.int32)),),
        node_sets={"lower": np.arange(n), "upper": np.arange(n, n + len(high.points))},
        edge_sets={},
    )
    return Model(
        title="plates",
        analysis="shell",
        mesh=mesh,
        materials=(Material("elastic", YOUNG, 0.0, Hardening("linear", np.array([1e9, 0.0]))),),
        supports=(Support("lower", CLAMPED), *supports),
        stages=stages,
        solver=SETTINGS,
        output=OutputSettings(steps=1),
        self_contact=SheetSelfContact(mu),
    )


def stack_explicit(
    lower: int = 8, upper: int = 5, *, tilt: float = 0.0, aside: float = 0.3, world: World | None = None
) -> tuple[ExplicitShells, int]:
    """A plate of 12 x 12 mm, and one of 8 x 8 mm of another mesh that lies above it, GAP off; nodes of the first."""
    points, cells = grid(lower, lower, 12.0, 12.0, distort=0.2)
    other, others = grid(upper, upper, 8.0, 8.0)
    c, s = np.cos(0.3), np.sin(0.3)
    other[:, :2] = (other[:, :2] - 4.0) @ np.array([[c, s], [-s, c]]) + 6.0 + aside
    other[:, 2] = THICKNESS + GAP + tilt * other[:, 0]
    n = len(points)
    sheet = ExplicitShells(
        np.concatenate([points, other]),
        np.concatenate([cells, others + n]),
        THICKNESS,
        mises(),
        DENSITY,
        options=elastic_options(),
        world=world,
    )
    return sheet, n
