# SPDX-License-Identifier: Apache-2.0
"""How much memory a Model takes to compute, and how much the machine has."""

from __future__ import annotations

import os
import resource
from pathlib import Path

import numpy as np

from presswork import model

_BYTES_PER_POINT = 4 * 8 * 16
"""Four copies of about 16 numbers at a quadrature point: converged, trial, and work arrays."""
_BYTES_PER_LAYER = 3 * 8 * 8
"""Three copies of about 8 numbers at a point of a layer of a shell."""
_BYTES_PER_ENTRY = 8 + 0.6 * 12
"""Bytes of an entry in an element's matrix: the value, and 12 bytes an entry once merged."""
_FACTOR_BYTES_PER_FREEDOM = {1: 2500.0, 2: 2500.0, 3: 12000.0, 4: 12000.0, 6: 3500.0}
"""Bytes of a sparse factorisation for each freedom at 100,000 freedoms, by freedoms of a node; they grow with the
logarithm of that number."""
_ENTRIES_OF_ROW = 81
"""Number of entries of a row in the matrix of hexahedra."""
_MULTIGRID_BYTES_PER_ENTRY = 45.0
"""Bytes of an entry in the whole matrix: its values twice, their places of origin, and the levels above."""
_EXPLICIT_BYTES_PER_CELL = 2000.0
"""Bytes of an explicit cell beside its layers: mesh, forces, work arrays and output."""

_ADDRESS_SPACE, _DATA = 0, 5
"""Columns of /proc/self/statm."""


class TooLargeError(Exception):
    """A problem that the machine's memory does not hold; the message holds the remedy."""


def estimate_memory(problem: model.Model) -> float:
    """Estimate the bytes for mesh, state, matrix and factors."""
    with_matrix = problem.explicit is None or problem.springback is not None
    blocks = [(len(b.connectivity), b.element, b.section.points if b.section else 0) for b in problem.mesh.blocks]
    nodes_per_cell = len(problem.mesh.points) / sum(cells for cells, _, _ in blocks)
    return sum(
        _estimate_block(
            cells, element, layers, nodes_per_cell * cells, problem.freedoms, with_matrix, problem.takes_multigrid
        )
        for cells, element, layers in blocks
    )


def _estimate_block(
    cells: int, element: str, layers: int, nodes: float, freedoms: int, with_matrix: bool, iterates: bool = False
) -> float:
    """Estimate the bytes for cells of one kind, with their nodes. iterates: multigrid solves, no factors are made."""
    state = cells * _count_points(element, layers) * (_BYTES_PER_LAYER if layers else _BYTES_PER_POINT)
    if not with_matrix:
        return state + cells * _EXPLICIT_BYTES_PER_CELL
    matrix = cells * (freedoms * model.ELEMENTS[element].nodes) ** 2 * _BYTES_PER_ENTRY
    unknowns = freedoms * nodes
    if iterates:
        return state + matrix + unknowns * _ENTRIES_OF_ROW * _MULTIGRID_BYTES_PER_ENTRY
    factor = _FACTOR_BYTES_PER_FREEDOM[freedoms] * unknowns * float(np.log(max(unknowns, 2)) / np.log(1e5))
    return state + matrix + factor


def _count_points(element: str, layers: int) -> int:
    """Return the quadrature points of a cell, those through the thickness included."""
    return model.ELEMENTS[element].points * max(layers, 1)


def estimate_rectangle(cells: int, element: str, layers: int, *, explicit: bool) -> float:
    """Estimate the bytes for a rectangle of so many cells, before it is meshed. layers: of a shell, else 0."""
    cell = model.cell_of(element)
    edges = 0.5 * cell.corners  # of a cell, each shared by two; Euler's formula has the corners
    nodes = cells * (edges - 1.0 + edges * cell.is_quadratic + len(cell.inner))
    return _estimate_block(cells, element, layers, nodes, 6 if layers else 2, not explicit)


def estimate_box(cells: int, element: str) -> float:
    """Estimate the bytes for a box of so many hexahedra, or of six tetrahedra in each, before it is meshed."""
    row = model.ELEMENTS[element]
    cell = model.CELLS[row.cell]
    count = 6 * cells if cell.is_simplex else cells
    edges = cells + count * (0.5 * len(cell.faces) - 1.0)  # Euler's formula, a corner to a hexahedron
    nodes = cells + edges * cell.is_quadratic + count * len(cell.inner)
    iterates = row.freedoms == 3 and 3 * nodes >= model.LARGE
    return _estimate_block(count, element, 0, nodes, row.freedoms, with_matrix=True, iterates=iterates)


def check_memory(problem: model.Model) -> None:
    """Raise TooLargeError where the problem needs more memory than there is."""
    needed, there = estimate_memory(problem), available_memory()
    if needed > there:
        raise TooLargeError(explain_shortage(needed, there))


def explain_shortage(needed: float, there: float) -> str:
    """Explain how much memory is missing and what to do."""
    return (
        f"about {needed / 1e6:,.0f} MB of memory are needed, and {there / 1e6:,.0f} MB are free on this machine; "
        "take fewer or larger elements, close other programs, or compute it on a larger machine"
    )


def available_memory() -> float:
    """Return the bytes that this process may still take: of the machine, of its control group, of its own limits."""
    limits = [_free_of_machine(), _free_of_group(Path("/sys/fs/cgroup"))]
    for limit, column in ((resource.RLIMIT_AS, _ADDRESS_SPACE), (resource.RLIMIT_DATA, _DATA)):
        soft, _ = resource.getrlimit(limit)
        if soft != resource.RLIM_INFINITY:
            limits.append(max(soft - _pages_taken(column), 0.0))
    return min(limits)


def _free_of_machine() -> float:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return float(line.split()[1]) * 1024
    except (OSError, ValueError, IndexError):
        pass
    return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))


def _free_of_group(folder: Path) -> float:
    """Return what is left of a control group's limit, version 2 or 1; infinite without one."""
    for most, used in (
        ("memory.max", "memory.current"),
        ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes"),
    ):
        try:
            return max(float((folder / most).read_text()) - float((folder / used).read_text()), 0.0)
        except (OSError, ValueError):  # no such file, or "max"
            continue
    return float("inf")


def _pages_taken(column: int) -> float:
    """Return the bytes of this process in a column of statm."""
    try:
        return float(Path("/proc/self/statm").read_text(encoding="ascii").split()[column]) * resource.getpagesize()
    except (OSError, ValueError, IndexError):
        return 0.0
