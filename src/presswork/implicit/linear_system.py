# SPDX-License-Identifier: Apache-2.0
"""The linear system of a Newton iteration: the matrix of all stiffnesses, its factors, and the correction."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import scipy

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.implicit.linear_solver import LinearSolver, make_solver
from presswork.interaction.body_contact import BodyForces
from presswork.interaction.floating_tools import Floating, FloatingTools
from presswork.interaction.friction import FrictionForces
from presswork.interaction.inertia import InertiaForces
from presswork.interaction.loads import AppliedLoads
from presswork.interaction.pushed_sheet_tools import Pushed, PushedSheetTools
from presswork.interaction.sheet_contact import SheetForces
from presswork.interaction.tool_contact import Constraints
from presswork.model import FloatArray, MaskArray, Model
from presswork.timing import Timing


@dataclass(frozen=True)
class Point:
    """The forces at one guess."""

    displacement: FloatArray
    internal: FloatArray
    loads: AppliedLoads
    bodies: BodyForces
    sheet: SheetForces | None
    inertia: InertiaForces | None
    reaction: FloatArray
    length: FloatArray
    """What each freedom is multiplied by to make it a length, and its force divided by to make it a force."""

    @property
    def largest_force(self) -> float:
        """Largest nodal force, internal, applied or of inertia [N]."""
        largest = max(float(np.abs(f / self.length).max()) for f in (self.internal, self.loads.force))
        return max(largest, float(np.abs(self.inertia.resistance).max())) if self.inertia else largest


@dataclass(frozen=True)
class Balance:
    """What contact makes of the forces at one guess."""

    constraints: Constraints
    friction: FrictionForces | None
    drag: FloatArray
    """Friction (n_points, 2) [N]."""
    floating: Floating | None
    pushed: Pushed | None
    lacking: FloatArray
    """Out of balance (n_points, 2) [N], in the nodes' own frames."""
    changes: int
    length: FloatArray

    @property
    def largest_lacking(self) -> float:
        """Largest force out of balance, of a node or of a tool [N]."""
        of_tools = [float(np.abs(t.missing).max(initial=0.0)) for t in (self.floating, self.pushed) if t]
        return max(float(np.abs(self.lacking / self.length).max()), *of_tools, 0.0)


