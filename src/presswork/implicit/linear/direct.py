# SPDX-License-Identifier: Apache-2.0
"""Sparse direct solvers: analyse once per pattern, factorise, solve.

MKL PARDISO where it is installed (x86-64), SciPy's SuperLU elsewhere. PARDISO runs in its reproducible mode, so that
the same matrix gives the same bits with any number of threads.
"""

from __future__ import annotations

import ctypes
import glob
import os
import sys
import weakref
from functools import cache
from importlib import metadata
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from presswork.implicit.linear.contract import Modes, SolverError
from presswork.model import FloatArray, IntArray


class SuperLU:
    """SciPy's SuperLU: slower and not threaded, but everywhere. It reports whether negative pivots are odd."""

    name = "SuperLU (SciPy); install pypardiso on x86-64 for speed"
    iterations = None

    def __init__(self, indptr: IntArray, indices: IntArray, *, symmetric: bool) -> None:
        self._pattern = (indices, indptr)
        self._symmetric = symmetric
        self._factor: Any = None

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        from scipy.sparse.linalg import splu

        n = len(self._pattern[1]) - 1
        matrix = scipy.sparse.csr_matrix((data, *self._pattern), shape=(n, n))
        if self._symmetric:
            matrix = matrix + scipy.sparse.triu(matrix, 1).T
        try:
            self._factor = splu(matrix.tocsc())
        except RuntimeError as error:
            if "memory" in str(error).lower():
                raise MemoryError(str(error)) from error
            raise SolverError(str(error)) from error

    @property
    def negative_pivots(self) -> int:
        """One if the determinant is negative."""
        assert self._factor is not None, "factorise first"
        swaps = sum(_count_swaps(order) for order in (self._factor.perm_r, self._factor.perm_c))
        return (int((self._factor.U.diagonal() < 0.0).sum()) + swaps) % 2

    def solve(self, rhs: FloatArray) -> FloatArray:
        assert self._factor is not None, "factorise first"
        solution: FloatArray = self._factor.solve(rhs)
        return solution

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        return np.ascontiguousarray(self.solve(np.ascontiguousarray(rhs.T)).T)


def _count_swaps(order: IntArray) -> int:
    """Return the number of exchanges that a permutation is made of."""
    from scipy.sparse.csgraph import connected_components

    n = len(order)
    moves = scipy.sparse.csr_matrix((np.ones(n), (np.arange(n), order)), shape=(n, n))
    cycles, _ = connected_components(moves, directed=False)
    return n - int(cycles)


def _integer(value: int) -> ctypes.Array[ctypes.c_int]:
    return (ctypes.c_int * 1)(value)


def _release(pardiso: Any, handle: NDArray[np.int64], matrix_type: int, n: int) -> None:
    """Give PARDISO's memory back."""
    head = [_integer(v) for v in (1, 1, matrix_type, -1, n)]
    settings = np.zeros(64, dtype=np.int32)
    pardiso(handle.ctypes.data, *head, *[None] * 3, _integer(0), _integer(1), settings.ctypes.data, _integer(0),
            None, None, _integer(0))  # fmt: skip


def _explain(error: int) -> SolverError | MemoryError:
    """Return what to raise for an error of PARDISO; where memory ends, smaller increments would not help."""
    if error in (-2, -9):
        return MemoryError("PARDISO has not enough memory")
    return SolverError("the matrix is singular" if error == -4 else f"PARDISO error {error}")


def _find_mkl() -> str | None:
    """Return the path of MKL's library: from PYPARDISO_MKL_RT, or where pip and conda put it.

    In an environment on top of another one the installed package `mkl` knows its place. Elsewhere pypardiso finds it,
    which walks all folders of the environment and loads SciPy's sparse matrices first.
    """
    named = os.environ.get("PYPARDISO_MKL_RT")
    here = [named] if named else sorted(glob.glob(f"{glob.escape(sys.prefix)}/lib/libmkl_rt.so*"))
    if here or (here := _list_mkl_of_package()):
        return here[0]
    try:
        from pypardiso.pardiso_wrapper import PyPardisoSolver

        return str(PyPardisoSolver().libmkl._name)
    except ImportError:
        return None


