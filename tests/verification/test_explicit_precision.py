# SPDX-License-Identifier: Apache-2.0
"""Single precision against double in a motion like deep drawing: many cycles, large strokes, plastic bending."""

import numpy as np
import pytest

from presswork.explicit.shells import ExplicitShells, Precision
from tests.problems.explicit_shells import DENSITY, Array, grid, mises


def draw(
    precision: Precision,
    *,
    n: int = 16,
    depth: float = 6.0,
    speed: float = 2000.0,
    shift: Array | tuple[float, ...] = (0, 0, 0),
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
    shells.dt *= 0.9  # drawn shells bear a shorter step
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


def stretch_slowly(precision: Precision, cycles: int) -> tuple[float, float]:
    """Stretch shells far from the origin elastically by 0.18 % along x and 0.054 % along y, in equal steps.

    Gives the largest error of stress, over the closed form in logarithmic strains, and the stress along x [MPa].
    """
    points, cells = grid(2, 2, 8.0, 8.0)
    law = mises("swift", (1565.0, 0.007, 0.26))
    shells = ExplicitShells(points + np.array([200.0, -100.0, 30.0]), cells, 0.8, law, DENSITY, precision=precision)
    end = np.array([0.0018, 0.00054])
    velocity = np.zeros((len(points), 6))
    velocity[:, :2] = end * (points - points.mean(axis=0))[:, :2] / (cycles * shells.dt)
    for i, letter in enumerate("uvwpqr"):
        shells.fix(np.arange(len(points)), letter, velocity[:, i])
    shells.velocity = velocity
    shells.advance(cycles)
    assert not shells.equivalent_plastic_strain.any()
    xx, yy = np.log1p(end)
    expected = law.young / (1 - law.poisson**2) * np.array([xx + law.poisson * yy, yy + law.poisson * xx])
    return float(np.abs(shells.stress[..., :2] - expected).max()), float(expected[0])


@pytest.mark.validation
def test_a_million_small_increments_of_stress_are_not_lost_in_single_precision() -> None:
    """2e-9 of strain a cycle: some 15 units in the last place of the stress at the end, and all are rounded alike."""
    error, stress = stretch_slowly("single", 1_000_000)
    assert error < 3e-7 * stress


if __name__ == "__main__":
    for cycles in (10_000, 100_000, 1_000_000):
        print("slowly", cycles, *(f"{p} {stretch_slowly(p, cycles)[0]:.2g} MPa" for p in ("double", "single")))
    for speed in (2000.0, 400.0):
        double, force = draw("double", n=32, depth=12.0, speed=speed)
        moved = 1e-7 * np.random.default_rng(1).standard_normal(double.position.shape)
        for name, precision, shift in (("single", "single", 0 * moved), ("moved by 1e-7 mm", "double", moved)):
            other, found = draw(precision, n=32, depth=12.0, speed=speed, shift=shift)  # type: ignore[arg-type]
            names = ("position", "equivalent_plastic_strain", "thickness", "stress")
            gaps = {each: np.abs(getattr(other, each) - getattr(double, each)).max() for each in names}
            print(double.cycle, f"cycles, {name}:", *(f"{each} {gap:.2g}" for each, gap in gaps.items()), end=" ")
            print(f"force {np.abs(found - force).max() / np.abs(force).max():.2g}")
