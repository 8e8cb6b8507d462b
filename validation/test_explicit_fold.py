# SPDX-License-Identifier: Apache-2.0
"""A clamp in space that closes on itself: explicit dynamics against the implicit procedure on the same cells."""

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.process.begin import begin
from tests.problems.touching_bodies import CLAMP, compare_with_implicit, write_case

pytestmark = pytest.mark.validation


def test_a_clamp_closes_with_the_force_of_the_implicit_procedure(tmp_path) -> None:
    run = begin(build_model(read_case(write_case(tmp_path, CLAMP))), threads=1)
    middle, found, expected = compare_with_implicit(run, "top", 1)
    open_, closed = (middle > 0.2) & (middle < 1.4), middle > 1.6
    np.testing.assert_allclose(found[open_], expected[open_], rtol=0.02)
    np.testing.assert_allclose(found[closed], expected[closed], rtol=0.03)
