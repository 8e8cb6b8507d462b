# SPDX-License-Identifier: Apache-2.0
"""Processor time that the compiler takes for each of the longest files of the core, by level of optimisation.

    python -m benchmarks.build [FILE ...]

Files are named from cpp/; each is compiled alone for this machine's architecture.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

CPP = Path(__file__).parents[1] / "cpp"
FLAGS = ["-DNDEBUG", "-std=gnu++20", "-fPIC", "-fno-math-errno", "-fno-trapping-math", "-Wno-psabi", "-march=native"]
LEVELS = {"-O3": ["-O3"], "-O2 -fpeel-loops": ["-O2", "-fpeel-loops"], "-O1": ["-O1"]}
FILES = [
    "element/evaluate_shells.cpp",
    "element/evaluate_block.cpp",
    "material/elastic_plastic_6.cpp",
    "material/elastic_plastic_4.cpp",
    "material/elastic_plastic_3.cpp",
    "device/host.cpp",
    "explicit/space/one_point_shells.cpp",
]


def compile_alone(file: str, options: list[str]) -> float:
    """Return the seconds of processor time that g++ takes for a file of cpp/."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        command = ["g++", *FLAGS, "-fopenmp", f"-I{CPP}", *options, "-c", CPP / file, "-o", Path(folder) / "object.o"]
        subprocess.run(command, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    print("| file | " + " | ".join(LEVELS) + " |\n|---|" + "--:|" * len(LEVELS))
    for file in sys.argv[1:] or FILES:
        print(f"| `{file}` | " + " | ".join(f"{compile_alone(file, each):.0f}" for each in LEVELS.values()) + " |")


if __name__ == "__main__":
    main()
