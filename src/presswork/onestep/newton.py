# SPDX-License-Identifier: Apache-2.0
"""The one-step solver: from the finished part back to its flat blank.

Unknown are the places of the part's nodes in the blank. Equilibrium is asked along the part's surface only, for normal
to it the tools hold: the forces of inverse_membrane.hpp along two tangents of each node, with friction, vanish. Where
no symmetry plane holds the part, three force fields (two directions and a turn) balance what tools must hold beyond
that; they show how far the part is from a place where it would stay by itself. Theory: docs/theory/one_step.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from presswork import _core
from presswork.explicit.options import layer_rule
from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import SolverError
from presswork.model import BoolArray, FloatArray, IntArray
from presswork.onestep.law import STRAIN_METRIC
from presswork.onestep.part import OneStepError, PartSurface

FORCE_TOLERANCE = 1e-6
"""Largest unbalanced force over flow stress x thickness x edge length."""
MAX_ITERATIONS = 60
_SHORTEST_STEP = 2.0**-12
_TORN = -1.0
"""Thickness strain that no sheet bears: 63 % thinner. Equilibria beyond are necks of one row of triangles."""
_SLIP_SCALE = 0.25
"""Slip over thickness at which friction is near its full size, so that its direction has a derivative."""


@dataclass(frozen=True)
class Friction:
    """Friction forces against the sheet's motion over one tool."""

    force: FloatArray
    """Force at each node (n_nodes,) [N]."""
    level: FloatArray
    """Where the flat blank would lie on that tool, along the draw direction (n_nodes,) [mm]."""


@dataclass(frozen=True)
class OneStepProblem:
    """Everything that the solver needs. The draw direction is +z or -z; the blank lies in x, y."""

    part: PartSurface
    law: _core.DeformationLaw
    thickness: float
    """Thickness of the blank [mm]."""
    flow_stress: float
    """A typical one, to scale forces with [MPa]."""
    layers: int = 3
    """Points through the thickness, for bending."""
    held: tuple[BoolArray, BoolArray] | None = None
    """Nodes on symmetry planes normal to x | y, each (n_nodes,)."""
    friction: tuple[Friction, ...] = ()
    formed: FloatArray | None = None
    """What each triangle's layers have gone through in the stages before (n, layers, 4), see DeformationLaw.form."""

    def find_formed(self) -> FloatArray:
        """Return what the layers have gone through, zero in the first stage (n, layers, 4)."""
        return np.zeros((len(self.part.triangles), self.layers, 4)) if self.formed is None else self.formed


@dataclass
class OneStepSolution:
    """A blank, and how it was found."""

    blank: FloatArray
    """Places of the nodes in the blank (n_nodes, 2) [mm]."""
    forces: FloatArray
    """Forces of the sheet on what holds it, at each node in space (n_nodes, 3) [N]."""
    held_force: FloatArray
    """Resultant of the force fields that hold the part: along x, y [N], about z [N mm]."""
    iterations: int = 0
    residuals: list[float] = field(default_factory=list)
    """Largest unbalanced force of each iteration, over flow stress x thickness x edge length."""


