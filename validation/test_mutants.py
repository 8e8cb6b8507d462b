# SPDX-License-Identifier: Apache-2.0
"""At least 10,000 changed files of every kind: no traceback, no crash, no hang.

`PRESSWORK_MUTANTS=N` reads N in all. Prints how many of each kind were taken and refused.
"""

from __future__ import annotations

import os
from collections import Counter
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.mutants.kinds import KINDS
from tests.mutants.mutate import mutate
from tests.mutants.pool import Reader, write_seed

pytestmark = pytest.mark.validation

COUNT = int(os.environ.get("PRESSWORK_MUTANTS", "10000"))
"""Of all kinds."""
_WHOLE = sum(kind.share for kind in KINDS.values())


@pytest.mark.parametrize("kind", KINDS)
def test_mutants_are_taken_or_refused_in_words(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    reader, seed, verdicts = Reader(), write_seed(kind), Counter[str]()
    ending = KINDS[kind].name.rsplit(".", 1)[-1]
    number = int(COUNT * KINDS[kind].share / _WHOLE) + 1
    assert reader.read(kind, seed) == ("taken", "")

    @settings(max_examples=number, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(number=st.integers(0, 2**63))
    def read(number: int) -> None:
        verdict, said = reader.read(kind, mutate(seed, ending, Random(number)))
        verdicts[verdict] += 1
        assert verdict in ("taken", "refused"), said

    try:
        read()
    finally:
        reader.close()
        with capsys.disabled():
            print(f"\n{kind}: {dict(sorted(verdicts.items()))}", end="")
    assert sum(verdicts.values()) >= number
