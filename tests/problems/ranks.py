# SPDX-License-Identifier: Apache-2.0
"""Runs on ranks of MPI, by mpiexec as a user calls it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

OPEN_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMP_NUM_THREADS": "1",
}
"""Lets a container with fewer cores than ranks run them."""


def run_on_ranks(ranks: int, case: Path, folder: Path, *options: str, status: int = 0) -> str:
    """Compute a case on ranks of MPI, 1: by one process; return what it has said."""
    launcher = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
    program = [
        sys.executable,
        "-c",
        "from presswork.cli import main; main()",
        "run",
        str(case),
        "--output",
        str(folder),
    ]
    done = subprocess.run(
        [*launcher, *program, "--output", str(folder), "--no-plot", "--no-report", "--quiet", *options],
        env={**os.environ, **OPEN_MPI},
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert done.returncode == status, done.stderr
    return done.stderr
