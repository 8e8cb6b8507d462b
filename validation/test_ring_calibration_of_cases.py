# SPDX-License-Identifier: Apache-2.0
"""`presswork calibrate ring` finds the friction of rings that do not bulge (Avitzur), and of runs of its own."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.study import calibrate_ring, integrate_ring, measure_ring

pytestmark = pytest.mark.validation

COMMAND = [sys.executable, "-c", "from presswork.cli import app; app()"]


@pytest.fixture(scope="module")
def case_file(tmp_path_factory) -> Path:
    return copy_example("ring_compression", tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def curves(case_file, tmp_path_factory) -> Path:
    """The folder of calibration curves at the default friction values, for others to resume."""
    folder = tmp_path_factory.mktemp("calibration")
    measured = folder / "one.csv"
    measured.write_text("height_reduction,bore_ratio\n0.5,1.0\n")
    arguments = ["calibrate", "ring", measured, "--case", case_file, "--output", folder / "out", "--quiet"]
    done = subprocess.run([*COMMAND, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "no interval" in done.stdout
    saved = json.loads((folder / "out/calibration.json").read_text())
    assert done.stdout.startswith(f"m = {saved['m']:.4f}; 1 point\n")
    assert (folder / "out/calibration.png").read_bytes().startswith(b"\x89PNG")
    return folder / "out"


def calibrate(case_file: Path, curves: Path, reductions: np.ndarray, bores: np.ndarray, **options):
    measured = curves.parent / "measured.csv"
    lines = [f"{100 * r},{18 * b}" for r, b in zip(reductions, bores, strict=True)]
    measured.write_text("\n".join(["height_reduction_percent,bore_diameter_mm", *lines]) + "\n")
    calibration = calibrate_ring(measured, case_file, curves, resume=True, **options)
    assert calibration is not None
    return calibration.fit.friction, calibration.fit.interval


@pytest.mark.parametrize(
    ("m", "bore", "band"), [(0.05, "mean", 0.003), (0.1, "mean", 0.006), (0.1, "mid", 0.006), (0.2, "mean", 0.01)]
)
def test_calibrate_identifies_the_friction_of_avitzurs_ring(case_file, curves, m, bore, band):
    """Points that the solver has no part in: a rigid ring that does not bulge."""
    reductions = np.linspace(0.1, 0.5, 9)
    found, _ = calibrate(case_file, curves, reductions, integrate_ring(m, reductions)[0], bore=bore)
    assert found == pytest.approx(m, abs=band)


@pytest.mark.parametrize("m", [0.12, 0.35])
def test_calibrate_recovers_the_friction_of_a_run_between_its_curves(case_file, curves, tmp_path, m):
    outcome = run(Case.from_toml(case_file, [f"tools.punch.m={m}"]), tmp_path / "run", threads=1)
    ring = measure_ring(outcome.result)
    at = slice(4, None, 2)
    found, (low, high) = calibrate(case_file, curves, ring.height_reduction[at], ring.bore_mean[at])
    assert found == pytest.approx(m, abs=3e-3)
    assert low < found < high
