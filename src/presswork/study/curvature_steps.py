# SPDX-License-Identifier: Apache-2.0
"""Steps of a correction for springback, by how the part's curvature answers the tools' place by place.

Springback is a change of curvature. Where the sheet yields in the tools, a change of their curvature stays in the part:
it answers by about one. Where it stays elastic, as in a flat bottom, it springs back whole: the answer is near zero.
Walls answer by more than one. So one factor for the whole part, or a few as in Anderson's acceleration, cannot fit.

The answer g of each place is the secant of its change of curvature over that of the tools, by least squares over its
neighbours and the last loops. With B the change of curvature by displacement, A = B'B + stretching, A_g = B'gB +
stretching, a correction d moves the part by A^-1 A_g d. The step is the d that leaves least of the deviation, with a
penalty on bending shorter than the tools can follow. A place that does not answer is not bent for its own sake.

Before anything is known answers follow from the sheet's plastic strain; without it the first step is the whole
deviation (Gan and Wagoner 2004). Answers of elastic places grow with the bend (0.2 to 0.7 at strains of the faces of
0.1 to 1 %), so the step by the first secant is halved. Where a step has turned the deviation round the next one starts
between the last two loops, and after a loop that is worse than one before from the better one.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg, splu
from scipy.spatial import cKDTree

from presswork.geometry.sprung.bending_of_surface import find_edges
from presswork.model import FloatArray, IntArray

_LEAST, _MOST = 0.15, 4.0
"""Answer below which a place counts as one that does not answer, and the largest."""
_NEIGHBOURS = 2.0
"""Width of the bell of neighbours that share an answer, over the cells' edge."""
_SMOOTH, _FOLLOWS = 1.3, 0.7
"""Lengths over the cells' edge: of the noise that is kept out of answers, and of the bending that tools follow."""
_KEPT, _FADES = 3, 0.2
"""Changes of the tools that count, and weight of each over the next one's."""
_PRIOR = 0.1
"""Weight of the answer that is expected, over the median of the places' weights."""
_CONVERGES, _DAMPING = 0.5, 0.07
"""Deviation over that of the loop before, up to which loops are combined, and the damping of their shares."""
_ELASTIC, _YIELDED = 0.2, 0.005
"""Answer expected of a place without plastic strain, and the strain of its faces from which on one is expected [1]."""
_FIRST_SECANT = 0.5
"""Part of the step that is taken after one change of the tools."""
_ALIKE = 0.3
"""Width of the bell of expected answers, within which neighbours share one: a flat bottom and its radius do not."""
_WORSE = 1.2
"""Deviation over the least before, from which on a loop is worse."""
_EXACT, _ITERATIONS = 1e-8, 1000
"""Residual of a step over that of none, at 1e-4 of which steps bend places by ten times too much, and most iterations.
"""
_REVERSED = 0.3
"""Cosine of a deviation and the last one's reverse, from which on the next step starts between the two."""
_HELD = 1e-10
"""Weight of rigid motions, which neither bend nor stretch, over the cells' area."""


def expect_answers(strain: FloatArray) -> FloatArray:
    """Return the answers expected where the faces of the sheet have this equivalent plastic strain (n,) [1]."""
    return np.clip(strain / _YIELDED, _ELASTIC, 1.0)


