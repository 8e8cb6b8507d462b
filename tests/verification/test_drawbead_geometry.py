# SPDX-License-Identifier: Apache-2.0
"""What a drawbead holds back with, from its geometry, against the work of bending and straightening at its radii."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.regression.whole_runs import run_stamping

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


def test_a_bead_without_friction_takes_the_work_of_bending(tmp_path: Path) -> None:
    """72.9 N/mm; the strip needs a few per cent more, for its tension and as rows of its shells come over the radii."""
    case: dict[str, Any] = tomllib.loads(EXAMPLE.read_text())
    for tool in case["tools"].values():
        tool["mu"] = 0.0
    case["stages"][1]["displacement"][0]["value"] = 25.0
    history = run_stamping(case, tmp_path / "out").history
    pulled = history["right.force_x"][history["stage"] == "pull"]  # of a strip 1 mm wide: half of it is computed
    assert work_of_bending() == pytest.approx(72.9, abs=0.05)
    assert float(pulled[60:98].mean()) == pytest.approx(work_of_bending(), rel=0.08)
