# SPDX-License-Identifier: Apache-2.0
"""Runs on ranks of MPI, by mpiexec as a user calls it."""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import sys
from pathlib import Path

OPEN_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMP_NUM_THREADS": "1",
}
"""Lets a container with fewer cores than ranks run them: Open MPI 4 and 5."""


@functools.cache
def explain_no_mpi() -> str:
    """Return why ranks cannot be started here; nothing where they can."""
    if shutil.which("mpiexec") is None:
        return 'there is no mpiexec: pip install "presswork[mpi]"'
    say = "import os; from mpi4py import MPI; os.write(1, b'%d\\n' % MPI.COMM_WORLD.size)"  # at once, as print does not
    done = _run(["mpiexec", "-n", "2", sys.executable, "-c", say], 60)
    if done.stdout.split() == ["2", "2"]:
        return ""
    return f"mpiexec does not start two ranks of mpi4py: {(done.stderr or done.stdout).strip()[-200:]}"


def run_on_ranks(ranks: int, case: Path, folder: Path, *options: str, status: int = 0) -> str:
    """Compute a case on ranks of MPI, 1: by one process; return what it has said."""
    launcher = ["mpiexec", "-n", str(ranks)] if ranks > 1 else []
    program = [sys.executable, "-c", "from presswork.cli import main; main()", "run", str(case)]
    switches = ["--output", str(folder), "--no-plot", "--no-report", "--quiet"]
    done = _run([*launcher, *program, *switches, *options], 200)
    assert done.returncode == status, done.stderr
    return done.stderr


def run_module_on_ranks(ranks: int, module: str, *options: str) -> str:
    """Run a module of tests on ranks of MPI; return what it has printed."""
    done = _run(["mpiexec", "-n", str(ranks), sys.executable, "-m", module, *options], 200)
    assert done.returncode == 0, done.stderr
    return done.stdout


def _run(command: list[str], timeout: float) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, env={**os.environ, **OPEN_MPI}, capture_output=True, text=True, timeout=timeout, check=False
    )
