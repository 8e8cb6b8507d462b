# SPDX-License-Identifier: Apache-2.0
"""Tests run in several processes, one a core: each takes one thread, and sets this before any library is loaded."""

import os

if "PYTEST_XDIST_WORKER" in os.environ:
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
