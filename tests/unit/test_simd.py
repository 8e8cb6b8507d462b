# SPDX-License-Identifier: Apache-2.0
"""Which build of the compiled module is loaded on which CPU."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from presswork import _core, _cpu
from presswork.simd import choose

CPUINFO = Path("/proc/cpuinfo")
FLAGS = {
    2: {"sse4_2", "popcnt", "cx16", "ssse3"},
    3: {"avx", "avx2", "bmi1", "bmi2", "fma", "f16c", "movbe"},
    4: {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}
"""What the System V ABI asks of each level beside those below it (a selection), by the kernel's names."""


@pytest.mark.parametrize(("level", "expected"), [(2, 2), (3, 3), (4, 4), (5, 4)])
def test_the_highest_build_that_the_cpu_has_is_taken(level: int, expected: int) -> None:
    assert choose((2, 3, 4), level) == expected


def test_a_build_can_be_forced() -> None:
    assert choose((2, 3, 4), 4, "x86-64-v2") == 2
    assert choose((2, 4), 3) == 2


@pytest.mark.parametrize(
    ("available", "level", "wanted", "message"),
    [
        ((2, 3, 4), 3, "x86-64-v4", "PRESSWORK_SIMD=x86-64-v4: this CPU has x86-64-v3 at most"),
        ((2, 3, 4), 4, "avx2", "PRESSWORK_SIMD=avx2: this build of presswork has x86-64-v2, x86-64-v3, x86-64-v4"),
        ((), 4, "x86-64-v3", "this build of presswork has one for one CPU"),
        ((2, 3, 4), 1, None, "this CPU has x86-64-v1, presswork needs x86-64-v2"),
    ],
)
def test_what_cannot_be_loaded_is_said(available: tuple[int, ...], level: int, wanted: str, message: str) -> None:
    with pytest.raises(ImportError, match=message):
        choose(available, level, wanted)


@pytest.mark.skipif(not CPUINFO.exists() or _cpu.level() == 0, reason="the kernel's own list is needed")
def test_the_level_is_that_of_the_kernels_list_of_flags() -> None:
    line = next(line for line in CPUINFO.read_text().splitlines() if line.startswith("flags"))
    flags, level = set(line.split()), 1
    while level < 4 and flags >= FLAGS[level + 1]:
        level += 1
    assert _cpu.level() == level


@pytest.mark.skipif(_core.architecture.startswith("x86-64-v"), reason="for a build for one machine")
def test_a_build_for_one_machine_cannot_be_forced() -> None:
    environment = os.environ | {"PRESSWORK_SIMD": "x86-64-v3"}
    command = [sys.executable, "-c", "from presswork import _core"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 1
    assert "ImportError: PRESSWORK_SIMD=x86-64-v3: this build of presswork has one for one CPU" in done.stderr
