# SPDX-License-Identifier: Apache-2.0
"""How many threads a run takes."""

from __future__ import annotations

import os


def available_threads() -> int:
    """Return the number of threads to use when none is asked for: OMP_NUM_THREADS, or else one for each core."""
    wanted = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return int(wanted) if wanted.isdigit() and int(wanted) > 0 else os.cpu_count() or 1
