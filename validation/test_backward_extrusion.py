# SPDX-License-Identifier: Apache-2.0
"""Plane-strain backward extrusion on meshes that change, between bounds of plasticity: three reductions."""

import numpy as np
import pytest
import scipy

from tests.verification.test_remeshing import backward_extrusion, run

pytestmark = pytest.mark.validation

WIDTH, FLOW = 2.0, 100.0
"""Half the container [mm]; flow stress without hardening [MPa]."""


def bound_by_triangles(reduction: float) -> float:
    """Return the least upper bound of the punch's mean pressure over 2k by one rigid triangle and dead metal.

    Seen from the punch metal comes up by 1. It crosses the line from the apex of the dead metal, e beneath the middle
    of the punch, to the wall, d beneath its face; slides along the dead metal to the punch's edge; and crosses the line
    from that edge to the wall (rigid blocks, as in Johnson & Mellor 1973, Engineering Plasticity). Work along each line
    is k times length times the jump of velocity.
    """
    punch, gap = reduction * WIDTH, (1.0 - reduction) * WIDTH
    edge = np.array([punch, 0.0])

    def power(depths: np.ndarray) -> float:
        e, d = np.abs(depths)
        steepness = e / punch - (e - d) / WIDTH
        if steepness < 1e-6:
            return np.inf
        slide = np.array([1.0, e / punch]) / steepness
        apex, wall = np.array([0.0, -e]), np.array([WIDTH, -d])
        lines = (
            (slide - [0.0, 1.0], apex - wall),
            ([0.0, WIDTH / gap] - slide, edge - wall),
            (slide, edge - apex),
        )
        return float(sum(np.linalg.norm(jump) * np.linalg.norm(line) for jump, line in lines))

    starts = ([0.1, 1.0], [1.0, 2.0], [0.5, 0.5])
    least = min(scipy.optimize.minimize(power, start, method="Nelder-Mead").fun for start in starts)
    return least / (2.0 * punch)


@pytest.mark.parametrize("reduction", [1 / 3, 1 / 2, 2 / 3])
def test_punch_pressure_lies_between_the_ideal_work_and_rigid_blocks(reduction):
    """Ideal work ln(1 / (1 - r)) / r beneath, rigid blocks above; at one half slip lines give 2.571 (1 + pi / 2)."""
    punch = reduction * WIDTH
    case = backward_extrusion(0.12)
    profile = [[-1, 3], {"to": [punch, 3], "radius": 0.1}, [punch, 11]]
    tool = type(case.tools["punch"]).model_validate({"profile": profile, "contact": "frictionless"})
    case = case.model_copy(update={"tools": case.tools | {"punch": tool}})
    rows, recording = run(case)
    pressure = rows["punch.force"] / (2.0 * punch) / (2.0 * FLOW / np.sqrt(3.0))
    steady = pressure[rows["punch.stroke"] > 0.1]
    ideal, blocks = np.log(1.0 / (1.0 - reduction)) / reduction, bound_by_triangles(reduction)
    print(f"r = {reduction:.2f}: {ideal:.3f} < {steady.min():.3f} to {steady.max():.3f} < {blocks:.3f}")
    assert ideal < steady.min()
    assert steady.max() < blocks
    if reduction == 1 / 2:
        assert steady.mean() == pytest.approx(1.0 + np.pi / 2.0, rel=0.02)
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 1.0
