# SPDX-License-Identifier: Apache-2.0
"""The keywords of a deck, whose errors are those of a case."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from presswork.case.errors import CaseError, Problem
from presswork.keyword_file import KeywordFileError


@contextmanager
def explain_unreadable() -> Iterator[None]:
    """Raise CaseError where a file of keywords cannot be read."""
    try:
        yield
    except KeywordFileError as error:
        raise CaseError([Problem(error.key, error.fault, error.remedy)], error.path) from error
