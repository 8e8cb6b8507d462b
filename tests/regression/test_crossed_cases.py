# SPDX-License-Identifier: Apache-2.0
"""Crosses of the examples are described or refused by key and remedy; remedies that can be done help.

Samples; `validation/test_crossed_cases.py` reads 5,000.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mutants.crosses import read_cross, write_cross, write_files
from tests.mutants.remedies import try_remedies

SEEDS, SPOILT = (*range(60), 2909, 22044, 31595), (*range(40), 20022, 21076, 30560)
"""Beyond the first ones those that once were a fault."""


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a case goes, beside the files of all examples."""
    folder = tmp_path_factory.mktemp("crosses")
    write_files(folder)
    return folder / "case.toml"


@pytest.mark.parametrize("seed", SEEDS)
def test_a_cross_is_described_or_refused_by_key_and_remedy(case: Path, seed: int) -> None:
    case.write_bytes(write_cross(seed))
    read_cross(case)


@pytest.mark.parametrize("seed", SPOILT)
def test_a_remedy_that_a_message_spells_out_helps(case: Path, seed: int) -> None:
    assert not try_remedies(case, seed).faults
