# SPDX-License-Identifier: Apache-2.0
"""A changed file of any kind is taken or refused in words: no traceback, no crash, no hang.

A sample; `validation/test_mutants.py` reads 10,000.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.mutants.kinds import KINDS
from tests.mutants.mutate import mutate
from tests.mutants.pool import Reader, write_seed

_seed = functools.cache(write_seed)


@pytest.fixture(scope="module")
def reader() -> Iterator[Reader]:
    """One worker for all; a crash starts another."""
    one = Reader()
    yield one
    one.close()


@pytest.mark.parametrize("kind", KINDS)
def test_the_valid_file_is_taken(kind: str, reader: Reader) -> None:
    assert reader.read(kind, _seed(kind)) == ("taken", "")


@settings(max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
@given(kind=st.sampled_from(sorted(KINDS)), random=st.randoms(use_true_random=False))
def test_a_mutant_is_taken_or_refused_in_words(kind: str, random: Random, reader: Reader) -> None:
    content = mutate(_seed(kind), KINDS[kind].name.rsplit(".", 1)[-1], random)
    verdict, said = reader.read(kind, content)
    assert verdict in ("taken", "refused"), said
    assert verdict == "taken" or said.strip()


@pytest.mark.validation
def test_a_crash_and_a_hang_are_seen(reader: Reader, monkeypatch: pytest.MonkeyPatch) -> None:
    """The net itself: a worker that dies is a crash, one that does not answer in time a hang."""
    worker = Reader()
    process = worker._start()
    process.kill()
    process.wait()
    assert worker.read("material", b"")[0] == "crash"
    monkeypatch.setattr("tests.mutants.pool.LONGEST", 0.0)
    slow = Reader()
    assert slow.read("solid case", _seed("solid case"))[0] == "hang"
