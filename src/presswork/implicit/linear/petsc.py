# SPDX-License-Identifier: Apache-2.0
"""Linear systems whose rows are divided over ranks, by PETSc (Balay et al. 1997).

Factors by MUMPS (Amestoy et al. 2001): up to a size on rank 0 alone, which gives the same bits in every run; beyond
it on all ranks, whose order of work MUMPS chooses as it goes, so that the last bits of runs differ. Large bodies in
space are iterated: conjugate gradients preconditioned by PETSc's smoothed aggregation (GAMG) with rigid motions; with a
pressure at the nodes, generalised minimal residuals preconditioned block by block (Elman, Silvester & Wathen 2014,
ch. 4), GAMG on the displacements and Jacobi's method on the pressures' complement C + G^T diag(K)^-1 G. On more than
two ranks the last bits of GAMG's iterations differ from run to run, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from presswork.implicit.linear.contract import Iterations, Modes, SolverError
from presswork.model import FloatArray, IntArray
from presswork.ranks.assembler import DividedAssembler

TOLERANCE = 1e-8
"""Residual over the right-hand side: ranks find the answer of one process to all digits that matter."""
MOST = 400
"""Iterations after which the matrix is factorised instead."""
LEVELS = {"pc_type": "gamg", "mg_levels_pc_type": "sor"}
"""Smoothed aggregation; on each level Chebyshev's method with each rank's symmetric sweeps."""
PRODUCTS = {"matptap_via": "allatonce"}
"""Coarse matrices are summed up in one order: PETSc's default adds what ranks send as it comes."""
MOST_ON_ONE = 100_000
"""Rows that rank 0 factorises alone."""
DISPLACEMENTS = 3
"""Freedoms of a node before its pressure."""


