# SPDX-License-Identifier: Apache-2.0
"""Programs beside the package go along with its names."""

import runpy
import subprocess
from pathlib import Path

import pytest

from benchmarks.machine import find_compiler

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_an_example_finds_all_that_it_imports(path: Path) -> None:
    assert "main" in runpy.run_path(str(path), run_name="example")


KERNELS = sorted((Path(__file__).parents[2] / "benchmarks").glob("*.cpp"))


@pytest.mark.skipif(find_compiler() is None, reason="needs a C++ compiler")
@pytest.mark.parametrize("path", KERNELS, ids=lambda p: p.stem)
def test_a_benchmark_of_kernels_compiles(path: Path) -> None:
    command = [find_compiler() or "", "-std=c++20", "-march=native", "-Wno-psabi", f"-I{path.parents[1] / 'cpp'}"]
    checked = subprocess.run([*command, "-fopenmp", "-fsyntax-only", str(path)], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stderr
