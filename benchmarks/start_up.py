# SPDX-License-Identifier: Apache-2.0
"""From case file to pictures: the shipped 15 x 15 4CST upsetting through the command line, start of Python included.

Times are processor seconds, user and system, the least of all rounds, beside those of `python -c "import numpy"` in the
same rounds: such a ratio holds on a machine with other work, where wall time does not. The exit status is 1 if a
target is missed.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from importlib.resources import files
from pathlib import Path
from time import perf_counter

ENTRY = [sys.executable, "-c", "from presswork.cli import main; main()"]
NUMPY, START, CHECK = 'python -c "import numpy"', "presswork --version", "presswork check"
COMPUTE, PAGE = "presswork run --no-plot --no-report", "presswork run --no-plot, with its page"
RUN = "presswork run, with pictures and page"
TARGETS = {START: 1.5, CHECK: 4.0, RUN: 18.0}
"""Processor time over that of importing numpy, at most; the last is 2 s where numpy takes 0.11 s."""


def time_command(command: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """Return wall and processor seconds of a command that must succeed."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)
    wall, after = perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", default="upsetting_4cst", help="name of a shipped example")
    parser.add_argument("--repeats", type=int, default=10)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--json", type=Path, help="write the figures here")
    arguments = parser.parse_args()
    case = str(files("presswork.examples") / f"{arguments.case}.toml")
    times: dict[str, list[tuple[float, float]]] = {}
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    with tempfile.TemporaryDirectory() as bytecode:  # compiled once, as it is where presswork is installed
        environment["PYTHONPYCACHEPREFIX"] = bytecode
        for _ in range(arguments.repeats + 1):
            with tempfile.TemporaryDirectory() as folder:
                run = [*ENTRY, "run", case, "--quiet", "--threads", str(arguments.threads), "--output"]
                commands = {
                    NUMPY: [sys.executable, "-c", "import numpy"],
                    START: [*ENTRY, "--version"],
                    CHECK: [*ENTRY, "check", case],
                    COMPUTE: [*run, f"{folder}/a", "--no-plot", "--no-report"],
                    PAGE: [*run, f"{folder}/c", "--no-plot"],
                    RUN: [*run, f"{folder}/b"],
                }
                for label, command in commands.items():
                    times.setdefault(label, []).append(time_command(command, environment))
                pictures = len(list(Path(folder, "b").rglob("*.png")))
                summary = json.loads(Path(folder, "b", "summary.json").read_text())
    print(f"{arguments.case}, least of {arguments.repeats} after one to warm the disk; {pictures} pictures")
    print(f"{'':44s}{'wall s':>8s}{'CPU s':>8s}{'over numpy':>12s}{'target':>8s}")
    missed = []
    unit = min(cpu for _, cpu in times[NUMPY][1:])
    for label, runs in times.items():
        wall, cpu = (min(values) for values in zip(*runs[1:], strict=True))
        target = f"{TARGETS[label]:8.1f}" if label in TARGETS else ""
        print(f"{label:44s}{wall:8.2f}{cpu:8.2f}{cpu / unit:12.2f}{target}")
        if label in TARGETS and cpu > TARGETS[label] * unit:
            missed.append(label)
    print("summary.json of the last run:", {k: round(v, 2) for k, v in summary["wall_seconds"].items()})
    if arguments.json:
        arguments.json.write_text(json.dumps({"times": times, "wall_seconds": summary["wall_seconds"]}, indent=1))
    if missed:
        print("missed:", ", ".join(missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
