# SPDX-License-Identifier: Apache-2.0
"""The portable build: every variant that this CPU has can be forced, and a dump passes from one to another."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from presswork import _cpu

pytestmark = pytest.mark.validation

ROOT = Path(__file__).parents[1]
LEVELS = range(2, _cpu.level() + 1)
SCRIPT = """
import sys
# an editable install would come before PYTHONPATH
sys.meta_path[:] = [finder for finder in sys.meta_path if not type(finder).__name__.startswith("ScikitBuild")]
import numpy as np
from presswork import _core
from tests.consistency.test_explicit_shells import make_run
precision, source, target = sys.argv[1:]
run = make_run(precision)
if source:
    run.restore(dict(np.load(source)))
run.advance(200)
np.savez(target, **run.dump())
print(_core.architecture, _core.pack_width, end="")
"""
WIDTHS = {2: 2, 3: 4, 4: 8}


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package built as for a wheel, installed in a folder of its own."""
    folder = tmp_path_factory.mktemp("portable")
    build = ["--no-build-isolation", "--no-deps", "--target", folder / "site", f"-Cbuild-dir={folder / 'build'}"]
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "-q", *build, "-Ccmake.define.PRESSWORK_ARCH=portable", ROOT],
        check=True,
    )
    return folder / "site"


def advance(package: Path, level: int | None, precision: str, source: Path | str, target: Path) -> str:
    """Advance 200 cycles by the variant of this level, from a dump if one is given; what it says of itself."""
    environment = os.environ | {"PYTHONPATH": str(package), "OMP_NUM_THREADS": "1"}
    if level is not None:
        environment["PRESSWORK_SIMD"] = f"x86-64-v{level}"
    command = [sys.executable, "-c", SCRIPT, precision, str(source), str(target)]
    return subprocess.run(command, cwd=ROOT, env=environment, check=True, capture_output=True, text=True).stdout


def test_the_best_variant_is_taken_and_each_can_be_forced(package: Path, tmp_path: Path) -> None:
    best = max(LEVELS)
    assert advance(package, None, "double", "", tmp_path / "free.npz") == f"x86-64-v{best} {WIDTHS[best]}"
    for level in LEVELS:
        said = advance(package, level, "double", "", tmp_path / "forced.npz")
        assert said == f"x86-64-v{level} {WIDTHS[level]}"


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_dump_of_one_variant_goes_on_in_another(package: Path, tmp_path: Path, precision: str) -> None:
    """The state is kept by elements, whatever the width of packs; what follows differs by rounding alone."""
    tolerance = {"double": 1e-9, "single": 1e-5}[precision]
    first = tmp_path / "first.npz"
    advance(package, max(LEVELS), precision, "", first)
    ends = {}
    for level in LEVELS:
        advance(package, level, precision, first, tmp_path / f"{level}.npz")
        ends[level] = np.load(tmp_path / f"{level}.npz")
    expected = ends[max(LEVELS)]
    for end in ends.values():
        assert end["run.clock"][0] == 400
        np.testing.assert_allclose(end["nodes.position"], expected["nodes.position"], atol=tolerance)
        for name in ("shells.layers.0", "shells.shell.0", "shells.layers.1", "shells.shell.1"):
            largest = np.abs(expected[name]).reshape(-1, expected[name].shape[-1]).max(axis=0)
            scale = np.maximum(largest, 1e-3)  # what rounding took has no digit in common
            np.testing.assert_allclose(end[name] / scale, expected[name] / scale, atol=100 * tolerance)
