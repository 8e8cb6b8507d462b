# SPDX-License-Identifier: Apache-2.0
"""Tests of explicit shells and solids in space pass where the code for cards computes their cycles.

By its host build, and where there is an NVIDIA card by that, on which the tests of devices compare with the CPU's loop.

    python -m pytest -n 0 -s -m validation validation/test_explicit_on_device.py [-k host | -k cuda]

says how many cycles that are.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from presswork import _core

pytestmark = pytest.mark.validation

ROOT = Path(__file__).parents[1]
TESTS = {
    "consistency": ("explicit_shells", "explicit_cup", "explicit_edges", "prescribed_temperature", "mixed_dynamics"),
    "verification": (
        *("explicit_patch", "explicit_stretching", "explicit_contact", "explicit_dynamics", "explicit_precision"),
        *("drawbeads", "squeezed_sheet", "damage", "reactions", "transfer", "presses"),
        *("explicit_in_space", "explicit_tools_in_space", "explicit_bodies_in_space", "heat_of_space_rows"),
    ),
    "regression": (
        "stamping_runs",
        "drawbead_runs",
        "forming_path_runs",
        "hot_stamping",
        "interruptions",
        "remeshed_space_impact",
    ),
}
"""Of files `tests/KIND/test_NAME.py`."""
BY_THE_LOOP = {
    "test_the_clock_of_phases_adds_up": "a device tells the time of a call, not of its phases",
    "test_blocks_that_do_not_touch_move_as_each_does_alone": "bits of shells beside solids, of the loop",
    "does_not_fit": "its limit is of the host build's memory",
    "explicit3-time_step": "the step of the mesh is found by the loop",
    "same_bits and (tet4_nodal or hex8_1pt)": "work is summed a call at a time: its last bits know where a run was cut",
}
"""Tests whose claim is one of the CPU's loop, and why."""
UNTIMED = ("-o", "faulthandler_timeout=0")
"""The host build takes a shell at a time: a test may take longer than is allowed in tests/."""


DEVICES = ["host", pytest.param("cuda", marks=pytest.mark.skipif(not _core.list_cuda_cards()[0], reason="no card"))]


def run_tests(device: str, files: list[str]) -> None:
    """Run test files on a device."""
    skipped = " and ".join(f"not ({name})" for name in BY_THE_LOOP)
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "validation.on_device", "--on-device", device]
    done = subprocess.run(
        [*command, *UNTIMED, "-k", skipped, *files], cwd=ROOT, capture_output=True, text=True, timeout=3000
    )
    told = re.search(r"cycles: (\d+) on the device.*", done.stdout)
    print(done.stdout[-1500:])
    assert done.returncode == 0, done.stdout[-8000:]
    assert told is not None
    assert int(told[1]) > 10_000


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", TESTS)
def test_explicit_tests_pass_on_a_device(kind: str, device: str) -> None:
    run_tests(device, [f"tests/{kind}/test_{name}.py" for name in TESTS[kind]])


@pytest.mark.parametrize("device", DEVICES[1:])
def test_tests_of_devices_pass_on_a_card(device: str) -> None:
    """In place of the host build, beside the CPU's loop; those of refusals, too."""
    run_tests(device, sorted(str(file.relative_to(ROOT)) for file in ROOT.glob("tests/*/test_device*.py")))
