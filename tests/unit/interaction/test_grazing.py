# SPDX-License-Identifier: Apache-2.0
"""The part of constant shear at nodes that neither push nor lift off."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from presswork.interaction.plane.grazing import Drag, Grazing

TOLERANCE, LARGEST = 0.1, 1000.0


def settle(respond: Callable[[float], float], part: float = 1.0) -> tuple[float, float, int]:
    """Part and push of a node that pushes by respond(part), and the updates until it is right."""
    grazing, parts, nodes = Grazing(1), np.array([part]), np.array([True])
    for count in range(20):
        push = np.array([respond(parts[0])])
        drag = Drag(np.array([100.0]), np.array([1.0]))
        if not grazing.update(parts, nodes, push, drag, tolerance=TOLERANCE, credible=0.0, largest=LARGEST):
            return float(parts[0]), float(push[0]), count
    raise AssertionError("does not settle")


@pytest.mark.parametrize("part", [1.0, 0.3, 0.0])
@pytest.mark.parametrize(("free", "slope"), [(60.0, 150.0), (3.0, 400.0), (390.0, 400.0)])
def test_the_part_is_found_at_which_a_node_neither_pushes_nor_pulls(free, slope, part) -> None:
    found, push, count = settle(lambda p: free - slope * p, part)
    assert -TOLERANCE <= push <= 1e-3 * LARGEST
    assert found == pytest.approx(free / slope, abs=1e-3 * LARGEST / slope)
    assert count <= 8


def test_it_is_found_where_only_a_small_part_limits_the_friction() -> None:
    """A node that hangs has less friction than the law allows: its push does not follow the part at first."""
    found, push, count = settle(lambda p: max(7.0 - 300.0 * p, -4.0))
    assert -TOLERANCE <= push <= 1e-3 * LARGEST
    assert found == pytest.approx(7.0 / 300.0, abs=0.004)
    assert count <= 10


def test_the_search_begins_where_the_part_limits_the_friction() -> None:
    grazing, parts = Grazing(1), np.array([1.0])
    drag = Drag(np.array([10.0]), np.array([0.2]))
    grazing.update(parts, np.array([True]), np.array([-0.5]), drag, tolerance=TOLERANCE, credible=0.0, largest=LARGEST)
    assert 0.0 < parts[0] < 0.2


def test_a_node_that_pushes_has_the_whole_shear_and_one_that_always_pulls_none() -> None:
    assert settle(lambda p: 500.0 - 150.0 * p, part=0.2)[0] == 1.0
    grazing, parts = Grazing(2), np.array([1.0, 1.0])
    for _ in range(4):
        pulls = np.array([-50.0, -50.0])
        wrong = grazing.update(
            parts,
            np.array([True, False]),
            pulls,
            Drag(-pulls, np.ones(2)),
            tolerance=TOLERANCE,
            credible=0.0,
            largest=LARGEST,
        )
        assert wrong == 1
    np.testing.assert_array_equal(parts, [0.0, 1.0])


def test_far_from_equilibrium_a_part_stays_as_it_is_but_is_not_right() -> None:
    grazing, parts = Grazing(1), np.array([1.0])
    nodes, push = np.array([True]), np.array([-5.0])
    assert (
        grazing.update(parts, nodes, push, Drag(-push, np.ones(1)), tolerance=TOLERANCE, credible=10.0, largest=LARGEST)
        == 1
    )
    assert parts[0] == 1.0
