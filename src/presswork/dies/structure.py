# SPDX-License-Identifier: Apache-2.0
"""Linear elasticity of a die's parts: factors once, an answer for each instant, and rings that press on each other.

Parts touch without friction and may part: at each pair of nodes k of the side that two parts share

    g_k = u_outer - u_inner - interference >= 0,   p_k >= 0,   g_k p_k = 0        (normal to the side)

The answer of all pairs to a unit force on each is found once, so an instant costs one substitution and this small
problem, which an active set solves (Hintermueller, Ito & Kunisch, SIAM J. Optim. 13, 2002).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.body.solids import Mechanics
from presswork.dies.meshes import SAME, PartMesh
from presswork.implicit.linear.choose import make_solver
from presswork.mesh.topology import find_boundary_edges
from presswork.model import (
    CELLS,
    Analysis,
    CellBlock,
    DieBody,
    FloatArray,
    IntArray,
    MaskArray,
    Material,
    Mesh,
    Model,
    OutputSettings,
    SolverSettings,
    Stage,
    never_yield,
)
from presswork.results import ResultError
from presswork.timing import Timing

ELEMENT = "quad8_2x2"
MOST_ROUNDS = 100
"""Rounds of the active set, at most."""
CHANGE = 1e-9
"""Gap of a pair, over the largest displacement, below which it counts as closed."""


class LooseDieError(ResultError):
    """A part of a die can move without strain, since nothing holds it."""


@dataclass(frozen=True)
class Answer:
    """A die under one load."""

    displacement: FloatArray
    """(n_points, 2) [mm]."""
    stress: FloatArray
    """xx, yy, zz, xy at the nodes, the mean of the cells round each (n_points, 4) [MPa]."""
    push: FloatArray
    """Force between parts at each pair of nodes (n_pairs,) [N]."""


class DieStructure:
    """The parts of a die as one elastic structure."""

    def __init__(self, meshes: Sequence[PartMesh], body: DieBody, analysis: Analysis, depth: float) -> None:
        """Take the parts' meshes; depth: of a die in plane strain [mm]. Raises LooseDieError."""
        self._first = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
        self.points = np.concatenate([mesh.points for mesh in meshes])
        self.cells = [np.ascontiguousarray(m.cells + f) for m, f in zip(meshes, self._first[:-1], strict=True)]
        self.outlines = [find_boundary_edges([cells])[:, [0, 2, 1]] for cells in self.cells]
        """Boundary edges of each part: first end, middle, last end (n, 3)."""
        self.profile: IntArray = meshes[0].profile
        self.body = body
        self._mechanics = Mechanics(self._make_model(analysis, depth), Timing("assembly"))
        self._state, self._trial = self._mechanics.at_rest(), self._mechanics.at_rest()
        self._mask = self._find_held(meshes, analysis)
        self._mechanics.evaluate(self._state, self._trial, np.zeros(self.points.shape), with_stiffness=True)
        self._factorise()
        self.pairs, overlap = self._find_pairs(meshes)
        self._overlap = overlap
        self._unit = self._solve(self._push_pairs(np.eye(len(self.pairs))))
        self._compliance = self._part(self._unit)

    def part_of(self, number: int) -> slice:
        """Return which nodes belong to a part."""
        return slice(int(self._first[number]), int(self._first[number + 1]))

    def answer(self, forces: FloatArray) -> Answer:
        """Return displacement and stress under forces on the nodes (n_points, 2) [N], with the rings' interference."""
        free = self._solve(forces[None])[0]
        push = self._press(self._part(free[None])[:, 0] - self._overlap) if len(self.pairs) else np.zeros(0)
        moved = free + np.tensordot(push, self._unit, axes=1)
        self._mechanics.evaluate(self._state, self._trial, moved, with_stiffness=False)
        return Answer(moved, self._find_stress(), push)

    def _make_model(self, analysis: Analysis, depth: float) -> Model:
        steels = [part.steel for part in self.body.parts]
        materials = tuple(
            Material(f"part {n}", steel.young, steel.poisson, never_yield(steel.young))
            for n, steel in enumerate(steels)
        )
        blocks = tuple(CellBlock(ELEMENT, cells, n) for n, cells in enumerate(self.cells))
        mesh = Mesh(self.points, blocks, {}, {}, np.zeros((0, 3), dtype=np.int32))
        solver = SolverSettings(displacements="small", strain_measure="small", symmetric=True)
        return Model("", analysis, mesh, materials, (), (Stage(""),), solver, OutputSettings(), depth=depth)

    def _find_held(self, meshes: Sequence[PartMesh], analysis: Analysis) -> MaskArray:
        """Return which freedoms are held (n_points, 2)."""
        mask = np.zeros(self.points.shape, dtype=np.uint8)
        for number, (mesh, part) in enumerate(zip(meshes, self.body.parts, strict=True)):
            own = mask[self.part_of(number)]
            for side in part.held:
                own[mesh.find_side(side), 1 if side in ("bottom", "top") else 0] = 1
            for side in part.clamped:
                own[mesh.find_side(side)] = 1
            if analysis == "axisymmetric":
                own[np.abs(mesh.points[:, 0]) < SAME * mesh.extent, 0] = 1
            if _is_loose(mesh.points, own, analysis):
                name = "the part that holds the profile" if number == 0 else f"ring {number}"
                raise LooseDieError(
                    f"nothing holds {name}: give held, the sides that rest on the press or on a symmetry plane, for "
                    'instance held = ["bottom"]'
                )
        return mask

    def _factorise(self) -> None:
        assembler = self._mechanics.assembler
        data = np.zeros(len(assembler.indices))
        n = len(self.points)
        turned, frames = np.zeros(n, dtype=np.uint8), np.zeros((n, 2, 2))
        self._mechanics.assemble_stiffness(turned, frames, data)
        rhs = np.zeros(2 * n)
        assembler.constrain(self._mask.reshape(-1), np.zeros(2 * n), float(data.max()), data, rhs)
        self._solver = make_solver(assembler.indptr, assembler.indices, symmetric=True, threads=1, points=self.points)
        self._solver.factorise(data)

    def _solve(self, forces: FloatArray) -> FloatArray:
        """Return the displacements (k, n_points, 2) of parts that do not touch under forces of that form."""
        if not len(forces):
            return np.zeros(forces.shape)
        rhs = np.where(self._mask == 1, 0.0, forces)
        return self._solver.solve_all(rhs.reshape(len(rhs), -1)).reshape(rhs.shape)

    def _find_pairs(self, meshes: Sequence[PartMesh]) -> tuple[IntArray, FloatArray]:
        """Return the nodes of parts that touch, inner and outer (n_pairs, 2), and their interference (n_pairs,)."""
        pairs, overlap = [np.zeros((0, 2), dtype=np.int32)], [np.zeros(0)]
        for number, part in enumerate(self.body.parts[1:], 1):
            inner, outer = meshes[number - 1].find_side("right"), meshes[number].find_side("left")
            y, of = meshes[number - 1].points[inner, 1], meshes[number].points[outer, 1]
            apart = np.abs(y[:, None] - of)
            i, j = np.nonzero(apart < SAME * meshes[number].extent)
            found = np.column_stack([inner[i] + self._first[number - 1], outer[j] + self._first[number]])
            pairs.append(found.astype(np.int32))
            overlap.append(np.full(len(found), part.interference))
        return np.concatenate(pairs), np.concatenate(overlap)

    def _push_pairs(self, pushes: FloatArray) -> FloatArray:
        """Return the forces on the nodes (k, n_points, 2) of pushes between pairs (k, n_pairs)."""
        forces = np.zeros((len(pushes), *self.points.shape))
        if len(self.pairs):
            forces[:, self.pairs[:, 1], 0] += pushes
            forces[:, self.pairs[:, 0], 0] -= pushes
        return forces

    def _part(self, moved: FloatArray) -> FloatArray:
        """Return how far the pairs part (n_pairs, k) under displacements (k, n_points, 2)."""
        return (moved[:, self.pairs[:, 1], 0] - moved[:, self.pairs[:, 0], 0]).T

    def _press(self, gap: FloatArray) -> FloatArray:
        """Return the forces between pairs whose gaps without them are these (n_pairs,)."""
        active = gap < 0.0
        noise = CHANGE * float(np.abs(gap).max(initial=0.0))
        for _ in range(MOST_ROUNDS):
            push = np.zeros(len(gap))
            own = np.flatnonzero(active)
            if len(own):
                push[own] = np.linalg.solve(self._compliance[np.ix_(own, own)], -gap[own])
            left = gap + self._compliance @ push
            wanted = np.where(active, push > 0.0, left < -noise)
            if np.array_equal(wanted, active):
                return push
            active = wanted
        return push

    def _find_stress(self) -> FloatArray:
        """Return the stress at the nodes (n_points, 4) of the last evaluation, parts apart."""
        total, count = np.zeros((len(self.points), 4)), np.zeros(len(self.points))
        carry = _carry_to_nodes()
        for cells, stress in zip(self.cells, self._trial.cells.stress, strict=True):
            at_nodes = np.einsum("na,cak->cnk", carry, stress)
            np.add.at(total, cells, at_nodes)
            np.add.at(count, cells, 1.0)
        return np.asarray(total / count[:, None])


def _is_loose(points: FloatArray, mask: MaskArray, analysis: Analysis) -> bool:
    """Return whether nodes (n, 2) with held freedoms can move as a rigid body."""
    if analysis == "axisymmetric":
        return not mask[:, 1].any()
    arm = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    ones, none = np.ones(len(points)), np.zeros(len(points))
    rows_x = np.column_stack([ones, none, -arm[:, 1]])[mask[:, 0] == 1]
    rows_y = np.column_stack([none, ones, arm[:, 0]])[mask[:, 1] == 1]
    return bool(np.linalg.matrix_rank(np.concatenate([rows_x, rows_y, np.zeros((1, 3))]), tol=1e-6) < 3)


def _carry_to_nodes() -> FloatArray:
    """Return the matrix (8, 4) that carries values linear along both axes of a cell from its points to its nodes."""
    cell = CELLS["quad8"]
    shapes = cell.rules[4].shapes
    at_points, at_nodes = (np.column_stack([np.ones(len(s)), s, s[:, :1] * s[:, 1:]])
                           for s in (shapes @ cell.places, cell.places))  # fmt: skip
    return np.asarray(at_nodes @ np.linalg.inv(at_points))
