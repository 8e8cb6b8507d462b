# SPDX-License-Identifier: Apache-2.0
"""Whether mpiexec has started this process, by what launchers leave in the environment; MPI is not loaded for that."""

from __future__ import annotations

import os
from collections.abc import Mapping

SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE")
"""Number of ranks by Open MPI; by MPICH, Intel MPI and srun with PMI; by MVAPICH."""


def count_ranks(environment: Mapping[str, str] = os.environ) -> int:
    """Return how many processes compute together: 1 unless a launcher of MPI has started several.

    A job of SLURM has tasks even where it starts one process by itself, so these count only under `srun --mpi=pmix`.
    """
    names = [*SIZES, *(["SLURM_STEP_NUM_TASKS"] if "PMIX_RANK" in environment else [])]
    found = [environment[name] for name in names if environment.get(name, "").isdigit()]
    return max(int(found[0]), 1) if found else 1
