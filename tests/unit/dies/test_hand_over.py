# SPDX-License-Identifier: Apache-2.0
"""Loads handed over to a die: force and, in plane strain, moment stay."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.dies.hand_over import ToolLoad, hand_over, moment_of
from presswork.dies.meshes import mesh_body
from presswork.dies.structure import DieStructure
from presswork.model import DieBody, DiePart
from tests.problems.die_bodies import STEEL, press_line

# a wall, a round of 4 mm, a floor; the metal is on the right
ROUND = np.array(
    [[0.0, 20.0, 0.0, 4.0, 0.0, 0.0, 0.0], [0.0, 4.0, 4.0, 0.0, 4.0, 4.0, 1.0], [4.0, 0.0, 30.0, 0.0, 0.0, 0.0, 0.0]]
)
BODY = DieBody(1.0, (DiePart(steel=STEEL, corners=((30.0, -20.0), (-20.0, -20.0), (-20.0, 20.0)), held=("bottom",)),))


def push_round(seed: int) -> ToolLoad:
    """Two patches with forces of any direction: over the round, and on the floor."""
    rng = np.random.default_rng(seed)
    angle = np.linspace(0.0, 1.0, 9) ** 1.3 * 0.5 * np.pi
    over = 4.0 - 4.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    floor = np.column_stack([np.sort(rng.uniform(8.0, 25.0, 6)), np.zeros(6)])
    points = np.concatenate([over, floor, [[28.0, 0.0]]])
    return ToolLoad(points, rng.normal(size=points.shape) * 1e4, np.array([0] * 9 + [1] * 6 + [2]))


@pytest.mark.parametrize("seed", range(5))
def test_force_and_moment_are_kept_in_plane_strain(seed: int) -> None:
    (mesh,) = mesh_body(ROUND, BODY)
    load = push_round(seed)
    forces, away = hand_over(load, mesh.points, mesh.profile, is_ring=False)
    size = np.linalg.norm(load.force, axis=1).sum()
    np.testing.assert_allclose(forces.sum(axis=0), load.force.sum(axis=0), atol=1e-12 * size)
    apart = moment_of(mesh.points, forces) - moment_of(load.points, load.force)
    assert abs(apart) < 1e-12 * size * 30.0
    assert away < 0.01, "middles of edges lie on the arc"
    loaded = np.flatnonzero((forces != 0.0).any(axis=1))
    assert np.isin(loaded, mesh.profile).all()


def test_force_is_kept_in_axisymmetry() -> None:
    (mesh,) = mesh_body(ROUND + np.array([40.0, 0.0] * 3 + [0.0]), BODY_OF_RING)
    load = push_round(7)
    load = ToolLoad(load.points + np.array([40.0, 0.0]), load.force, load.patch)
    forces, _ = hand_over(load, mesh.points, mesh.profile, is_ring=True)
    size = np.linalg.norm(load.force, axis=1).sum()
    np.testing.assert_allclose(forces.sum(axis=0), load.force.sum(axis=0), atol=1e-12 * size)


BODY_OF_RING = DieBody(
    1.0, (DiePart(steel=STEEL, corners=((70.0, -20.0), (20.0, -20.0), (20.0, 20.0)), held=("bottom",)),)
)


@pytest.mark.parametrize("is_ring", [False, True])
def test_an_even_pressure_is_even_in_the_die(is_ring: bool) -> None:
    """A patch test: nodes of the workpiece and of the die do not meet, and the stress is exact."""
    profile = np.array([[0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0]])
    held = ("bottom",) if is_ring else ("bottom", "left")
    body = DieBody(1.3, (DiePart(steel=STEEL, outer=10.0, bottom=-15.0, held=held),))
    analysis = "axisymmetric" if is_ring else "plane_strain"
    die = DieStructure(mesh_body(profile, body), body, analysis, 2.0)
    load = press_line((0.0, 0.0), (10.0, 0.0), 7, 400.0, is_ring=is_ring, depth=2.0)
    forces, _ = hand_over(load, die.points, die.profile, is_ring=is_ring)
    stress = die.answer(forces).stress
    out_of_plane = 0.0 if is_ring else -0.3 * 400.0
    np.testing.assert_allclose(stress, np.broadcast_to([0.0, -400.0, out_of_plane, 0.0], stress.shape), atol=1e-6)
