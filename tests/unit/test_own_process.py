# SPDX-License-Identifier: Apache-2.0
"""A call in a process of its own gives what it gives here, and a crash or a loop there is an error here."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.mesh.checks import MeshError
from presswork.own_process import DiedError, call_apart


def test_results_and_errors_pass_back() -> None:
    assert call_apart("builtins:pow", 3, 4) == 81
    with pytest.raises(ValueError, match="invalid literal"):
        call_apart("builtins:int", "x")
    with pytest.raises(MeshError, match="not finite numbers"):
        call_apart("presswork.mesh.checks:check_coordinates", np.array([[np.nan, 0.0]]))


def test_a_process_that_ends_is_an_error() -> None:
    with pytest.raises(DiedError, match="SIGABRT"):
        call_apart("os:abort")
    with pytest.raises(DiedError, match="status 3"):
        call_apart("os:_exit", 3)


def test_a_call_that_never_ends_is_an_error() -> None:
    with pytest.raises(DiedError, match="takes more than 1 s"):
        call_apart("builtins:sum", iter(range(10**18)), seconds=1)