class LinearSystem:
    """Matrix and factors of one run."""

    def __init__(
        self,
        model: Model,
        mechanics: Mechanics | ShellMechanics,
        floating_tools: FloatingTools,
        pushed_sheet_tools: PushedSheetTools,
        timing: Timing,
        threads: int,
    ) -> None:
        self._model = model
        self._mechanics = mechanics
        self._floating_tools = floating_tools
        self._pushed_sheet_tools = pushed_sheet_tools
        self._timing = timing
        self._threads = threads
        self._diagonal = 1.0
        self._analyse()

    def _analyse(self) -> None:
        """Make the matrix for the assembler's pattern; the solver follows."""
        started = perf_counter()
        assembler = self._analysed = self._mechanics.assembler
        self.data = np.zeros(len(assembler.indices))
        self._unconstrained = self.data
        self._solver: LinearSolver | None = None
        self._timing.add("analysis", started)

    @property
    def solver(self) -> LinearSolver:
        """The linear solver of the assembler's pattern; it is analysed when it is first asked for."""
        if self._solver is None:
            started, assembler = perf_counter(), self._analysed
            self._solver = make_solver(
                assembler.indptr, assembler.indices, symmetric=self._model.solver.symmetric, threads=self._threads
            )
            self._timing.add("analysis", started)
        return self._solver

    def _add_friction(self, friction: FrictionForces, constraints: Constraints) -> None:
        """Add friction's stiffness; Coulomb's dependence on the normal force only to an unsymmetric matrix."""
        assembler = self._mechanics.assembler
        pairs = np.repeat(friction.nodes[:, None], 2, axis=1).astype(np.int32)
        blocks = friction.stiffness[:, None, None] * friction.tangent[:, :, None] * friction.tangent[:, None, :]
        assembler.add_blocks(pairs, np.ascontiguousarray(blocks), constraints.turned, constraints.frames, self.data)
        if self._model.solver.symmetric:
            return
        start = assembler.indptr
        for node, slope in zip(friction.nodes, friction.normal_slope, strict=True):
            if slope:
                normal_row = self.data[start[2 * node] : start[2 * node + 1]]
                self.data[start[2 * node + 1] : start[2 * node + 2]] -= slope * normal_row

    def correct(self, balance: Balance, point: Point, *, refactorise: bool) -> tuple[FloatArray, FloatArray]:
        """Solve for the next correction (n_points, 2), global frame, and the travel of floating tools (n_floating,)."""
        constraints, floating = balance.constraints, balance.floating
        travels = floating is not None and len(floating.tools) > 0
        flat = balance.lacking.reshape(-1).copy()
        is_new = self._analysed is not self._mechanics.assembler
        if is_new:
            self._analyse()
        if refactorise or is_new:
            started = perf_counter()
            self._assemble(constraints, point, balance.friction)
            self._diagonal = float(self.data.max())  # of the size of the others, for the condition
            if travels:
                self._unconstrained = self.data.copy()
            self._prescribe(constraints.mask, constraints.value, self.data, flat)
            self._timing.add("assembly", started)
            started = perf_counter()
            self.solver.factorise(self.data)
            self._timing.add("solve", started)
        started = perf_counter()
        solution = self.solver.solve(flat).reshape(balance.lacking.shape)
        travel = np.zeros(0)
        if balance.pushed and balance.pushed.tools:
            assert point.sheet is not None

            def respond_to(force: FloatArray) -> FloatArray:
                rhs = turn(constraints, force)
                rhs[constraints.mask == 1] = 0.0
                return turn_back(constraints, self.solver.solve(rhs.reshape(-1)).reshape(rhs.shape))

            solution = turn_back(constraints, solution)
            found = self._pushed_sheet_tools.correct(balance.pushed, point.sheet, solution, respond_to)
            self._timing.add("solve", started)
            return found
        if travels:
            assert floating is not None

            def respond(value: FloatArray, force: FloatArray) -> FloatArray:
                rhs = force.reshape(-1).copy()
                self._prescribe(constraints.mask, value, self._unconstrained.copy(), rhs)
                return self.solver.solve(rhs).reshape(-1, 2)

            matrix = self._full_matrix(self._unconstrained)
            solution, travel = self._floating_tools.correct(floating, balance.friction, matrix, solution, respond)
        self._timing.add("solve", started)
        return turn_back(constraints, solution), travel

    def _assemble(self, constraints: Constraints, point: Point, friction: FrictionForces | None) -> None:
        """Fill the matrix with all stiffnesses, in the nodes' own frames."""
        assembler, loads = self._mechanics.assembler, point.loads
        self._mechanics.assemble_stiffness(constraints.turned, constraints.frames, self.data)
        if self._model.solver.pressure_stiffness and len(loads.pairs):
            assembler.add_blocks(loads.pairs, loads.blocks, constraints.turned, constraints.frames, self.data)
        for other in (point.bodies, point.sheet, point.inertia):
            if other and len(other.pairs):
                blocks = (other.pairs, other.blocks, constraints.turned, constraints.frames)
                assembler.add_blocks(*blocks, self.data)
        if friction:
            self._add_friction(friction, constraints)

    def _prescribe(self, mask: MaskArray, value: FloatArray, data: FloatArray, rhs: FloatArray) -> None:
        """Prescribe values (n_points, 2) in a matrix and its right-hand side, in place."""
        self._mechanics.assembler.constrain(mask.reshape(-1), value.reshape(-1), self._diagonal, data, rhs)

    def _full_matrix(self, data: FloatArray) -> scipy.sparse.csr_matrix:
        """Return the matrix with both its halves."""
        assembler = self._mechanics.assembler
        matrix = scipy.sparse.csr_matrix((data, assembler.indices, assembler.indptr))
        return matrix + scipy.sparse.triu(matrix, 1).T if self._model.solver.symmetric else matrix


def turn(constraints: Constraints, vector: FloatArray) -> FloatArray:
    """Take a nodal vector into the nodes' own frames."""
    result = vector.copy()
    nodes = np.nonzero(constraints.turned)[0]
    own = constraints.frames.shape[-1]  # the last freedoms of a node are those taken in its frame
    result[nodes, -own:] = np.einsum("nij,nj->ni", constraints.frames[nodes], vector[nodes, -own:])
    return result


def turn_back(constraints: Constraints, vector: FloatArray) -> FloatArray:
    nodes = np.nonzero(constraints.turned)[0]
    own = constraints.frames.shape[-1]
    vector[nodes, -own:] = np.einsum("nji,nj->ni", constraints.frames[nodes], vector[nodes, -own:])
    return vector
