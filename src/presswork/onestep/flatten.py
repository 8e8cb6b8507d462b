# SPDX-License-Identifier: Apache-2.0
"""Surfaces laid flat with little distortion: the one-step solver's first guess.

Least-squares conformal map (Levy, Petitjean, Ray & Maillot 2002), then the symmetric Dirichlet energy (Smith & Schaefer
2015), which grows without bound as a triangle collapses, so that none turns over. Newton's method with the Hessian's
negative eigenvalue left out, which is known in closed form (Smith, De Goes & Kim 2019).
"""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import SolverError
from presswork.mesh.checks import MeshError
from presswork.mesh.triangles import double_areas, find_rims
from presswork.model import BoolArray, FloatArray, IntArray

_ROUNDS = 30
_ENOUGH = 1e-2
"""Fall of the energy in a round, over itself, that ends the minimisation: it is a first guess."""
_STIFFEST_TURN = 1e-3
"""Least eigenvalue of a triangle's turning, which else costs nothing; a stretch has 8."""


def flatten(points: FloatArray, triangles: IntArray, outline: IntArray, *, threads: int = 0) -> FloatArray:
    """Lay a sheet flat; return its places (n_points, 2) [mm], the triangles counter-clockwise, in no chosen position.

    points (n_points, 3), triangles (n, 3); outline: the points along the outer rim in order. Raises MeshError.
    """
    sheet = _Sheet(points, triangles, threads)
    try:
        flat = sheet.map_conformally(outline)
        if not np.isfinite(flat).all() or (_signed_areas(flat, triangles) <= 0.0).any():
            flat = _map_to_circle(points, triangles, outline, threads)
        flat = flat * np.sqrt(sheet.areas.sum() / _signed_areas(flat, triangles).sum())
        return sheet.relax(flat)
    except SolverError as error:
        raise MeshError(
            f"the part cannot be laid flat: {error}", "check that it is one sheet without tunnels"
        ) from error


