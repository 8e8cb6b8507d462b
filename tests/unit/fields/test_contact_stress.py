# SPDX-License-Identifier: Apache-2.0
"""The surface in contact: areas, smoothing that keeps sum and cubics, excess that moves to the nearest room."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.fields.contact_stress import Chain, ContactSurface, confine

COUNT = 21
DEPTH = 2.0


def flat_surface(held: np.ndarray, gap: np.ndarray | None = None, *, quadratic: bool = False) -> ContactSurface:
    """A straight boundary along x with nodes 1 mm apart."""
    points = np.column_stack([np.arange(len(held), dtype=float), np.zeros(len(held))])
    first = np.arange(0, len(held) - 1, 2 if quadratic else 1, dtype=np.int32)
    edges = np.column_stack([first, first + 2, first + 1] if quadratic else [first, first + 1])
    opening = np.where(held, 0.0, np.nan) if gap is None else gap
    return ContactSurface(edges, points, held, opening, depth=DEPTH)


@pytest.mark.parametrize("quadratic", [False, True])
def test_smoothing_removes_an_alternation_and_keeps_the_force(quadratic) -> None:
    held = np.ones(COUNT, dtype=bool)
    surface = flat_surface(held, quadratic=quadratic)
    x = np.arange(COUNT, dtype=float)
    force = surface.nodal_area * (100 + 40 * (-1.0) ** x)
    smoothed = surface.smooth(force, held)
    np.testing.assert_allclose(surface.stress_of(smoothed)[3:-3], 100.0, rtol=1e-12)
    assert smoothed.sum() == pytest.approx(force.sum(), rel=1e-14)


def test_smoothing_keeps_a_cubic_stress_away_from_the_ends() -> None:
    held = np.ones(COUNT, dtype=bool)
    surface = flat_surface(held)
    x = np.linspace(-1, 1, COUNT)
    stress = 50 + 30 * x - 20 * x**2 + 70 * x**3
    smoothed = surface.stress_of(surface.smooth(surface.nodal_area * stress, held))
    np.testing.assert_allclose(smoothed[2:-2], stress[2:-2], rtol=1e-12)


def test_nodal_forces_of_a_uniform_pressure_on_quadratic_edges_give_it_back() -> None:
    held = np.ones(COUNT, dtype=bool)
    surface = flat_surface(held, quadratic=True)
    force = np.zeros(COUNT)
    for first in range(0, COUNT - 1, 2):
        force[[first, first + 1, first + 2]] += 70.0 * DEPTH * 2 * np.array([1, 4, 1]) / 6
    np.testing.assert_allclose(surface.stress_of(surface.share(force)), 70.0, rtol=1e-13)


@pytest.mark.parametrize(("opening", "area"), [(0.0, 1.0), (0.25, 0.75), (0.5, 0.5), (2.0, 0.5), (np.nan, 0.5)])
def test_contact_reaches_into_the_next_edge_as_far_as_that_is_flat(opening, area) -> None:
    held = np.arange(COUNT) <= 10
    gap = np.where(held, 0.0, opening)
    surface = flat_surface(held, gap)
    assert surface.nodal_area[10] == pytest.approx(DEPTH * area)
    assert surface.nodal_area[11] == 0.0


def test_a_lone_node_has_both_edges_beside_it() -> None:
    held = np.arange(COUNT) == 10
    surface = flat_surface(held, np.where(held, 0.0, 0.4))
    assert surface.nodal_area[10] == pytest.approx(DEPTH)


def test_excess_moves_to_the_nearest_room_of_the_own_patch() -> None:
    place = np.array([0.0, 1.0, 2.0, 3.0, 3.5])
    chain = Chain(np.arange(5), place, np.array([0, 0, 0, 0, 1]))
    area = np.array([1.0, 1.0, 1.0, 2.0, 2.0])
    stress = np.array([10.0, 10.0, 40.0, 90.0, 0.0])
    confined = confine(chain, stress, area, np.full(5, -50.0), np.full(5, 50.0))
    np.testing.assert_allclose(confined, [40.0, 50.0, 50.0, 50.0, 0.0], atol=1e-12)
    assert confined @ area == pytest.approx(stress @ area, rel=1e-15)


def test_pulls_are_taken_from_the_neighbours() -> None:
    chain = Chain(np.arange(4), np.arange(4.0), np.zeros(4, dtype=int))
    confined = confine(chain, np.array([30.0, 30.0, -40.0, 20.0]), np.ones(4), np.zeros(4), np.full(4, np.inf))
    assert confined.min() == 0.0
    assert confined.sum() == pytest.approx(40.0)


def test_what_finds_no_room_within_reach_stays() -> None:
    chain = Chain(np.arange(7), np.arange(7.0), np.zeros(7, dtype=int))
    stress = np.array([0.0, 0.0, 5.0, 20.0, 5.0, 0.0, 0.0])
    confined = confine(chain, stress, np.ones(7), np.full(7, -6.0), np.full(7, 6.0), reach=1)
    np.testing.assert_allclose(confined, [0, 0, 6, 18, 6, 0, 0])
