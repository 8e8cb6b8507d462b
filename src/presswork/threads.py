# SPDX-License-Identifier: Apache-2.0
"""How many threads a run takes, and how they wait for each other."""

from __future__ import annotations

import os
from collections.abc import MutableMapping

SPINS = 1000
"""Looks of a waiting thread at the others before it gives its core away: some 10 us. GCC's runtime takes 300,000, which
costs a machine with other work two to three times the time of an explicit run (docs/performance/explicit_shells.md)."""


def limit_spinning(environment: MutableMapping[str, str]) -> None:
    """Let waiting threads release their cores soon, unless the user has set how they wait.

    GCC's OpenMP runtime reads this when it is loaded, so before the compiled module is.
    """
    if "OMP_WAIT_POLICY" not in environment:
        environment.setdefault("GOMP_SPINCOUNT", str(SPINS))


def available_threads() -> int:
    """Return the number of threads to use when none is asked for: OMP_NUM_THREADS, or else one for each core."""
    wanted = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return int(wanted) if wanted.isdigit() and int(wanted) > 0 else os.cpu_count() or 1