class PetscSolver:
    """Solves systems of one pattern on all ranks; takes and gives whole vectors."""

    def __init__(self, assembler: DividedAssembler, iterates: bool) -> None:
        """iterates: by multigrid, by factors only where that fails."""
        self._assembler, self._iterates = assembler, iterates
        self._is_on_one = len(assembler.indptr) - 1 <= MOST_ON_ONE
        factors = "factors by MUMPS on rank 0" if self._is_on_one else "factors by MUMPS on all, last bits may differ"
        kind = "smoothed aggregation with rigid motions (GAMG)" if iterates else factors
        self.name = f"PETSc on {assembler.world.size} ranks, {kind}"
        self.iterations: Iterations | None = None
        self._matrix: Any = None
        self._solver: Any = None
        self._factors: Any = None
        self._is_factorised = False
        self._number_rows()

    @property
    def negative_pivots(self) -> int:
        """Return nothing: PETSc does not report them."""
        return 0

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        """Take the matrix: values of this rank in the assembler's pattern."""
        from petsc4py import PETSc

        values = self._assembler.sum_entries(data)[self._from]
        if self._matrix is None:
            sizes = (self._n_own, len(self._assembler.indptr) - 1)
            rows, columns = self._start.astype(PETSc.IntType), self._columns.astype(PETSc.IntType)
            self._matrix = PETSc.Mat().createAIJ((sizes, sizes), bsize=self._assembler.freedoms, csr=(rows, columns))
            self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, self._assembler.symmetric)
            self._pattern = rows, columns
        self._matrix.setValuesCSR(*self._pattern, values)
        self._matrix.assemble()
        self._is_factorised = False
        if not self._iterates:
            self._factorise()
            return
        assert modes is not None, "aggregates move by rigid motions"
        if self._solver is None:
            self._solver = self._make_iterative()
        self._set_modes(modes())
        try:
            self._solver.setUp()
        except PETSc.Error as error:
            raise SolverError(f"PETSc cannot prepare the matrix: {error}") from error

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution, the same on all ranks; of the right-hand side, own rows count. Raises SolverError."""
        if self._is_factorised:
            return self._solve(self._factors, rhs)
        solution = self._solve(self._solver, rhs)
        reason, count, residual = (
            self._solver.getConvergedReason(),
            self._solver.getIterationNumber(),
            self._solver.getResidualNorm(),
        )
        if reason > 0:
            norm = self._right.norm()
            self.iterations = Iterations(count, residual / norm if norm > 0.0 else 0.0)
            return solution
        self._factorise()
        remark = f"PETSc's reason {reason} after {count} iterations"
        self.iterations = Iterations(0, 0.0, remark)
        return self._solve(self._factors, rhs)

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        """Return the solutions (k, n) one after the other."""
        return np.array([self.solve(each) for each in rhs])

    # --- rows ---------------------------------------------------------------------------------------------------------

    def _number_rows(self) -> None:
        """Number the rows of each rank one after another, and find the entries of this rank's rows in its values."""
        assembler = self._assembler
        owner, d, me = assembler.division.owner, assembler.freedoms, assembler.world.rank
        number = np.empty(len(owner), dtype=np.int64)
        number[np.argsort(owner, kind="stable")] = np.arange(len(owner))
        of_row = (d * number[:, None] + np.arange(d)).reshape(-1)
        rank = np.repeat(owner, d)
        row = np.repeat(np.arange(len(rank)), np.diff(assembler.indptr))
        column = np.asarray(assembler.indices, dtype=np.int64)
        at = np.flatnonzero(rank[row] == me)
        rows, columns = of_row[row[at]], of_row[column[at]]
        if assembler.symmetric:
            below = np.flatnonzero((rank[column] == me) & (row != column))
            at = np.concatenate([at, below])
            rows = np.concatenate([rows, of_row[column[below]]])
            columns = np.concatenate([columns, of_row[row[below]]])
        order = np.lexsort((columns, rows))
        self._own_rows = (d * assembler.own_nodes[:, None] + np.arange(d)).reshape(-1)
        self._n_own = len(self._own_rows)
        first = d * int((owner < me).sum())
        self._from, self._columns = at[order], columns[order]
        self._start: IntArray = np.searchsorted(rows[order], first + np.arange(self._n_own + 1)).astype(np.int32)

    def _solve(self, solver: Any, rhs: FloatArray) -> FloatArray:
        from petsc4py import PETSc

        self._right, found = self._matrix.createVecs(side="left"), self._matrix.createVecs(side="right")
        self._right.setArray(rhs[self._own_rows])
        try:
            solver.solve(self._right, found)
        except PETSc.Error as error:
            raise SolverError(f"PETSc: {error}") from error
        whole = np.zeros_like(rhs)
        whole[self._own_rows] = found.getArray(readonly=True)
        whole = self._assembler.gather(whole.reshape(-1, self._assembler.freedoms)).reshape(-1)
        if not np.isfinite(whole).all() or (solver is self._factors and solver.getConvergedReason() < 0):
            raise SolverError("the matrix is singular")
        return whole

    # --- solvers ------------------------------------------------------------------------------------------------------

    def _factorise(self) -> None:
        """Factorise by MUMPS. Raises SolverError."""
        from petsc4py import PETSc

        if self._factors is None:
            kind: dict[str, object] = {
                "pc_type": "cholesky" if self._assembler.symmetric else "lu",
                "pc_factor_mat_solver_type": "mumps",
            }
            if self._is_on_one:
                kind = {f"telescope_{name}": value for name, value in kind.items()} | {
                    "pc_type": "telescope",
                    "pc_telescope_reduction_factor": self._assembler.world.size,
                    "telescope_ksp_type": "preonly",
                }
            self._factors = self._make("presswork_factors_", {"ksp_type": "preonly", **kind})
        self._factors.setOperators(self._matrix)
        try:
            self._factors.setUp()
        except PETSc.Error as error:
            raise SolverError(f"MUMPS: {error}") from error
        self._is_factorised = True

    def _make_iterative(self) -> Any:
        """Return the solver by iteration."""
        from petsc4py import PETSc

        for name, value in PRODUCTS.items():
            PETSc.Options()[name] = value
        has_pressure = self._assembler.freedoms > DISPLACEMENTS
        is_definite = self._assembler.symmetric and not has_pressure
        options = {"ksp_type": "cg" if is_definite else "fgmres", "ksp_gmres_restart": 100}
        if has_pressure:
            options |= {
                "pc_type": "fieldsplit",
                "pc_fieldsplit_type": "schur",
                "pc_fieldsplit_schur_fact_type": "lower",
                "pc_fieldsplit_schur_precondition": "selfp",
                **{f"fieldsplit_u_{name}": value for name, value in LEVELS.items()},
                "fieldsplit_u_ksp_type": "preonly",
                "fieldsplit_p_ksp_type": "preonly",
                "fieldsplit_p_pc_type": "jacobi",
            }
        else:
            options |= LEVELS
        return self._make("presswork_", options)

    def _make(self, prefix: str, options: Mapping[str, object]) -> Any:
        """Return a solver of the matrix by PETSc's options."""
        from petsc4py import PETSc

        known = PETSc.Options(prefix)
        for name, value in options.items():
            known[name] = value
        solver = PETSc.KSP().create(self._matrix.getComm())
        solver.setOptionsPrefix(prefix)
        solver.setOperators(self._matrix)
        if options["ksp_type"] != "preonly":
            solver.setTolerances(rtol=TOLERANCE, atol=1e-300, max_it=MOST)
            solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        if options["pc_type"] == "fieldsplit":
            self._split(solver.getPC())
        solver.setFromOptions()
        return solver

    def _split(self, preconditioner: Any) -> None:
        """Take displacements and pressures apart."""
        from petsc4py import PETSc

        preconditioner.setType("fieldsplit")
        first, end = self._matrix.getOwnershipRange()
        pressure = np.arange(first + DISPLACEMENTS, end, DISPLACEMENTS + 1, dtype=PETSc.IntType)
        displacement = np.setdiff1d(np.arange(first, end, dtype=PETSc.IntType), pressure)
        self._displacements = PETSc.IS().createGeneral(displacement, comm=self._matrix.getComm())
        self._displacements.setBlockSize(DISPLACEMENTS)
        pressures = PETSc.IS().createGeneral(pressure, comm=self._matrix.getComm())
        preconditioner.setFieldSplitIS(("u", self._displacements), ("p", pressures))

    def _set_modes(self, modes: FloatArray) -> None:
        """Set the rigid motions (n_points * 3, 6) of this rank's nodes."""
        from petsc4py import PETSc

        communicator, own = self._matrix.getComm(), self._assembler.own_nodes
        of_own = modes.reshape(-1, DISPLACEMENTS, modes.shape[1])[own].reshape(-1, modes.shape[1])
        orthogonal = _orthogonalise(of_own, communicator)
        vectors = []
        for mode in orthogonal.T:
            vector = PETSc.Vec().createMPI((len(mode), PETSc.DECIDE), bsize=DISPLACEMENTS, comm=communicator)
            vector.setArray(mode)
            vectors.append(vector)
        near = PETSc.NullSpace().create(vectors=vectors, comm=communicator)
        if self._assembler.freedoms == DISPLACEMENTS:
            self._matrix.setNearNullSpace(near)
            return
        self._displacements.compose("nearnullspace", near)


def _orthogonalise(modes: FloatArray, communicator: Any) -> FloatArray:
    """Return orthonormal columns that span those of all ranks' modes, by the inverse Cholesky factor of M^T M."""
    gram = communicator.tompi4py().allreduce(modes.T @ modes)
    return np.asarray(np.linalg.solve(np.linalg.cholesky(gram), modes.T).T)
