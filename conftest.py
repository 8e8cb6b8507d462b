# SPDX-License-Identifier: Apache-2.0
"""Each process of tests takes one thread, said before libraries are loaded; validation takes the time that it needs."""

import faulthandler
import os

import pytest

if "PYTEST_XDIST_WORKER" in os.environ:
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Lift the limit on time, which is for tests that hang, from long runs."""
    if item.get_closest_marker("validation"):
        faulthandler.cancel_dump_traceback_later()
