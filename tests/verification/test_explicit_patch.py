# SPDX-License-Identifier: Apache-2.0
"""One-point shells: patch tests on distorted meshes, modes without energy, the twisted beam of MacNeal & Harder 1985."""

import numpy as np
import pytest

from presswork.procedure.explicit import ExplicitShells
from shell_problems import DENSITY, POISSON, YOUNG, elastic_options, grid, mises, solve_static, stiffness

T = 0.7
FIELDS = {
    "membrane": lambda x, y: 1e-4 * np.stack([2 * x + y, x - 3 * y, 0 * x, 0 * x, 0 * x, 0 * x], axis=1),
    # w = (a x^2 + b y^2)/2, rotations p = w,y and q = -w,x
    "bending": lambda x, y: 1e-4 * np.stack([0 * x, 0 * x, x * x + 1.5 * y * y, 3 * y, -2 * x, 0 * x], axis=1),
    "twist": lambda x, y: 1e-4 * np.stack([0 * x, 0 * x, 2 * x * y, 2 * x, -2 * y, 0 * x], axis=1),
}


@pytest.mark.parametrize("warping", [False, True])
@pytest.mark.parametrize("which", FIELDS)
def test_patch(which: str, warping: bool) -> None:
    """Edge nodes of a flat distorted patch follow the field; inner nodes in equilibrium follow it too."""
    points, cells = grid(4, 4, 4.0, 4.0, distort=0.25)
    shells = ExplicitShells(points, cells, T, mises(), DENSITY, options=elastic_options(warping=warping))
    exact = FIELDS[which](points[:, 0], points[:, 1])
    matrix = stiffness(shells)
    inner = np.zeros((len(points), 6), dtype=bool)
    inner[(points[:, 0] > 0) & (points[:, 0] < 4) & (points[:, 1] > 0) & (points[:, 1] < 4), :5] = True
    found = exact + solve_static(matrix, inner, -(matrix @ exact.ravel()).reshape(exact.shape))
    np.testing.assert_allclose(found, exact, atol=1e-7 * np.abs(exact).max())


def rigid_motions(points: np.ndarray) -> np.ndarray:
    """Three translations and three rotations (6, n, 6)."""
    modes = np.zeros((6, len(points), 6))
    for i, axis in enumerate(np.eye(3)):
        modes[i, :, i] = 1.0
        modes[3 + i, :, :3] = np.cross(axis, points - points.mean(axis=0))
        modes[3 + i, :, 3:] = axis
    return modes.reshape(6, -1)


@pytest.mark.parametrize("warping", [False, True])
@pytest.mark.parametrize("height", [0.0, 0.4])
def test_rigid_motion_gives_no_force(warping: bool, height: float) -> None:
    points = np.array([[0, 0, 0], [2, 0.2, height], [2.3, 1.7, 0], [-0.2, 1.4, height]])
    shells = ExplicitShells(points, [[0, 1, 2, 3]], T, mises(), DENSITY, options=elastic_options(warping=warping))
    matrix = stiffness(shells)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.abs(matrix).max())
    for mode in rigid_motions(points):
        np.testing.assert_allclose(matrix @ mode, 0.0, atol=1e-12 * np.abs(matrix).max())


def count_zero(matrix: np.ndarray) -> int:
    values = np.abs(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)))
    return int((values < 1e-9 * values.max()).sum())


def test_modes_without_energy() -> None:
    """One shell: 6 rigid, 4 drilling rotations less the rigid one's share, the twist of the rotations; without control 5
    more. In a patch of 2 x 2 the twist of the rotations is gone: 6 rigid and the 9 drilling rotations."""
    one = np.array([[0, 0, 0], [2, 0.2, 0], [2.3, 1.7, 0], [-0.2, 1.4, 0]])
    for coefficient, expected in ((0.03, 6 + 4 + 1), (0.0, 6 + 4 + 1 + 5)):
        options = elastic_options(coefficients=(coefficient,) * 3)
        shells = ExplicitShells(one, [[0, 1, 2, 3]], T, mises(), DENSITY, options=options)
        assert count_zero(stiffness(shells)) == expected
    points, cells = grid(2, 2, 2.0, 2.0, distort=0.2)
    shells = ExplicitShells(points, cells, T, mises(), DENSITY, options=elastic_options())
    assert count_zero(stiffness(shells)) == 6 + 9


def twisted_beam(thickness: float, direction: int, *, warping: bool, along: int = 24, across: int = 4) -> float:
    """Tip displacement over MacNeal & Harder's: length 12, width 1.1, twisted by 90 degrees, unit tip force."""
    points, cells = grid(along, across, 12.0, 1.1)
    angle, y = 0.5 * np.pi * points[:, 0] / 12.0, points[:, 1] - 0.55
    points = np.stack([points[:, 0], y * np.cos(angle), y * np.sin(angle)], axis=1)
    law = mises(young=29e6, poisson=0.22)
    shells = ExplicitShells(points, cells, thickness, law, DENSITY, options=elastic_options(warping=warping))
    free = np.ones((len(points), 6), dtype=bool)
    free[points[:, 0] == 0] = False
    load = np.zeros((len(points), 6))
    tip = np.flatnonzero(points[:, 0] == 12.0)
    force = 1.0 if thickness > 0.1 else 1e-6
    load[tip, direction] = force / across
    load[tip[[0, -1]], direction] *= 0.5
    found = solve_static(stiffness(shells, 1e-6), free, load)[tip[across // 2], direction]
    reference = {(0.32, 2): 5.424e-3, (0.32, 1): 1.754e-3, (0.0032, 2): 5.256e-3, (0.0032, 1): 1.294e-3}
    return float(found / reference[thickness, direction])


if __name__ == "__main__":
    for t in (0.32, 0.0032):
        for d in (1, 2):
            print(t, d, [twisted_beam(t, d, warping=w) for w in (False, True)], flush=True)