class OneStep:
    """Newton's method for one problem."""

    def __init__(self, problem: OneStepProblem, *, threads: int = 0) -> None:
        self.problem = problem
        part = problem.part
        self._n = len(part.points)
        self._height, self._weight = layer_rule(problem.layers, "gauss")
        self._bases, self._fixed = self._choose_tangents()
        self._areas = part.nodal_areas
        self._formed = problem.find_formed()
        across = [bool(self._fixed[:, i].any()) for i in (0, 1)]
        self._used = np.array([not across[0], not across[1], not any(across)])
        self._is_free = bool(self._used.any())
        self._extra = 2 if self._is_free else 0
        self._assembler = _core.Assembler(
            self._n + self._extra, [part.triangles], symmetric=False, couplings=self._couplings()
        )
        self._turned = np.zeros(self._n + self._extra, dtype=np.uint8)
        self._frames = np.zeros((self._n + self._extra, 2, 2))
        indptr, indices = self._assembler.indptr, self._assembler.indices
        self._solver = make_solver(indptr, indices, symmetric=False, threads=threads or _core.max_threads())
        edge = float(np.sqrt(part.areas.sum() / max(self._n, 1)))
        self._scale = problem.flow_stress * problem.thickness * edge
        self._size = float(np.ptp(part.points, axis=0).max())
        self._holding, self._gauge = self._choose_holding()

    def set_friction(self, friction: tuple[Friction, ...]) -> None:
        """Take other friction from now on."""
        self.problem = replace(self.problem, friction=friction)

    # --- what stays through the iteration ----------------------------------------------------------------------------

    def _choose_tangents(self) -> tuple[FloatArray, BoolArray]:
        """Return two tangents of each node (n_nodes, 2, 3) and which of the blank's places are held (n_nodes, 2).

        On a symmetry plane the tangent normal to it belongs to the place that is held.
        """
        normals = self.problem.part.normals
        axis = np.eye(3)[np.where(np.abs(normals[:, 0]) < 0.8, 0, 1)]
        held = np.zeros((self._n, 2), dtype=bool)
        if self.problem.held is not None:
            held = np.stack(self.problem.held, axis=1)
            axis[held[:, 0]] = np.eye(3)[0]
            axis[held[:, 1] & ~held[:, 0]] = np.eye(3)[1]
        along = axis - np.einsum("ni,ni->n", axis, normals)[:, None] * normals
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = np.cross(normals, along)
        second_only = held[:, 1] & ~held[:, 0]
        bases = np.stack([along, across], axis=1)
        bases[second_only] = bases[second_only][:, ::-1]
        return np.ascontiguousarray(bases), held

    def _couplings(self) -> IntArray | None:
        """Couple every node with the two that carry the forces which hold the part."""
        if not self._is_free:
            return None
        nodes, n = np.arange(self._n), self._n
        pairs = [np.stack([nodes, np.full(n, n + k)], axis=1) for k in (0, 1)]
        return np.concatenate([*pairs, [[n, n + 1], [n, n], [n + 1, n + 1]]]).astype(np.int32)

    def _choose_holding(self) -> tuple[FloatArray, FloatArray]:
        """Return the holding force fields along the tangents, and the conditions on the blank's place (n_nodes, 2, 3).

        The blank lies so that it covers the part seen from above as well as it can, with the nodes' areas as weights.
        """
        part = self.problem.part
        centre = np.average(part.points[:, :2], axis=0, weights=self._areas)
        arm = (part.points[:, :2] - centre) / self._size
        fields = np.zeros((self._n, 3, 3))
        fields[:, 0, 0] = fields[:, 1, 1] = 1.0
        fields[:, 0, 2], fields[:, 1, 2] = -arm[:, 1], arm[:, 0]
        share = (self._areas / self._areas.sum())[:, None, None]
        return np.einsum("nai,nik->nak", self._bases, fields) * share, fields[:, :2] * share

    # --- forces ------------------------------------------------------------------------------------------------------

    def _evaluate(
        self, blank: FloatArray, law: _core.DeformationLaw, *, with_stiffness: bool
    ) -> tuple[FloatArray, FloatArray, bool]:
        """Return the nodal forces in space (n_nodes, 3), the triangles' stiffness and whether none is turned over."""
        part = self.problem.part
        formed = self._formed if law is self.problem.law else np.zeros_like(self._formed)
        force, stiffness, failed = _core.evaluate_inverse(
            part.triangles, part.share, part.axes, part.edges, part.curvature, self._bases,
            np.ascontiguousarray(blank), formed, self.problem.thickness, law, self._height, self._weight,
            with_stiffness=with_stiffness,
        )  # fmt: skip
        nodes = part.triangles.ravel()
        flat = force.reshape(-1, 3)
        nodal: FloatArray = np.zeros((self._n, 3))
        for i in range(3):
            nodal[:, i] = np.bincount(nodes, flat[:, i], minlength=self._n)
        return nodal, stiffness, failed < 0

    def _drag(self, blank: FloatArray, friction: Friction) -> tuple[FloatArray, FloatArray]:
        """Return friction along the tangents (n_nodes, 2) and its derivative by the blank's places (n_nodes, 2, 2)."""
        part = self.problem.part
        travel = part.points - np.column_stack([blank, friction.level])
        slip = np.einsum("nai,ni->na", self._bases, travel)
        smooth = _SLIP_SCALE * self.problem.thickness
        length = np.sqrt((slip**2).sum(axis=1) + smooth**2)
        direction = slip / length[:, None]
        by_slip = (np.eye(2) - direction[:, :, None] * direction[:, None, :]) / length[:, None, None]
        by_blank = -np.einsum("nab,nbi->nai", by_slip, self._bases[:, :, :2])
        return friction.force[:, None] * direction, friction.force[:, None, None] * by_blank

    def residual(
        self, blank: FloatArray, held: FloatArray, law: _core.DeformationLaw, *, with_friction: bool
    ) -> tuple[FloatArray, FloatArray, bool]:
        """Return the unbalanced forces (n_nodes, 2), the forces in space (n_nodes, 3), and whether they are usable."""
        nodal, _, is_usable = self._evaluate(blank, law, with_stiffness=False)
        return self._balance(nodal, blank, held, with_friction), nodal, is_usable

    def _balance(self, nodal: FloatArray, blank: FloatArray, held: FloatArray, with_friction: bool) -> FloatArray:
        balance = np.einsum("nai,ni->na", self._bases, nodal) + self._holding @ held
        for friction in self.problem.friction if with_friction else ():
            balance += self._drag(blank, friction)[0]
        balance[self._fixed] = 0.0
        return np.asarray(balance)

    def matrix(
        self, blank: FloatArray, law: _core.DeformationLaw, *, with_friction: bool
    ) -> tuple[FloatArray, FloatArray]:
        """Return the values of the tangent in the assembler's pattern, and the nodal forces in space."""
        nodal, stiffness, _ = self._evaluate(blank, law, with_stiffness=True)
        data = np.zeros(len(self._assembler.indices))
        self._assembler.assemble_matrix([stiffness], self._turned, self._frames, data)
        nodes = np.arange(self._n, dtype=np.int32)
        for friction in self.problem.friction if with_friction else ():
            self._add(np.stack([nodes, nodes], axis=1), self._drag(blank, friction)[1], data)
        if self._is_free:
            weight = float(np.abs(data).max()) * self._n
            last = np.full(self._n, self._n, dtype=np.int32)
            columns, rows = np.zeros((2, self._n, 2, 2)), np.zeros((2, self._n, 2, 2))
            idle = np.full(4, weight)
            for k in np.flatnonzero(self._used):
                columns[k // 2, :, :, k % 2] = self._holding[:, :, k]
                rows[k // 2, :, k % 2, :] = weight * self._gauge[:, :, k]
                idle[k] = 0.0
            for node in (0, 1):
                self._add(np.stack([nodes, last + node], axis=1), columns[node], data)
                self._add(np.stack([last + node, nodes], axis=1), rows[node], data)
                pair = np.full((1, 2), self._n + node, dtype=np.int32)
                self._add(pair, np.diag(idle[2 * node : 2 * node + 2])[None], data)
        return data, nodal

    def _add(self, pairs: IntArray, blocks: FloatArray, data: FloatArray) -> None:
        pairs, blocks = np.ascontiguousarray(pairs, dtype=np.int32), np.ascontiguousarray(blocks)
        self._assembler.add_blocks(pairs, blocks, self._turned, self._frames, data)

    # --- iteration ---------------------------------------------------------------------------------------------------

    def solve(self, start: FloatArray, *, on_iteration: Callable[[int, float], None] | None = None) -> OneStepSolution:
        """Find the blank from a first guess (n_nodes, 2) without turned triangles, over the part if planes hold it.

        A sheet with the elastic law alone comes first: its blank is near, and its forces never fall. Raises
        OneStepError when the iteration does not end.
        """
        solution = self.stretch(start, on_iteration=on_iteration)
        self.go_on(solution, on_iteration=on_iteration)
        return solution

    def stretch(
        self, start: FloatArray, *, on_iteration: Callable[[int, float], None] | None = None
    ) -> OneStepSolution:
        """Find the blank of a sheet that stays elastic, without friction, from a first guess (n_nodes, 2)."""
        solution = OneStepSolution(self._place(start), np.zeros((self._n, 3)), np.zeros(3))
        elastic = _core.DeformationLaw(1.0, STRAIN_METRIC, _core.HardeningLaw.linear, [1e30, 0.0])
        self._iterate(solution, elastic, 1e-3, on_iteration, with_friction=False)
        solution.held_force = np.zeros(3)
        return solution

    def go_on(self, solution: OneStepSolution, *, on_iteration: Callable[[int, float], None] | None = None) -> None:
        """Bring a solution into equilibrium, as after other friction was set. Raises OneStepError."""
        self._iterate(solution, self.problem.law, 1.0, on_iteration, with_friction=True)
        if self._thickness_strains(solution.blank).min() < _TORN:
            raise OneStepError(f"the sheet would tear: {self._describe_thinnest(solution.blank)}")

    def _thickness_strains(self, blank: FloatArray) -> FloatArray:
        """Return those of the triangles (n,)."""
        part = self.problem.part
        first, second = (blank[part.triangles[:, k]] - blank[part.triangles[:, 0]] for k in (1, 2))
        flat = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        edges = part.edges
        formed = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
        return np.asarray(np.log(np.maximum(flat, 1e-300) / formed))

    def _describe_thinnest(self, blank: FloatArray) -> str:
        """Describe how thin the sheet is at its thinnest place, and where that is."""
        part, strain = self.problem.part, self._thickness_strains(blank)
        thinnest = int(np.argmin(strain))
        place = ", ".join(f"{x:.4g}" for x in part.points[part.triangles[thinnest]].mean(axis=0))
        return (
            f"it is {-100.0 * np.expm1(strain[thinnest]):.0f} % thinner near ({place}) mm; the part is too deep there "
            "for this sheet in one draw, or its mesh too coarse at that radius"
        )

    def _place(self, start: FloatArray) -> FloatArray:
        """Lay the first guess over the part as a rigid body, and what is held onto its symmetry plane."""
        placed = lay_over(start, self.problem.part.points[:, :2], self._areas) if self._used.all() else start.copy()
        placed[self._fixed] = 0.0
        return placed

    def _iterate(
        self,
        solution: OneStepSolution,
        law: _core.DeformationLaw,
        tolerance: float,
        on_iteration: Callable[[int, float], None] | None,
        *,
        with_friction: bool,
    ) -> None:
        is_elastic = law is not self.problem.law
        blank, held = solution.blank, solution.held_force
        for _ in range(MAX_ITERATIONS):
            data, nodal = self.matrix(blank, law, with_friction=with_friction)
            balance = self._balance(nodal, blank, held, with_friction)
            scale = float(np.abs(nodal).max()) if is_elastic else self._scale
            error = float(np.abs(balance).max()) / scale
            solution.forces = nodal
            solution.iterations += 1
            solution.residuals.append(error)
            if on_iteration:
                on_iteration(solution.iterations, error)
            if error < max(FORCE_TOLERANCE, 1e-2 * tolerance if is_elastic else 0.0):
                break
            move, change = self._correct(data, balance)
            blank, held = self._search(blank, held, move, change, law, with_friction)
            solution.blank, solution.held_force = blank, held
            if is_elastic and np.abs(move).max() < tolerance * self._size:
                break
        else:
            raise OneStepError(
                f"no equilibrium was found in {MAX_ITERATIONS} iterations (unbalanced force {error:.1e} of the flow "
                f"force); in the last, {self._describe_thinnest(blank)}"
            )

    def _correct(self, data: FloatArray, balance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Factorise the tangent; return Newton's correction of the blank (n_nodes, 2) and the holding forces (3,)."""
        mask = np.zeros(2 * (self._n + self._extra), dtype=np.uint8)
        mask[: 2 * self._n] = self._fixed.ravel()
        self._assembler.constrain(mask, np.zeros(len(mask)), float(np.abs(data).max()), data, np.zeros(len(mask)))
        try:
            self._solver.factorise(data)
        except SolverError as error:
            raise OneStepError(f"the equations of the blank cannot be solved: {error}") from error
        return self._back_substitute(balance)

    def _back_substitute(self, balance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the correction for unbalanced forces (n_nodes, 2) by the factors at hand."""
        n = self._n
        right = np.zeros(2 * (n + self._extra))
        right[: 2 * n] = -balance.ravel()
        found = self._solver.solve(right)
        return found[: 2 * n].reshape(-1, 2), found[2 * n : 2 * n + 3] if self._is_free else np.zeros(3)

    def _search(
        self,
        blank: FloatArray,
        held: FloatArray,
        move: FloatArray,
        change: FloatArray,
        law: _core.DeformationLaw,
        with_friction: bool,
    ) -> tuple[FloatArray, FloatArray]:
        """Go along the correction as far as no triangle turns over and the next correction would be shorter.

        The next correction is found with the same factors (Deuflhard 2004, natural monotonicity): unlike the forces,
        it does not depend on the elements' size, nor on how stiff the sheet is where.
        """
        before = float(np.linalg.norm(move))
        step = 1.0
        while True:
            new, new_held = blank + step * move, held + step * change
            after, _, is_usable = self.residual(new, new_held, law, with_friction=with_friction)
            is_usable = is_usable and bool(np.isfinite(after).all())
            if is_usable and np.linalg.norm(self._back_substitute(after)[0]) <= (1.0 - 0.25 * step) * before:
                return new, new_held
            if step < _SHORTEST_STEP:
                if is_usable:
                    return new, new_held
                raise OneStepError(f"no equilibrium was found: as it is sought, {self._describe_thinnest(blank)}")
            step *= 0.5


def lay_over(blank: FloatArray, above: FloatArray, weight: FloatArray) -> FloatArray:
    """Move and turn places in the blank (n, 2) so that they cover those of the part seen from above best."""
    share = weight / weight.sum()
    centre, target = share @ blank, share @ above
    u, _, v = np.linalg.svd((blank - centre).T @ (share[:, None] * (above - target)))
    turn = u @ np.diag([1.0, np.sign(np.linalg.det(u @ v))]) @ v
    return np.asarray((blank - centre) @ turn + target)
