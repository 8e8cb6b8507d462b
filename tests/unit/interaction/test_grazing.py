# SPDX-License-Identifier: Apache-2.0
"""The part of constant shear at nodes that neither push nor lift off."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.interaction.grazing import Grazing

TOLERANCE, LARGEST = 0.1, 1000.0


def settle(free: float, slope: float, part: float = 1.0) -> tuple[float, float, int]:
    """Part and push of a node that pushes by free - slope part, and the updates until nothing changes."""
    grazing, parts, nodes = Grazing(1), np.array([part]), np.array([True])
    for count in range(20):
        push = np.array([free - slope * parts[0]])
        if not grazing.update(parts, nodes, push, TOLERANCE, LARGEST):
            return float(parts[0]), float(push[0]), count
    raise AssertionError("does not settle")


@pytest.mark.parametrize("part", [1.0, 0.3, 0.0])
@pytest.mark.parametrize(("free", "slope"), [(60.0, 150.0), (3.0, 400.0), (390.0, 400.0)])
def test_the_part_is_found_at_which_a_node_neither_pushes_nor_pulls(free, slope, part) -> None:
    """The response is linear, so the secant rule meets it as soon as it has two points."""
    found, push, count = settle(free, slope, part)
    assert -TOLERANCE <= push <= 1e-3 * LARGEST
    assert found == pytest.approx(free / slope, abs=1e-3 * LARGEST / slope)
    assert count <= 5


def test_a_node_that_pushes_has_the_whole_shear_and_one_that_always_pulls_none() -> None:
    assert settle(500.0, 150.0, part=0.2)[0] == 1.0
    grazing, parts = Grazing(2), np.array([1.0, 1.0])
    for _ in range(4):
        grazing.update(parts, np.array([True, False]), np.array([-50.0, -50.0]), TOLERANCE, LARGEST)
    np.testing.assert_array_equal(parts, [0.0, 1.0])
