# SPDX-License-Identifier: Apache-2.0
"""The linear system of a Newton iteration: the matrix of all stiffnesses, its factors, and the correction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np
import scipy

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import Iterations, LinearSolver
from presswork.implicit.linear.dyads import Dyads
from presswork.interaction.contract import (
    Border,
    Constraints,
    Interaction,
    Point,
    Resistance,
    turn,
    turn_back,
)
from presswork.interaction.led import Led
from presswork.model import FloatArray, MaskArray, Model
from presswork.ranks.assembler import DividedAssembler
from presswork.timing import Timing

FLAT = 1e-3
"""Height of a sheet over its length up to which its plan gives the order of elimination."""


@dataclass(frozen=True)
class Balance:
    """What holds the nodes at one guess, and what is out of balance."""

    constraints: Constraints
    resistances: tuple[Resistance | None, ...]
    """Resistances of each interaction."""
    drag: FloatArray
    """Sum of the resistances (n_points, freedoms) [N]."""
    borders: tuple[Border | None, ...]
    """Borders of each interaction."""
    lacking: FloatArray
    """Out of balance (n_points, freedoms) [N], in the nodes' own frames."""
    changes: int
    """What has come, gone or is not right yet."""
    tuned: int
    """The part of it that interactions tune."""
    length: FloatArray
    """What each freedom is multiplied by to make it a length, and its force divided by to make it a force."""

    @property
    def largest_lacking(self) -> float:
        """Largest force out of balance, of a node or of an interaction's own freedom [N]."""
        own = [float(np.abs(b.missing).max(initial=0.0)) for b in self.borders if b]
        return max(float(np.abs(self.lacking / self.length).max()), *own, 0.0)

    def bears(self, part: float, least: float) -> bool:
        """Return whether the residual of interactions' own freedoms is within a part of what they require, or `least`
        [N]."""
        return all((np.abs(b.missing) <= np.maximum(part * b.demand, least)).all() for b in self.borders if b)


@dataclass(frozen=True)
class Lacking:
    """What holds the nodes at a point, and what is out of balance."""

    constraints: Constraints
    resistances: tuple[Resistance | None, ...]
    """Resistances of each interaction."""
    force: FloatArray
    """(n_points, freedoms) [N], in the nodes' own frames."""


