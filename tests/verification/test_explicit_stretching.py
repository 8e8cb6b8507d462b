# SPDX-License-Identifier: Apache-2.0
"""Large plastic stretching of a distorted patch of explicit shells against the closed forms of von Mises and Swift."""

from itertools import product

import numpy as np
import pytest

from presswork.explicit.shells import ExplicitShells, Precision, ShellOptions
from presswork.model import ExplicitElement
from tests.problems.explicit_shells import DENSITY, POISSON, YOUNG, grid, mises

K, E0, N = 565.0, 0.02, 0.6  # hardens fast enough not to neck before a strain of one half (Considere)
SIDE, THICKNESS, STRAIN = 4.0, 0.8, 0.5
PATHS = {"uniaxial": None, "plane strain": 0.0, "equibiaxial": 1.0}
"""Ratio of the two driven velocities; None leaves the second direction free."""


def closed_form(path: str) -> tuple[float, float, float]:
    """Stress along x [MPa], equivalent plastic strain and thickness at the end.

    The elastic strains are solved for by fixed point; volume changes by them alone.
    """
    stress_ratio = {"uniaxial": 0.0, "plane strain": 0.5, "equibiaxial": 1.0}[path]
    flow_ratio = np.sqrt(1 - stress_ratio + stress_ratio**2)  # von Mises over stress along x
    plastic_strain_x = (1 - 0.5 * stress_ratio) / flow_ratio  # over equivalent
    stress = K * E0**N
    for _ in range(50):
        p = (STRAIN - stress * (1 - POISSON * stress_ratio) / YOUNG) / plastic_strain_x
        stress = K * (E0 + p) ** N / flow_ratio
    plastic_z = -p * (0.5 + 0.5 * stress_ratio) / flow_ratio
    return stress, p, THICKNESS * np.exp(plastic_z - POISSON * stress * (1 + stress_ratio) / YOUNG)


def stretch(
    path: str, precision: Precision = "double", options: ShellOptions | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stress along x, equivalent plastic strain and thickness of every shell after stretching to log strain 0.5."""
    points, cells = grid(4, 4, SIDE, SIDE, distort=0.2)
    law = mises("swift", (K, E0, N))
    shells = ExplicitShells(points, cells, THICKNESS, law, DENSITY, precision=precision, options=options)
    speed, ratio = 2000.0, PATHS[path]
    start = np.zeros((len(points), 6))
    for i, letter in enumerate("uv"[: 1 if ratio is None else 2]):
        velocity = speed * (points[:, i] / SIDE) * (1.0 if i == 0 else ratio)
        edge = np.flatnonzero((points[:, i] == 0) | (points[:, i] == SIDE))
        shells.fix(edge, letter, velocity[edge])
        start[:, i] = velocity
    if ratio is None:
        shells.fix(np.flatnonzero(points[:, 1] == 0), "v")
    if ratio is None:
        start[:, 1] = -0.5 * speed * points[:, 1] / SIDE
    shells.velocity = start
    end = (np.exp(STRAIN) - 1) * SIDE / speed
    while shells.time < end:
        shells.dt = min(0.9 * shells.stable_step(), end - shells.time)
        shells.advance(min(50, int((end - shells.time) / shells.dt + 1e-9)))
    return shells.stress_at_points[..., 0], shells.history_at_points[..., 0], shells.thickness


@pytest.mark.parametrize(
    ("precision", "element"),
    [("double", "shell4_1pt"), ("single", "shell4_1pt"), ("double", "shell4_mitc_plus"),
     ("single", "shell4_mitc_plus")],
)  # fmt: skip
@pytest.mark.parametrize("path", PATHS)
def test_stretching_to_log_strain_one_half(path: str, precision: Precision, element: ExplicitElement) -> None:
    """Every shell of the distorted mesh: 1e-4; plane strain 1e-3, its elastic part takes another path."""
    stress, p, thickness = stretch(path, precision, ShellOptions(element=element))
    expected = closed_form(path)
    rtol = 1e-3 if path == "plane strain" else 1e-4
    np.testing.assert_allclose(stress, expected[0], rtol=rtol)
    np.testing.assert_allclose(p, expected[1], rtol=rtol)
    np.testing.assert_allclose(thickness, expected[2], rtol=rtol)


if __name__ == "__main__":
    for name, which in product(PATHS, ("double", "single")):
        ratios = [found / exact for found, exact in zip(stretch(name, which), closed_form(name), strict=True)]
        print(name, which, *(f"{r.min():.6f} {r.max():.6f}" for r in ratios))
