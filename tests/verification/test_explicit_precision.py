# SPDX-License-Identifier: Apache-2.0
"""Single precision against double in a motion like deep drawing: many cycles, large strokes, plastic bending."""

import numpy as np

from presswork.explicit.shells import ExplicitShells, Precision
from tests.problems.explicit_shells import DENSITY, Array, grid, mises


def draw(
    precision: Precision,
    *,
    n: int = 16,
    depth: float = 6.0,
    speed: float = 2000.0,
    shift: tuple[float, ...] = (0, 0, 0),
) -> tuple[ExplicitShells, Array]:
    """Blank of 60 x 60 x 0.8 mm, n x n shells; a disc of radius 12 is driven by `depth`, the rim slides in its plane.

    Gives the shells and the punch force at fifty times [N].
    """
    points, cells = grid(n, n, 60.0, 60.0)
    points -= [30.0, 30.0, 0.0]
    radius = np.hypot(points[:, 0], points[:, 1])
    law = mises("swift", (565.0, 0.007, 0.26))
    shells = ExplicitShells(points + shift, cells, 0.8, law, DENSITY, precision=precision)
    punch, rim = np.flatnonzero(radius < 12.0), np.flatnonzero(radius > 27.0)
    shells.fix(rim, "wpq")
    shells.fix(punch, "pq")
    shells.fix(punch, "w", 1.0)
    cycles = round(depth / speed / shells.dt)
    ramp = speed * np.minimum(1.0, np.arange(cycles) / (0.05 * cycles))
    force = []
    for part in np.array_split(ramp, 50):
        shells.advance(len(part), velocity_scale=part)
        force.append(shells.internal_force[punch, 2].sum())
    return shells, np.array(force)


def test_single_precision_draws_what_double_draws() -> None:
    """5000 cycles far from the origin: position to 1e-5 mm, thickness to 1e-6 mm, strain to 1e-5, force to 1e-5."""
    (double, force), (single, found) = draw("double"), draw("single", shift=(1000.0, -500.0, 200.0))
    assert double.cycle > 4500
    assert double.equivalent_plastic_strain.max() > 0.08
    assert np.abs(double.thickness - 0.8).max() > 0.02
    np.testing.assert_allclose(single.position - [1000.0, -500.0, 200.0], double.position, atol=1e-5)
    np.testing.assert_allclose(single.thickness, double.thickness, atol=1e-6)
    np.testing.assert_allclose(single.equivalent_plastic_strain, double.equivalent_plastic_strain, atol=1e-5)
    np.testing.assert_allclose(found, force, atol=1e-5 * np.abs(force).max())


if __name__ == "__main__":
    for speed in (2000.0, 400.0):
        (double, force), (single, found) = (draw(p, n=32, depth=12.0, speed=speed) for p in ("double", "single"))
        names = ("position", "equivalent_plastic_strain", "thickness", "stress")
        gaps = {name: np.abs(getattr(single, name) - getattr(double, name)).max() for name in names}
        print(double.cycle, "cycles:", *(f"{name} {gap:.2g}" for name, gap in gaps.items()), end=" ")
        print(f"force {np.abs(found - force).max() / np.abs(force).max():.2g}")
