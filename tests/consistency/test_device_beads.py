# SPDX-License-Identifier: Apache-2.0
"""Drawbeads on the host build of the code for cards: the same strip as by the loop of the CPU."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.verification.test_drawbeads import FORCE, STRIP, WIDTH, pull

STAGE = {**STRIP["stages"][0], "duration": 1e-3, "ramp": 4e-4}
AGREEMENT = 1e-8
"""Of the largest value of a column."""


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_strip_through_beads_is_the_same_on_a_device(tmp_path: Path, precision: str) -> None:
    """A bead across the strip, and one aslant: forces, work and energies."""
    beads = [*STRIP["beads"], {"points": [[-8, 0], [-4, 6]], "force": 20}]
    expected, found = (
        pull(
            tmp_path / device, procedure="explicit", stages=[STAGE], beads=beads,
            explicit={"device": device, "precision": precision},
        ).history
        for device in ("cpu", "host")
    )  # fmt: skip
    assert found["bead_1.force"].max() == pytest.approx(FORCE * WIDTH, rel=1e-6)
    within = AGREEMENT if precision == "double" else 1e-2
    for name in ("bead_1.force", "bead_2.force", "friction_energy", "internal_energy", "kinetic_energy"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=within * np.abs(expected[name]).max())
