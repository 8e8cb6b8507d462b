# SPDX-License-Identifier: Apache-2.0
"""How waiting threads are told to wait."""

import os

import pytest

import presswork  # noqa: F401  says it to the runtime
from presswork.threads import SPINS, limit_spinning


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, {"GOMP_SPINCOUNT": str(SPINS)}),
        ({"GOMP_SPINCOUNT": "7"}, {"GOMP_SPINCOUNT": "7"}),
        ({"OMP_WAIT_POLICY": "active"}, {"OMP_WAIT_POLICY": "active"}),
    ],
)
def test_the_users_word_counts(given: dict[str, str], expected: dict[str, str]) -> None:
    environment = dict(given)
    limit_spinning(environment)
    assert environment == expected


def test_importing_presswork_says_it() -> None:
    assert "GOMP_SPINCOUNT" in os.environ or "OMP_WAIT_POLICY" in os.environ
