# SPDX-License-Identifier: Apache-2.0
"""A bulge test is computed, and the law of its sheet found again from pressure, height, radius and thickness."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.material.bulge import BulgeSizes, read_bulge
from presswork.material.fit_laws import fit_laws
from presswork.recorder import run_model

pytestmark = pytest.mark.validation
YOUNG, POISSON = 206e3, 0.3


def test_a_computed_bulge_test_gives_back_the_flow_curve_of_its_sheet(tmp_path) -> None:
    """DC04 yields in balanced biaxial tension as along the rolling direction. Within 0.5 % from 0.02 to 0.8."""
    outcome = run_model(build_model(read_case(copy_example("bulge_test", tmp_path))), tmp_path / "out", threads=1)
    assert outcome.status == "completed", outcome.reason
    test = read_bulge(tmp_path / "out" / "history.csv", BulgeSizes(1.0), YOUNG, POISSON)
    (fit,) = fit_laws(test.as_tension(YOUNG), "swift", YOUNG)
    assert fit.relative < 0.01
    p = np.linspace(0.02, 0.8, 40)
    np.testing.assert_allclose(fit.stress(p), 529.8 * (0.00187 + p) ** 0.21, rtol=0.005)
