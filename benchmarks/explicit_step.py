# SPDX-License-Identifier: Apache-2.0
"""How much longer an explicit step could be than the bound of the elements, on shells of the square cup's draw.

    python -m benchmarks.explicit_step [SIZE]      shells of SIZE mm (2)

At five depths, drawn at 10 m/s, it prints the step [s] that the elements' bound gives over 0.9, and by which factor the
step would be longer by other bounds of the squared frequency of the sheet as it is, free at its rims, elastic:

    element   the largest eigenvalue of any shell by itself
    node      the largest mean over a node's shells of theirs, weighted by mass: a bound, too
    mesh      the largest eigenvalue of the assembled mesh: what is stable and no more (Lanczos)
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import eigsh

from benchmarks.explicit_draw import DEPTHS, FAST, ROWS, write_case
from presswork.case import build_model, read_case
from presswork.explicit.shells import ExplicitShells
from presswork.law.umat import open_sheet_law
from presswork.model import FloatArray
from presswork.process.explicit.stamping import ExplicitStamping

MOVE = 1e-7
"""Of a node, by which stiffness is found [mm, rad]."""


def find_matrices(run: ExplicitStamping, inertia: FloatArray) -> FloatArray:
    """Return the elastic matrices of all shells (n, 24, 24), scaled by the roots of their masses; inertia (n, 24)."""
    cells, material = run.model.cells, run.model.sheet[1]
    apart = np.arange(cells.size).reshape(cells.shape)
    points = run.shells.position[cells].reshape(-1, 3)
    shells = ExplicitShells(points, apart, run.shells.thickness, open_sheet_law(material), material.density)
    matrix = np.zeros((len(cells), 24, 24))
    for column in range(24):
        move = np.zeros((len(cells), 24))
        move[:, column] = MOVE
        ahead, behind = (shells.trial_force(sign * move.reshape(-1, 6)) for sign in (1, -1))
        matrix[:, :, column] = ((ahead - behind) / (2.0 * MOVE)).reshape(len(cells), -1)
    matrix = 0.5 * (matrix + matrix.transpose(0, 2, 1))
    return np.asarray(matrix / np.sqrt(inertia[:, :, None] * inertia[:, None, :]))


def share_masses(run: ExplicitStamping) -> FloatArray:
    """Return the masses that each shell of the undeformed sheet gives its nodes' freedoms (n, 24)."""
    cells, material = run.model.cells, run.model.sheet[1]
    apart = np.arange(cells.size).reshape(cells.shape)
    points, thickness = run.shells.position[cells].reshape(-1, 3), run.shells.thickness
    shells = ExplicitShells(points, apart, thickness, open_sheet_law(material), material.density)
    return np.repeat(shells.mass, 3, axis=1).reshape(len(cells), 24)


def main() -> None:
    """Print the table."""
    size = sys.argv[1] if len(sys.argv) > 1 else "2"
    with tempfile.TemporaryDirectory() as folder:
        speeds = [f"stages.{2 * i + 1}.velocity={FAST}" for i in range(len(DEPTHS))]
        case = read_case(write_case(Path(folder)), [f"blank.element_size={size}", *speeds])
        run = ExplicitStamping(build_model(case), threads=1)
    inertia, rows = share_masses(run), run.advance()
    freedoms = (6 * run.model.cells[:, :, None] + np.arange(6)).reshape(len(inertia), 24)
    mass = np.bincount(freedoms.ravel(), inertia.ravel())
    print("depth [mm]   bound [s]   element   node   mesh")
    for depth in (0.0, *DEPTHS):
        for _ in range(2 * ROWS if depth else 0):
            next(rows)
        scaled = find_matrices(run, inertia)
        alone = np.linalg.eigvalsh(scaled)[:, -1]
        mean = np.bincount(freedoms.ravel(), (alone[:, None] * inertia).ravel()) / mass
        root = np.sqrt(inertia / mass[freedoms])  # from masses of shells to those of nodes
        entries = scaled * root[:, :, None] * root[:, None, :]
        at = np.broadcast_to(freedoms[:, :, None], entries.shape), np.broadcast_to(freedoms[:, None, :], entries.shape)
        mesh = eigsh(csr_matrix((entries.ravel(), (at[0].ravel(), at[1].ravel()))), 1, which="LA", tol=1e-6)[0][0]
        bound = run.shells.bound_frequencies().max()
        factors = "   ".join(f"{np.sqrt(bound / other):6.3f}" for other in (alone.max(), mean.max(), mesh))
        print(f"{depth:10g}   {2.0 / np.sqrt(bound):9.3g}   {factors}", flush=True)


if __name__ == "__main__":
    main()