class LinearSystem:
    """Matrix and factors of one run; the factors of contract.Factors."""

    def __init__(
        self,
        model: Model,
        mechanics: Mechanics | ShellMechanics,
        interactions: Sequence[Interaction],
        timing: Timing,
        threads: int,
    ) -> None:
        self._model = model
        self._mechanics = mechanics
        self._interactions = interactions
        self._timing = timing
        self._threads = threads
        self._diagonal = 1.0
        self._dyads: Dyads | None = None
        self.negative_pivots = 0
        """Most negative pivots of any matrix of shells since this was set to zero."""
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
            started, assembler, symmetric = perf_counter(), self._analysed, self._model.solver.symmetric
            if isinstance(assembler, DividedAssembler):
                from presswork.implicit.linear.petsc import PetscSolver

                self._solver = PetscSolver(assembler, self._model.takes_multigrid)
                return self._solver
            make = partial(make_solver, assembler.indptr, assembler.indices, symmetric=symmetric, threads=self._threads)
            if self._model.takes_multigrid:
                self._solver = make(freedoms=self._model.freedoms)
            else:
                drilling = self._mechanics.drilling if isinstance(self._mechanics, ShellMechanics) else None
                self._solver = make(
                    points=flatten(self._model.mesh.points),
                    may_refine=drilling is not None and bool(self._model.space_tools),
                    prescribed=drilling,
                )
            self._timing.add("analysis", started)
        return self._solver

    @property
    def iterations(self) -> Iterations | None:
        """How an iterative solver found the last solution; None where it came from factors."""
        return self.solver.iterations

    def factorise(self, point: Point, balance: Balance, *, keep: bool = False) -> FloatArray:
        """Factorise the matrix at a guess; return the right-hand side (n_points, freedoms) of what is out of balance.

        keep: the matrix before constraints is asked for later.
        """
        started = perf_counter()
        rhs = balance.lacking.copy()
        self._assemble(balance.constraints, point, balance.resistances)
        self._diagonal = float(self.data.max())  # of the size of the others, for the condition
        if keep:
            self._unconstrained = self.data.copy()
        self._prescribe(balance.constraints.mask, balance.constraints.value, self.data, rhs.reshape(-1))
        self._timing.add("assembly", started)
        started = perf_counter()
        self.solver.factorise(self.data, partial(self._find_rigid_motions, point, balance.constraints))
        self._dyads = self._find_dyads(point, balance.constraints)
        if self._model.analysis == "shell":
            self.negative_pivots = max(self.negative_pivots, self.count_negative())
        self._timing.add("solve", started)
        return rhs

    def _find_dyads(self, point: Point, constraints: Constraints) -> Dyads | None:
        """Return the dyads at a guess, with the answers of the nodes to their columns; None: there are none."""
        found = [dyad for forces in point.forces if forces for dyad in forces.dyads]
        if not found:
            return None
        columns = np.array([turn(constraints, column) for column, _ in found])
        columns[:, constraints.mask == 1] = 0.0
        answers = self.solver.solve_all(columns.reshape(len(columns), -1)).reshape(columns.shape)
        return Dyads([turn(constraints, row) for _, row in found], answers)

    def count_negative(self) -> int:
        """Return the number of negative pivots of the last matrix, as far as its solver reports it."""
        pivots = self.solver.negative_pivots
        return max(pivots - self._dyads.n_negative, 0) if self._dyads else pivots

    def correct(self, balance: Balance, point: Point, *, refactorise: bool) -> tuple[FloatArray, FloatArray]:
        """Return the next correction (n_points, freedoms), global frame, and the travel of an interaction's freedoms.

        Raises SolverError, or LostWorkpieceError from an interaction.
        """
        is_new = self._analysed is not self._mechanics.assembler
        if is_new:
            self._analyse()
        own = [i for i, border in enumerate(balance.borders) if border and border.is_open]
        assert len(own) <= 1, "freedoms of two interactions would need one common system"
        columns = [c for i in own for c in self._interactions[i].find_columns(balance.borders[i], point.forces[i])]
        rhs = balance.lacking.copy()
        if refactorise or is_new:
            rhs = self.factorise(point, balance, keep=len(own) > 0 and not columns)
        started = perf_counter()
        self._constraints = balance.constraints
        solution, *answers = self._solve_all([rhs, *map(self._load, columns)])
        self._responses = [turn_back(self._constraints, each) for each in answers]
        travel = np.zeros(0)
        for i in own:
            border, forces, resistance = balance.borders[i], point.forces[i], balance.resistances[i]
            solution, travel = self._interactions[i].correct(border, forces, resistance, solution, self)
        self._timing.add("solve", started)
        return turn_back(balance.constraints, solution), travel

    @property
    def constraints(self) -> Constraints:
        """What is prescribed of the nodes in the present correction."""
        return self._constraints

    @property
    def responses(self) -> Sequence[FloatArray]:
        """The nodes' answers to the columns of the present correction, in the global frame (n_points, freedoms)."""
        return self._responses

    def respond_to_all(self, forces: Sequence[FloatArray]) -> list[FloatArray]:
        """Return the nodes' answers to several forces, all in the global frame (n_points, freedoms)."""
        found = self._solve_all([self._load(force) for force in forces])
        return [turn_back(self._constraints, each) for each in found]

    def _load(self, force: FloatArray) -> FloatArray:
        """Return forces (n_points, freedoms) in the nodes' own frames, without those on prescribed freedoms."""
        load = turn(self._constraints, force)
        load[self._constraints.mask == 1] = 0.0
        return load

    def _solve_all(self, loads: Sequence[FloatArray]) -> FloatArray:
        """Return the solutions (k, n_points, freedoms) for right-hand sides of that form, in one substitution."""
        rhs = np.array(loads)
        found = self.solver.solve_all(rhs.reshape(len(rhs), -1)).reshape(rhs.shape)
        return self._dyads.correct(found) if self._dyads else found

    def find_whole(
        self, constraints: Constraints, point: Point, resistances: Sequence[Resistance | None]
    ) -> scipy.sparse.csr_matrix:
        """Return the matrix of a point before constraints, in the nodes' own frames; the system is not symmetric."""
        if self._analysed is not self._mechanics.assembler:
            self._analyse()
        self._assemble(constraints, point, resistances)
        for interaction, forces, resistance in zip(self._interactions, point.forces, resistances, strict=True):
            if not isinstance(interaction, Led):
                continue
            pairs, blocks = interaction.find_area_blocks(point, forces, resistance)
            if len(pairs):
                blocks = _widen(blocks, self._mechanics.freedoms)
                self._mechanics.assembler.add_blocks(pairs, blocks, constraints.turned, constraints.frames, self.data)
        pattern = (self._analysed.indices, self._analysed.indptr)
        return scipy.sparse.csr_matrix((self.data, *pattern), shape=(len(pattern[1]) - 1,) * 2)

    def respond_in_frames(self, value: FloatArray, force: FloatArray) -> FloatArray:
        """Return the answer to prescribed values and forces, all in the nodes' own frames (n_points, freedoms)."""
        rhs = force.copy()
        self._prescribe(self._constraints.mask, value, self._unconstrained.copy(), rhs.reshape(-1))
        return self.solver.solve(rhs.reshape(-1)).reshape(rhs.shape)

    def matrix(self) -> scipy.sparse.csr_matrix:
        """Return the matrix before constraints, in the nodes' own frames, both its halves."""
        assembler = self._mechanics.assembler
        matrix = scipy.sparse.csr_matrix((self._unconstrained, assembler.indices, assembler.indptr))
        return matrix + scipy.sparse.triu(matrix, 1).T if self._model.solver.symmetric else matrix

    def _find_rigid_motions(self, point: Point, constraints: Constraints) -> FloatArray:
        """Return the rigid motions of a solid in space at a guess, in the nodes' own frames (n_points * 3, 6)."""
        position = self._model.mesh.points + point.guess.displacement[:, :3]
        arm = (position - position.mean(axis=0)) / np.ptp(position, axis=0).max()
        motions = []
        for axis in np.eye(3):
            for motion in (np.broadcast_to(axis, arm.shape), np.cross(axis, arm)):
                moved = np.zeros(constraints.mask.shape)
                moved[:, :3] = motion
                moved = turn(constraints, moved)
                moved[constraints.mask == 1] = 0.0
                motions.append(moved[:, :3].reshape(-1))
        return np.column_stack(motions)

    def _assemble(self, constraints: Constraints, point: Point, resistances: Sequence[Resistance | None]) -> None:
        """Fill the matrix with all stiffnesses, in the nodes' own frames."""
        assembler = self._mechanics.assembler
        self._mechanics.assemble_stiffness(constraints.turned, constraints.frames, self.data)
        for forces in point.forces:
            if forces and len(forces.pairs):
                blocks = _widen(forces.blocks, self._mechanics.freedoms)
                assembler.add_blocks(forces.pairs, blocks, constraints.turned, constraints.frames, self.data)
        for resistance in resistances:
            if resistance:
                symmetric = self._model.solver.symmetric
                resistance.add_stiffness(assembler, constraints, self.data, symmetric=symmetric)

    def _prescribe(self, mask: MaskArray, value: FloatArray, data: FloatArray, rhs: FloatArray) -> None:
        """Prescribe values (n_points, freedoms) in a matrix and its right-hand side, in place."""
        self._mechanics.assembler.constrain(mask.reshape(-1), value.reshape(-1), self._diagonal, data, rhs)


def flatten(points: FloatArray) -> FloatArray | None:
    """Return the coordinates of nodes (n_points, 2 | 3) in the plane that they lie in, None if they do not.

    The plane is one of the axes' planes, and a mesh lies in it if it is FLAT beside its length.
    """
    if points.shape[1] == 2:
        return points
    extent = np.ptp(points, axis=0)
    across = int(np.argmin(extent))
    return np.delete(points, across, axis=1) if extent[across] <= FLAT * extent.max() else None


def _widen(blocks: FloatArray, freedoms: int) -> FloatArray:
    """Return blocks (n, d, d) of the first d freedoms of nodes as those of all (n, freedoms, freedoms)."""
    more = freedoms - blocks.shape[1]
    return np.pad(blocks, ((0, 0), (0, more), (0, more))) if more else blocks
