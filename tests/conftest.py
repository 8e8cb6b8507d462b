# SPDX-License-Identifier: Apache-2.0
"""What all tests share: no waits for the disk, and compiled material laws."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from presswork.law.umat import compile_law

SOURCES = Path(__file__).parent / "data" / "umat"


@pytest.fixture(autouse=True, scope="session")
def _own_list_of_libraries(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Laws that tests compile are allowed in tests alone, not to the user who runs them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(autouse=True, scope="session")
def _no_wait_for_the_disk() -> Iterator[None]:
    """No power fails in tests; whole files are written in the same order."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)
        yield


@pytest.fixture(scope="session")
def umat_laws(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of data/umat/laws.cpp."""
    return compile_law(SOURCES / "laws.cpp", tmp_path_factory.mktemp("umat") / "laws.so")


@pytest.fixture(scope="session")
def umat_sheet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of data/umat/sheet_mises.cpp."""
    return compile_law(SOURCES / "sheet_mises.cpp", tmp_path_factory.mktemp("umat") / "sheet_mises.so")


@pytest.fixture(scope="session")
def umat_norton(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first C++ block of docs/adding_a_law.md, compiled: Norton's creep, by E, nu, A, n."""
    page = (Path(__file__).parents[1] / "docs" / "adding_a_law.md").read_text(encoding="utf-8")
    block = re.search(r"```cpp\n(.*?)```", page, re.DOTALL)
    assert block is not None
    source = tmp_path_factory.mktemp("umat") / "norton.cpp"
    source.write_text(block.group(1))
    return compile_law(source)


@pytest.fixture(scope="session")
def umat_fortran(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of data/umat/mises_linear.f."""
    if shutil.which("gfortran") is None:
        pytest.skip("gfortran is not installed: the Fortran UMAT is not compiled; umat_laws tests the same interface")
    return compile_law(SOURCES / "mises_linear.f", tmp_path_factory.mktemp("umat") / "mises_linear.so")