def _list_mkl_of_package() -> list[str]:
    """Return the paths of MKL's library in the installed package `mkl`, whatever environment that lies in."""
    try:
        files = metadata.files("mkl") or []
    except metadata.PackageNotFoundError:
        return []
    places = sorted(str(file.locate()) for file in files if file.name.startswith("libmkl_rt.so"))
    return [place for place in places if os.path.exists(place)]


@cache
def _load_mkl() -> tuple[Any, Any] | None:
    """Return the library and its function pardiso, with argument types of our own; None where it is not installed."""
    # one OpenMP runtime for our loops and MKL's, or the idle threads of one slow down the other
    os.environ.setdefault("MKL_THREADING_LAYER", "GNU")
    os.environ.setdefault("MKL_CBWR", "AUTO")  # the same bits from run to run
    path = _find_mkl()
    if path is None:
        return None
    library, pardiso = ctypes.CDLL(path), ctypes.CDLL(path).pardiso
    pardiso.argtypes = [ctypes.c_void_p] * 16
    pardiso.restype = None
    return library, pardiso


class Pardiso:
    """MKL PARDISO; the analysis is done once, when it is made."""

    name = "MKL PARDISO"
    iterations = None

    def __init__(
        self,
        indptr: IntArray,
        indices: IntArray,
        *,
        symmetric: bool,
        threads: int,
        order: IntArray | None = None,
        single: bool = False,
    ) -> None:
        """order: of elimination (n,); None: METIS finds one. single: factors, right-hand sides and solutions are."""
        loaded = _load_mkl()
        if loaded is None:
            raise ImportError("MKL PARDISO is not installed")
        library, self._pardiso = loaded
        library.MKL_Set_Num_Threads(ctypes.c_int(threads))
        self._handle = np.zeros(64, dtype=np.int64)
        self._indptr, self._indices = np.ascontiguousarray(indptr), np.ascontiguousarray(indices)
        self._precision: type[np.floating[Any]] = np.float32 if single else np.float64
        self._data = np.zeros(len(indices), dtype=self._precision)
        self._type = -2 if symmetric else 11
        self._n = len(indptr) - 1
        self._finalizer = weakref.finalize(self, _release, self._pardiso, self._handle, self._type, self._n)
        self._iparm = np.zeros(64, dtype=np.int32)
        settings = {0: 1, 1: 2, 7: 0, 9: 8 if symmetric else 13, 10: 0, 17: -1, 20: 1, 27: int(single), 34: 1}
        if order is not None:
            settings[4] = 1
        for position, value in settings.items():
            self._iparm[position] = value
        self._order = np.ascontiguousarray(order if order is not None else [], dtype=np.int32)
        empty = np.zeros(self._n, dtype=self._precision)
        self._call(11, empty, empty)  # the analysis; without scaling and matching it asks for no values

    def _call(self, phase: int, rhs: NDArray[Any], solution: NDArray[Any]) -> None:
        error = _integer(0)
        self._pardiso(
            self._handle.ctypes.data,
            *(_integer(v) for v in (1, 1, self._type, phase, self._n)),
            self._data.ctypes.data,
            self._indptr.ctypes.data,
            self._indices.ctypes.data,
            self._order.ctypes.data,
            _integer(rhs.size // self._n),
            self._iparm.ctypes.data,
            _integer(0),
            rhs.ctypes.data,
            solution.ctypes.data,
            error,
        )
        if error[0] != 0:
            raise _explain(error[0])

    @property
    def negative_pivots(self) -> int:
        """Their number in a symmetric matrix; an unsymmetric one does not show it."""
        return int(self._iparm[22]) if self._type == -2 else 0

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        self._data = np.ascontiguousarray(data, dtype=self._precision)
        empty = np.zeros(self._n, dtype=self._precision)
        self._call(22, empty, empty)

    def solve(self, rhs: FloatArray) -> FloatArray:
        return self.solve_all(rhs)

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        solution = np.zeros(rhs.shape, dtype=self._precision)
        # by columns, as PARDISO reads them
        self._call(33, np.ascontiguousarray(rhs, dtype=self._precision), solution)
        return solution
