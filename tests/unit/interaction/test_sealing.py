# SPDX-License-Identifier: Apache-2.0
"""Where a fluid comes to under a sheet that tools seal, on a square grid of cells of 1 mm."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.interaction.sealing import Seal
from presswork.model import FloatArray

N = 11
"""Cells along a side; the fluid begins in the middle one."""


def make_seal() -> tuple[Seal, FloatArray]:
    """Return a seal on the upper side of the grid, and its points."""
    x, y = np.meshgrid(np.arange(N + 1.0), np.arange(N + 1.0), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    number = np.arange(len(points)).reshape(N + 1, N + 1)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    sides = [number[0], number[-1], number[:, 0], number[:, -1]]
    rim = np.concatenate([np.stack([side[:-1], side[1:]], axis=1) for side in sides])
    return Seal(cells.astype(np.int32), np.array([N * N // 2]), rim.astype(np.int32), -1.0), points


def ring(radius: int, pressure: float) -> FloatArray:
    """Return the contact pressures (N, N) of a square ring round the middle."""
    away = np.abs(np.arange(N) - N // 2)
    distance = np.maximum(away[:, None], away[None, :])
    return np.where(distance == radius, pressure, 0.0)


def test_a_fluid_comes_up_to_the_ring_that_holds_it() -> None:
    seal, _ = make_seal()
    contact = ring(2, 3.0) + ring(4, 9.0)
    wet, held = seal.find_wet(contact.ravel(), 2.0)
    assert (wet.sum(), held) == (9, 2.0), "the inner ring presses more"
    wet, held = seal.find_wet(contact.ravel(), 5.0)
    assert (wet.sum(), held) == (49, 5.0), "the outer one does; the inner one is wet"


def test_a_gap_in_a_ring_lets_the_fluid_through_and_a_patch_does_not_keep_it_off() -> None:
    seal, _ = make_seal()
    contact = ring(2, 8.0) + ring(4, 9.0)
    contact[3, 5] = 0.0
    contact[5, 6] = 8.0
    wet, _ = seal.find_wet(contact.ravel(), 5.0)
    assert wet.sum() == 49, "the open ring, and the lone cell, are patches under which it comes"


def test_a_closed_ring_beside_the_fluid_keeps_its_inside_dry() -> None:
    seal, _ = make_seal()
    contact = ring(5, 9.0)
    contact[1:4, 1:4] = 8.0
    contact[2, 2] = 0.0
    wet, _ = seal.find_wet(contact.ravel(), 5.0)
    assert wet.sum() == 81 - 9


def test_a_fluid_leaks_down_to_what_the_best_ring_holds() -> None:
    seal, _ = make_seal()
    wet, held = seal.find_wet((ring(2, 3.0) + ring(4, 4.0)).ravel(), 10.0)
    assert held == pytest.approx(4.0, rel=1e-5)
    assert wet.sum() == 49


def test_cells_become_wet_and_pressures_are_lost_little_by_little() -> None:
    seal, _ = make_seal()
    wet, lost = seal.advance(ring(2, 3.0).ravel(), 10.0, (seal.at_rest(), 0.0), 0.25)
    assert lost == pytest.approx(0.25 * 7.0)
    assert sorted(set(wet)) == [0.0, 0.25, 1.0]
    wet, lost = seal.advance(ring(2, 3.0).ravel(), 10.0, (wet, lost), 0.25)
    assert lost == pytest.approx(1.75 + 0.25 * 5.25)


def test_contact_is_the_force_that_pushes_as_the_fluid_does_over_the_area() -> None:
    seal, points = make_seal()
    below, above = np.zeros_like(points), np.zeros_like(points)
    area = np.ones((N + 1, N + 1))
    area[[0, -1]] *= 0.5
    area[:, [0, -1]] *= 0.5
    below[:, 2], above[:, 2] = -4.0 * area.ravel(), 7.0 * area.ravel()
    np.testing.assert_allclose(seal.measure_contact(points, np.array([below, above])), 4.0, rtol=1e-12)
