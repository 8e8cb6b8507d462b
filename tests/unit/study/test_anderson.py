# SPDX-License-Identifier: Apache-2.0
"""Anderson's acceleration."""

from __future__ import annotations

import numpy as np

from presswork.study.anderson import Anderson


def iterate(most: int, *, accelerated: bool) -> float:
    """Return the residual of a linear problem of three slow modes."""
    slow = np.array([[0.1, 0.0, 0.0], [0.02, 0.3, 0.0], [0.0, 0.05, 0.6]])
    x, wanted, weight = np.zeros((3, 1)), np.array([[1.0], [2.0], [3.0]]), np.array([1.0, 2.0, 3.0])
    anderson = Anderson(weight)
    for _ in range(most):
        residual = slow @ x - wanted
        anderson = anderson if accelerated else Anderson(weight)
        x = anderson.step(x, residual)
    return float(np.abs(slow @ x - wanted).max())


def test_three_slow_modes_are_found_in_a_few_steps() -> None:
    assert iterate(7, accelerated=False) > 0.1
    assert iterate(7, accelerated=True) < 1e-2


def test_a_residual_that_has_grown_forgets_what_was_before() -> None:
    anderson = Anderson(np.ones(2))
    x = anderson.step(np.zeros((2, 1)), np.array([[1.0], [0.0]]))
    x = anderson.step(x, np.array([[0.0], [2.0]]))
    assert x.ravel().tolist() == [-1.0, -2.0]


def test_differences_that_differ_by_noise_alone_are_not_told_apart() -> None:
    """One mode of slope 0.5, and noise of a thousandth in each residual: the third step stays near the solution."""
    noise = np.array([[0.0, 0.0], [2e-3, 0.0], [0.0, 2e-3], [2e-3, 2e-3]])
    anderson, x = Anderson(np.ones(2)), np.zeros((2, 1))
    wanted = np.array([[1.0], [1.0]])
    for each in noise:
        x = anderson.step(x, 0.5 * x - wanted + each[:, None])
    np.testing.assert_allclose(x, 2.0 * wanted, atol=0.01)