class _Sheet:
    """Triangles with two freedoms a corner, and the solver of their equations."""

    def __init__(self, points: FloatArray, triangles: IntArray, threads: int) -> None:
        normal = double_areas(points, triangles)
        first, second = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
        length, size = np.linalg.norm(first, axis=1), np.linalg.norm(normal, axis=1)
        # corners at (0, 0), (length, 0), (x, y) in the triangle's plane
        x, y = np.einsum("ni,ni->n", first, second) / length, size / length
        self.gradient = np.array([[-y, x - length], [y, -x], [np.zeros_like(y), length]]) / size
        """Gradients of the corners' shape functions (3, 2, n) [1/mm]."""
        self.areas = 0.5 * size
        self.triangles = np.ascontiguousarray(triangles, dtype=np.int32)
        self._n = len(points)
        self._assembler = _core.Assembler(self._n, [self.triangles], symmetric=True)
        indptr, indices = self._assembler.indptr, self._assembler.indices
        self._solver = make_solver(indptr, indices, symmetric=True, threads=threads or _core.max_threads())

    def _solve(self, stiffness: FloatArray, force: FloatArray, held: BoolArray, value: FloatArray) -> FloatArray:
        """Return the places (n_points, 2) that stiffness (6, 6, n) and nodal forces (n_points, 2) give."""
        data = np.zeros(len(self._assembler.indices))
        turned, frames = np.zeros(self._n, dtype=np.uint8), np.zeros((self._n, 2, 2))
        self._assembler.assemble_matrix([_pack(stiffness)], turned, frames, data)
        right = force.ravel().copy()
        scale = float(np.abs(data).max())
        self._assembler.constrain(held.ravel().astype(np.uint8), value.ravel(), scale, data, right)
        self._solver.factorise(data)
        return self._solver.solve(right).reshape(-1, 2)

    def map_conformally(self, outline: IntArray) -> FloatArray:
        """Return the least-squares conformal map, two points of the rim pinned."""
        bx, by = self.gradient.swapaxes(0, 1)
        modes = np.stack([np.stack([bx, -by], axis=1), np.stack([by, bx], axis=1)]).reshape(2, 6, -1)
        stiffness = np.einsum("kan,kbn,n->abn", modes, modes, self.areas)
        pinned = outline[[0, len(outline) // 2]]
        held, value = np.zeros((self._n, 2), dtype=bool), np.zeros((self._n, 2))
        held[pinned] = True
        value[pinned[1], 0] = 1.0
        return self._solve(stiffness, np.zeros_like(value), held, value)

    def map_evenly(self, outline: IntArray) -> FloatArray:
        """Return every point in the middle of its neighbours, the outline on a circle (Tutte 1963)."""
        angle = 2.0 * np.pi * np.arange(len(outline)) / len(outline)
        held, value = np.zeros((self._n, 2), dtype=bool), np.zeros((self._n, 2))
        held[outline] = True
        value[outline] = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        even = np.kron(3.0 * np.eye(3) - 1.0, np.eye(2))
        stiffness = np.broadcast_to(even[:, :, None], (6, 6, len(self.triangles)))
        return self._solve(stiffness, np.zeros_like(value), held, value)

    def relax(self, flat: FloatArray) -> FloatArray:
        """Lower the symmetric Dirichlet energy from places without turned triangles."""
        held = np.zeros((self._n, 2), dtype=bool)
        held[0] = True
        energy = self._energy(flat)
        for _ in range(_ROUNDS):
            force, stiffness = self._expand(flat)
            move = self._solve(stiffness, -force, held, np.zeros((self._n, 2)))
            slope = float(np.vdot(force, move))
            step = min(1.0, 0.8 * self._longest_step(flat, move))
            while (lower := self._energy(flat + step * move)) > energy + 1e-4 * step * slope and step > 1e-9:
                step *= 0.5
            if not lower < energy:
                break
            flat, fall, energy = flat + step * move, energy - lower, lower
            if fall < _ENOUGH * energy:
                break
        return np.ascontiguousarray(flat)

    def _gradients(self, flat: FloatArray) -> FloatArray:
        """Return the map's derivative in each triangle (2, 2, n)."""
        return np.asarray(np.einsum("nci,cjn->ijn", flat[self.triangles], self.gradient))

    def _energy(self, flat: FloatArray) -> float:
        """Return the mean of |F|^2 + |F^-1|^2 over the area; infinite where a triangle is turned over."""
        f = self._gradients(flat)
        det = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
        if not (det > 0.0).all():
            return float("inf")
        return float(((f**2).sum(axis=(0, 1)) * (1.0 + det**-2)) @ self.areas / self.areas.sum())

    def _longest_step(self, flat: FloatArray, move: FloatArray) -> float:
        """Return the step at which the first triangle has no area."""
        f, g = self._gradients(flat), self._gradients(move)
        c = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
        a = g[0, 0] * g[1, 1] - g[0, 1] * g[1, 0]
        b = f[0, 0] * g[1, 1] + g[0, 0] * f[1, 1] - f[0, 1] * g[1, 0] - g[0, 1] * f[1, 0]
        # the smallest positive root of a t^2 + b t + c, c > 0, in the form that does not cancel
        root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
        falls = (b * b >= 4.0 * a * c) & (root - b > 0.0)
        return float((2.0 * c[falls] / (root - b)[falls]).min(initial=np.inf))

    def _expand(self, flat: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the energy's gradient (n_points, 2) and its triangles' Hessians (6, 6, n) without what is negative."""
        f = self._gradients(flat)
        total = np.hypot(f[0, 0] + f[1, 1], f[1, 0] - f[0, 1])
        apart = np.hypot(f[0, 0] - f[1, 1], f[1, 0] + f[0, 1])
        s1, s2 = 0.5 * (total + apart), 0.5 * (total - apart)
        turn, shear = np.arctan2(f[1, 0] - f[0, 1], f[0, 0] + f[1, 1]), np.arctan2(f[1, 0] + f[0, 1], f[0, 0] - f[1, 1])
        u, v = 0.5 * (shear + turn), 0.5 * (shear - turn)  # F = R(u) diag(s1, s2) R(-v)
        u1, u2 = np.array([np.cos(u), np.sin(u)]), np.array([-np.sin(u), np.cos(u)])
        w1 = self.gradient[:, 0] * np.cos(v) + self.gradient[:, 1] * np.sin(v)
        w2 = self.gradient[:, 1] * np.cos(v) - self.gradient[:, 0] * np.sin(v)
        first, second = w1[:, None] * u1, w2[:, None] * u2
        mixed, crossed = w1[:, None] * u2, w2[:, None] * u1
        modes = np.stack([first, second, mixed - crossed, mixed + crossed]).reshape(4, 6, -1)
        p1, p2 = 2.0 * (s1 - s1**-3), 2.0 * (s2 - s2**-3)
        weights = np.stack([
            2.0 + 6.0 * s1**-4,
            2.0 + 6.0 * s2**-4,
            0.5 * np.maximum((p1 + p2) / total, _STIFFEST_TURN),
            1.0 + (s1 * s1 + s1 * s2 + s2 * s2) / (s1 * s2) ** 3,
        ])  # fmt: skip
        share = self.areas / self.areas.sum()
        forces = (share * (p1 * first + p2 * second)).transpose(2, 0, 1).reshape(-1, 2)
        nodes = self.triangles.ravel()
        force: FloatArray = np.zeros((self._n, 2))
        for i in (0, 1):
            force[:, i] = np.bincount(nodes, forces[:, i], minlength=self._n)
        stiffness = np.zeros((6, 6, len(share)))
        for mode, weight in zip(modes, weights * share, strict=True):
            stiffness += mode[:, None] * (weight * mode)
        return force, stiffness


def _pack(stiffness: FloatArray) -> FloatArray:
    """Return element matrices (6, 6, n) as the assembler reads them: packs of cells, the lanes last."""
    width = _core.pack_width
    n = stiffness.shape[2]
    padded = np.zeros((6, 6, -(-n // width) * width))
    padded[:, :, :n] = stiffness
    return np.ascontiguousarray(padded.reshape(6, 6, -1, width).transpose(2, 0, 1, 3))


def _signed_areas(flat: FloatArray, triangles: IntArray) -> FloatArray:
    a, b = (flat[triangles[:, k]] - flat[triangles[:, 0]] for k in (1, 2))
    return np.asarray(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))


def _map_to_circle(points: FloatArray, triangles: IntArray, outline: IntArray, threads: int) -> FloatArray:
    """Map onto a disc by Tutte's theorem, which no sheet without holes can fold; holes are closed for it."""
    n, filled = len(points), [triangles]
    middles: list[FloatArray] = []
    for rim in find_rims(points, triangles):
        if not np.isin(outline[0], rim):
            filled.append(np.stack([np.roll(rim, -1), rim, np.full(len(rim), n + len(middles))], axis=1))
            middles.append(points[rim].mean(axis=0))
    closed = np.concatenate([points, np.array(middles).reshape(-1, 3)])
    flat = _Sheet(closed, np.concatenate(filled).astype(np.int32), threads).map_evenly(outline)[:n]
    if _signed_areas(flat, triangles).sum() < 0.0:
        flat = flat * np.array([1.0, -1.0])
    if (_signed_areas(flat, triangles) <= 0.0).any():
        raise MeshError("the part cannot be laid flat without folding", "check that it is one sheet without tunnels")
    return flat