class CurvatureSteps:
    """Finds the correction of a part whose deviation vanishes."""

    def __init__(
        self,
        points: FloatArray,
        triangles: IntArray,
        weight: FloatArray,
        planes: tuple[bool, bool],
        thickness: float,
        expected: FloatArray | None = None,
    ) -> None:
        """points: of the part (n, 3) [mm]; weight: area of each (n,) [mm2]; thickness: of the sheet [mm].

        expected: answers before any is known (n,); None: one, and the first step is the whole deviation.
        """
        edges = find_edges(points, triangles, planes)
        cell = points[triangles]
        areas = np.linalg.norm(np.cross(cell[:, 1] - cell[:, 0], cell[:, 2] - cell[:, 0]), axis=1)
        size = float(np.sqrt(np.median(areas)))  # of a square of two triangles
        stretching = 12.0 / thickness**2 * edges.stretching.T @ edges.stretching
        stretching += _HELD * size**2 * sparse.identity(3 * len(points))
        self._bending, self._ends, self._rest = edges.bending, edges.ends, stretching
        square = edges.bending.T @ edges.bending
        images = 2.0 ** sum(planes)
        self._area = images * np.repeat(weight, 3)
        area = sparse.diags(self._area)
        self._whole = splu((square + stretching).tocsc())
        self._smooth = splu((area + (_SMOOTH * size) ** 4 * square).tocsc())
        self._penalty = (_FOLLOWS * size) ** 4 * (square + 0.1 * stretching)
        self._near = splu((area + self._penalty).tocsc())
        tree = cKDTree(points)
        bell = tree.sparse_distance_matrix(tree, 2.5 * _NEIGHBOURS * size, output_type="coo_matrix")
        self._expected = np.ones(len(points)) if expected is None else expected
        unlike = (self._expected[bell.row] - self._expected[bell.col]) / _ALIKE
        value = np.exp(-0.5 * (bell.data / (_NEIGHBOURS * size)) ** 2 - 0.5 * unlike**2)
        self._bell = sparse.csr_matrix((value, (bell.row, bell.col)), bell.shape)
        self._bell.setdiag(1.0)
        self._is_blind = expected is None
        self._corrections: list[FloatArray] = []
        self._deviations: list[FloatArray] = []
        self._best: tuple[FloatArray, FloatArray] | None = None

    def step(self, correction: FloatArray, off: FloatArray) -> FloatArray:
        """Return the next correction (n, 3) from one and how far it leaves the part off its goal (n, 3) [mm]."""
        self._corrections.append(correction.ravel())
        self._deviations.append(off.ravel())
        del self._corrections[: -_KEPT - 1], self._deviations[: -_KEPT - 1]
        if len(self._corrections) == 1 and self._is_blind:
            self._best = self._corrections[0], self._deviations[0]
            return correction - off
        base, rest = self._start()
        part = _FIRST_SECANT if len(self._corrections) == 2 and not self._is_blind else 1.0
        return np.asarray((base + part * self._solve(rest)).reshape(off.shape))

    def _start(self) -> tuple[FloatArray, FloatArray]:
        """Return the correction from which the step is taken, and the deviation that it leaves."""
        now = self._corrections[-1], self._deviations[-1]
        before, self._best = self._best, self._best if self._is_worse(1.0) else now
        if len(self._corrections) > 1:
            last, other = self._deviations[-2:]
            changed, area = other - last, self._area
            if (area * last) @ other < -_REVERSED * self._size(last) * self._size(other):
                share = float((area * changed) @ other) / self._size(changed) ** 2
                return now[0] - share * (now[0] - self._corrections[-2]), other - share * changed
        if before is not None and self._is_worse(_WORSE):
            return before
        return self._combine()

    def _is_worse(self, times: float) -> bool:
        """Return whether the last loop's deviation is so many times that of the best."""
        return self._best is not None and self._size(self._deviations[-1]) > times * self._size(self._best[1])

    def _solve(self, rest: FloatArray) -> FloatArray:
        """Return the step that leaves least of a deviation."""
        answer = self.find_answers()[self._ends].mean(axis=1)
        partly = (self._bending.T @ sparse.diags(answer) @ self._bending + self._rest).tocsc()

        def respond(d: FloatArray) -> FloatArray:
            return np.asarray(self._whole.solve(partly @ d))

        def pull(r: FloatArray) -> FloatArray:
            return np.asarray(partly @ self._whole.solve(self._area * r))

        shape = (rest.size, rest.size)
        normal = LinearOperator(shape, matvec=lambda d: pull(respond(d)) + self._penalty @ d, dtype=float)
        near = LinearOperator(shape, matvec=self._near.solve, dtype=float)
        step, _ = cg(normal, -pull(rest), rtol=_EXACT, maxiter=_ITERATIONS, M=near)
        return np.asarray(step)

    def _size(self, displacement: FloatArray) -> float:
        return float(np.linalg.norm(np.sqrt(self._area) * displacement))

    def _combine(self) -> tuple[FloatArray, FloatArray]:
        """Return the correction from which the step is taken, and the deviation that it would leave.

        Where each step has halved the deviation, differences of the loops are combined to the least (Anderson
        1965, Iterative procedures for nonlinear integral equations, J. ACM 12, 547), damped against noise.
        """
        root = np.sqrt(self._area)
        size = np.array([self._size(r) for r in self._deviations])
        if len(size) == 1 or (size[1:] > _CONVERGES * size[:-1]).any():
            return self._corrections[-1], self._deviations[-1]
        moved, changed = np.diff(np.array(self._corrections), axis=0), np.diff(np.array(self._deviations), axis=0)
        columns = (root * changed).T
        square = columns.T @ columns
        square += _DAMPING**2 * np.trace(square) * np.eye(len(square))
        share = np.linalg.solve(square, columns.T @ (root * self._deviations[-1]))
        return self._corrections[-1] - share @ moved, self._deviations[-1] - share @ changed

    def find_answers(self) -> FloatArray:
        """Return how each point's curvature answers that of the tools (n,), from the last loops."""
        smooth = [self._smooth.solve(self._area * x) for x in (*self._corrections, *self._deviations)]
        count, points = len(self._corrections), self._area.size // 3
        both, own = np.zeros(points), np.zeros(points)
        for k in range(1, count):
            weight = _FADES ** (count - 1 - k)
            tools = self._bending @ (smooth[k] - smooth[k - 1])
            part = self._bending @ (smooth[count + k] - smooth[count + k - 1])
            for end in self._ends.T:
                both += weight * np.bincount(end, tools * part, points)
                own += weight * np.bincount(end, tools**2, points)
        both, own = self._bell @ both, self._bell @ own
        prior = _PRIOR * float(np.median(own)) + np.finfo(float).tiny
        answer = np.minimum((both + prior * self._expected) / (own + prior), _MOST)
        return np.asarray(np.where(answer < _LEAST, 0.0, answer))
