# SPDX-License-Identifier: Apache-2.0
"""The kernel of contact between faces in space: its tangent, its balance, its search, and its bits on many threads."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core

LAWS = {
    "frictionless": {"mu": 0.0, "limit": np.inf, "part": 0.01},
    "sticking": {"mu": 10.0, "limit": np.inf, "part": 0.4},
    "coulomb": {"mu": 0.1, "limit": np.inf, "part": 0.1},
    "shear": {"mu": 1.0, "limit": 3.0, "part": 0.1},
}


class Problem:
    """A warped slave below a warped master of unlike faces that covers it."""

    def __init__(self, nodes: int, law: str, cells: int = 3) -> None:
        self.rng, self.nodes = np.random.default_rng(3), nodes
        self.law = LAWS[law]
        below, self.slave = self._surface(cells, 0.0, 1.0, 0.0)
        above, master = self._surface(cells + 2, -0.3, 1.6, -0.001)
        self.master = np.ascontiguousarray(master[:, ::-1] + len(below), dtype=np.int32)
        self.x = np.concatenate([below, above])
        self.x_n = self.x - self.rng.uniform(-0.02, 0.02, self.x.shape)
        slots, self.slots = np.unique(self.slave, return_inverse=True)
        self.slots = np.ascontiguousarray(self.slots.reshape(self.slave.shape), dtype=np.int32)
        self.n = len(slots)
        self.pressure = self.rng.uniform(50.0, 100.0, self.n)
        self.shear = self.rng.uniform(-5.0, 5.0, (self.n, 3))
        self.pairs = _core.find_face_pairs(self.slave, self.master, self.x, 0.7, False)

    def _surface(self, cells, start, size, height):
        lines = np.linspace(start, start + size, cells + 1)
        x, y = np.meshgrid(lines, lines, indexing="ij")
        points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)])
        points += self.rng.uniform(-0.05, 0.05, points.shape) * (1.0 / cells, 1.0 / cells, 0.2)
        first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
        quads = first[:, None] + np.array([0, cells + 1, cells + 2, 1])
        faces = quads if self.nodes == 4 else np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
        return points, np.ascontiguousarray(faces, dtype=np.int32)

    def evaluate(self, x, tangent=True):
        one = np.ones(self.n)
        return _core.evaluate_face_interface(
            self.slave, self.master, self.slots, self.pairs, np.ascontiguousarray(x), self.x_n,
            slave_depth=np.full(len(self.slave), 0.3), master_depth=np.full(len(self.master), 0.3),
            held=np.zeros(self.n, dtype=np.uint8), pressure=self.pressure, shear=self.shear,
            slip=np.zeros((self.n, 3)), believed=0 * one, least_weight=1e-6 * one, stiffness=5000 * one,
            shear_limit=self.law["limit"] * one, mu=self.law["mu"], tangential_part=self.law["part"], reach=0.25,
            touching=1e-6, with_tangent=tangent,
        )  # fmt: skip


@pytest.mark.parametrize("nodes", [3, 4])
@pytest.mark.parametrize("law", LAWS)
def test_tangent_between_faces_agrees_with_differences(nodes, law):
    # quadrilaterals that are warped have no rule that is exact: what their polygons cut off moves with them
    problem = Problem(nodes, law)
    found, n = problem.evaluate(problem.x), problem.x.size
    stiffness = np.zeros((n, n))
    for (row, column), block in zip(found.pairs, found.blocks, strict=True):
        stiffness[3 * row : 3 * row + 3, 3 * column : 3 * column + 3] += block
    difference, step = np.zeros((n, n)), 1e-6
    for j in range(n):
        move = np.zeros(n)
        move[j] = step
        ahead, behind = (problem.evaluate(problem.x + s * move.reshape(-1, 3), False).force for s in (1, -1))
        difference[:, j] = -(np.asarray(ahead) - behind).ravel() / (2 * step)
    error = np.abs(stiffness - difference).max() / np.abs(difference).max()
    assert error < (1e-9 if nodes == 3 else 1e-4)
    some = {"sticking": {1}, "coulomb": {1, 2}}.get(law, {2})
    assert some <= set(np.asarray(found.status).tolist())


@pytest.mark.parametrize("nodes", [3, 4])
def test_bodies_push_each_other_with_equal_forces(nodes):
    problem = Problem(nodes, "sticking")
    force = np.asarray(problem.evaluate(problem.x).force)
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()


def test_moments_of_flat_frictionless_faces_balance():
    problem = Problem(3, "frictionless")
    force = np.asarray(problem.evaluate(problem.x).force)
    assert np.abs(np.cross(problem.x, force).sum(axis=0)).max() < 1e-13 * np.abs(force).sum()


@pytest.mark.parametrize("nodes", [3, 4])
def test_pairs_are_those_of_a_search_of_all(nodes):
    problem = Problem(nodes, "frictionless", cells=9)
    boxes = [(problem.x[f].min(axis=1), problem.x[f].max(axis=1)) for f in (problem.slave, problem.master)]
    for margin in (0.05, 0.2):
        found = _core.find_face_pairs(problem.slave, problem.master, problem.x, margin, False)
        (low, high), (other_low, other_high) = boxes
        apart = (low[:, None] > other_high + margin) | (other_low > high[:, None] + margin)
        expected = np.argwhere(~apart.any(axis=2))  # all of them face each other
        assert np.array_equal(found, expected)


@pytest.mark.parametrize("nodes", [3, 4])
def test_threads_change_no_bit_between_faces(nodes):
    problem = Problem(nodes, "coulomb", cells=20)
    before, results = _core.max_threads(), []
    for threads in (1, 3):
        _core.set_threads(threads)
        pairs = _core.find_face_pairs(problem.slave, problem.master, problem.x, 0.1, False)
        found = problem.evaluate(problem.x)
        results.append([pairs, *(np.array(getattr(found, name)) for name in ("force", "pairs", "blocks", "shear"))])
    _core.set_threads(before)
    assert all(np.array_equal(a, b) for a, b in zip(*results, strict=True))
