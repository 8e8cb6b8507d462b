# SPDX-License-Identifier: Apache-2.0
"""Rings with interference against Lame, and a die under a disc against Boussinesq.

Two rings of one steel, bore a, joint c, outside b, radial interference d:

    p = (E d / c) (c^2 - a^2) (b^2 - c^2) / (2 c^2 (b^2 - a^2))

and hoop stress -2 p c^2 / (c^2 - a^2) at the bore, p (b^2 + c^2) / (b^2 - c^2) at the bore of the ring.
"""

from __future__ import annotations

import numpy as np
import pytest

from presswork.dies.hand_over import hand_over
from presswork.dies.meshes import mesh_body
from presswork.dies.structure import DieStructure
from presswork.model import DieBody, DiePart
from tests.problems.die_bodies import CARBIDE, STEEL, make_rings, press_line

A, C, B, HEIGHT = 10.0, 20.0, 40.0, 4.0


def measure(rings: DieStructure, pressure: float = 0.0) -> tuple[float, float, float, float]:
    """Return pressure of the joint, hoop stress at both bores [MPa], and displacement of the bore [mm]."""
    forces = np.zeros(rings.points.shape)
    if pressure:
        load = press_line((A, 0.0), (A, HEIGHT), 7, pressure, is_ring=True)
        forces, _ = hand_over(load, rings.points, rings.profile, is_ring=True)
    answer = rings.answer(forces)
    bore, joint = rings.profile, rings.pairs[:, 1]
    push = answer.push.sum() / (2.0 * np.pi * C * HEIGHT)
    return push, answer.stress[bore, 2].mean(), answer.stress[joint, 2].mean(), answer.displacement[bore, 0].mean()


def test_two_rings_of_steel_press_on_each_other_as_lame_says() -> None:
    joint, bore, ring, _ = measure(make_rings(STEEL, 0.04))
    assert joint == pytest.approx(126.0, rel=1e-4)
    assert bore == pytest.approx(-336.0, rel=5e-3)
    assert ring == pytest.approx(210.0, rel=5e-3)


def test_a_carbide_core_is_pressed_harder() -> None:
    joint, bore, _, _ = measure(make_rings(CARBIDE, 0.04))
    assert joint == pytest.approx(167.386, rel=1e-4)
    assert bore == pytest.approx(-446.36, rel=5e-3)


def test_three_rings_press_on_each_other_as_lame_says() -> None:
    """Radii 10, 16, 25, 40; interference 0.03 and 0.05: both joints close together, in plane stress."""
    radii, overlap = (10.0, 16.0, 25.0, 40.0), (0.03, 0.05)
    young, poisson = STEEL.young, STEEL.poisson

    def widen(inner: float, outer: float, inside: float, outside: float, r: float) -> float:
        """Displacement at r of a ring under pressures inside and outside [MPa]."""
        area = outer**2 - inner**2
        even = (1 - poisson) * (inside * inner**2 - outside * outer**2) * r / area
        return (even + (1 + poisson) * (inside - outside) * inner**2 * outer**2 / (area * r)) / young

    def part(p: float, q: float) -> np.ndarray:
        a, b, c, d = radii
        return np.array([widen(b, c, p, q, b) - widen(a, b, 0, p, b), widen(c, d, q, 0, c) - widen(b, c, p, q, c)])

    exact = np.linalg.solve(np.column_stack([part(1.0, 0.0), part(0.0, 1.0)]), overlap)
    profile = np.array([[radii[0], 0.0, radii[0], HEIGHT, 0.0, 0.0, 0.0]])
    given = zip(radii[1:], (0.0, *overlap), strict=True)
    parts = tuple(DiePart(steel=STEEL, outer=r, held=("bottom",), interference=d) for r, d in given)
    body = DieBody(0.6, parts)
    die = DieStructure(mesh_body(profile, body), body, "axisymmetric", 1.0)
    push = die.answer(np.zeros(die.points.shape)).push
    at = die.points[die.pairs[:, 0], 0]
    found = [push[at == r].sum() / (2.0 * np.pi * r * HEIGHT) for r in radii[1:3]]
    np.testing.assert_allclose(found, exact, rtol=1e-4)


def test_an_inner_pressure_adds_the_stress_of_one_thick_ring() -> None:
    rings = make_rings(STEEL, 0.04)
    _, before, _, at_rest = measure(rings)
    _, bore, _, moved = measure(rings, 1000.0)
    assert bore - before == pytest.approx(1133.33, rel=5e-3)
    assert moved - at_rest == pytest.approx(0.068254, rel=5e-3)


def test_the_best_pair_yields_at_both_bores_at_once() -> None:
    """c = sqrt(a b) and a pressure of 750 for a yield stress of 1000 (Tresca), where one ring bears 468.75."""
    rings = make_rings(STEEL, 0.071429)
    load = press_line((A, 0.0), (A, HEIGHT), 7, 750.0, is_ring=True)
    forces, _ = hand_over(load, rings.points, rings.profile, is_ring=True)
    stress = rings.answer(forces).stress
    for nodes in (rings.profile, rings.pairs[:, 1]):
        tresca = stress[nodes, 2] - stress[nodes, 0]
        assert tresca.mean() == pytest.approx(1000.0, rel=5e-3)


def test_a_ring_that_is_too_large_lifts_off_and_carries_nothing() -> None:
    rings = make_rings(STEEL, 0.0)
    load = press_line((A, 0.0), (A, HEIGHT), 7, -1000.0, is_ring=True)  # a bore that is drawn inwards
    forces, _ = hand_over(load, rings.points, rings.profile, is_ring=True)
    answer = rings.answer(forces)
    assert not answer.push.any()
    assert np.abs(answer.stress[rings.part_of(1)]).max() < 1e-6
    alone = 1000.0 * (C**2 + A**2) / (C**2 - A**2)
    assert -answer.stress[rings.profile, 2].mean() == pytest.approx(alone, rel=5e-3)


def test_a_disc_presses_into_a_half_space_as_boussinesq_says() -> None:
    """1000 MPa on a radius of 20: 0.173333 in the middle, 0.110347 at the edge; the block of 1500 mm is 1 % short."""
    body = DieBody(1.0, (DiePart(steel=STEEL, outer=1500.0, bottom=-1500.0, clamped=("bottom",)),))
    profile = np.array([[0.0, 0.0, 60.0, 0.0, 0.0, 0.0, 0.0]])
    block = DieStructure(mesh_body(profile, body), body, "axisymmetric", 1.0)
    load = press_line((0.0, 0.0), (20.0, 0.0), 30, 1000.0, is_ring=True)
    forces, _ = hand_over(load, block.points, block.profile, is_ring=True)
    down = -block.answer(forces).displacement[block.profile, 1]
    x = block.points[block.profile, 0]
    middle, edge = np.interp([0.0, 20.0], np.sort(x), down[np.argsort(x)])
    assert middle == pytest.approx(0.173333, rel=1e-2)
    assert middle - edge == pytest.approx(0.173333 - 0.110347, rel=5e-3)
