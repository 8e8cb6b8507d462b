# SPDX-License-Identifier: Apache-2.0
"""What a drawbead holds back with, from its geometry, against the work of bending and straightening at its radii."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.bead_forces import find_bead_forces
from presswork.case import StampingCase

EXAMPLE = Path(__file__).parents[2] / "src/presswork/examples/drawbead.toml"
THICKNESS, RADII = 0.78, (4.0, 5.0, 4.0)
K, E0, N, YOUNG, POISSON = 565.32, 0.007117, 0.2589, 206e3, 0.3


def work_of_bending() -> float:
    """Return the plastic work of a sheet in plane strain that is bent to each radius and straightened [N/mm].

    Swift's law by the strain so far at each height; each reversal begins with elastic strain of twice the yield strain.
    The sheet lies on the whole radius, has no tension and no friction.
    """
    z, weight = np.polynomial.legendre.leggauss(40)
    z, weight = 0.5 * THICKNESS * z, 0.5 * THICKNESS * weight
    wide, stiff = 2.0 / np.sqrt(3.0), YOUNG / (1.0 - POISSON**2)
    strain, work = np.zeros_like(z), 0.0
    for event, radius in enumerate(np.repeat(RADII, 2)):
        elastic = (1.0 if event == 0 else 2.0) * wide * K * (E0 + strain) ** N / stiff
        plastic = wide * np.maximum(np.abs(z) / (radius + 0.5 * THICKNESS) - elastic, 0.0)
        energy = K / (N + 1.0) * ((E0 + strain + plastic) ** (N + 1.0) - (E0 + strain) ** (N + 1.0))
        work += float(energy @ weight)
        strain = strain + plastic
    return work


def find_forces(mu: float) -> tuple[float, float]:
    """Return restraining and closing force of the bead of the example, given by its geometry [N/mm]."""
    geometry = {"bead_radius": 5, "groove_radius": 4, "depth": 7, "groove_width": 12, "gap": 0.9, "mu": mu}
    example = tomllib.loads(EXAMPLE.read_text())
    data: dict[str, Any] = {key: example[key] for key in ("title", "analysis", "blank", "tools", "stages")}
    case = StampingCase.model_validate({**data, "beads": [{"points": [[0, -1], [0, 1]], "geometry": geometry}]})
    found = find_bead_forces(case)
    assert isinstance(found, StampingCase)
    return found.beads[0].force, found.beads[0].closing_force


@pytest.mark.validation
def test_a_bead_without_friction_takes_the_work_of_bending() -> None:
    """72.9 N/mm; the strip needs a few per cent more, for its tension and as rows of its shells come over the radii."""
    assert work_of_bending() == pytest.approx(72.9, abs=0.05)
    assert find_forces(0.0)[0] == pytest.approx(work_of_bending(), rel=0.08)
