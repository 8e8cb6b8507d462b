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


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
def test_the_benchmark_of_devices_runs_with_the_host_build(
    element: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every row has a speed, and what crosses the bus does not grow with the sheet."""
    command = ["explicit_device", "--device", "host", "--sizes", "4", "8", "--repeats", "1", "--element", element]
    monkeypatch.setattr("sys.argv", command)
    runpy.run_module("benchmarks.explicit_device", run_name="__main__")
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    assert len(rows) == (8 if element == "shell4_1pt" else 4)
    assert all(float(row[3]) > 0 for row in rows)
    assert all(int(row[-1]) < 300 for row in rows)
