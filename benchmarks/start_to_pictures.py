# SPDX-License-Identifier: Apache-2.0
"""From case file to pictures: the shipped 15 x 15 4CST upsetting through the command line, start of Python included."""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from importlib.resources import files
from pathlib import Path
from time import perf_counter

ENTRY = [sys.executable, "-c", "from presswork.cli import app; app()"]


def time_command(command: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """Return wall and user seconds of a command that must succeed."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)
    return perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", default="upsetting_4cst", help="name of a shipped example")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--json", type=Path, help="write the figures here")
    arguments = parser.parse_args()
    case = str(files("presswork.examples") / f"{arguments.case}.toml")
    times: dict[str, list[tuple[float, float]]] = {}
    environment = dict(os.environ)
    for _ in range(arguments.repeats + 1):
        with tempfile.TemporaryDirectory() as folder:
            run = [*ENTRY, "run", case, "--quiet", "--threads", str(arguments.threads), "--output"]
            commands = {
                "start only (presswork --version)": [*ENTRY, "--version"],
                "check the case": [*ENTRY, "check", case],
                "run without pictures": [*run, f"{folder}/a", "--no-plot"],
                "run with pictures": [*run, f"{folder}/b"],
            }
            for label, command in commands.items():
                times.setdefault(label, []).append(time_command(command, environment))
            pictures = len(list(Path(folder, "b").rglob("*.png")))
            summary = json.loads(Path(folder, "b", "summary.json").read_text())
    print(f"{arguments.case}, median of {arguments.repeats} after one to warm the disk; {pictures} pictures")
    print(f"{'':36s}{'wall s':>8s}{'from':>8s}{'to':>8s}{'user s':>8s}")
    for label, runs in times.items():
        wall, user = [w for w, _ in runs[1:]], [u for _, u in runs[1:]]
        middle = statistics.median(wall)
        print(f"{label:36s}{middle:8.2f}{min(wall):8.2f}{max(wall):8.2f}{statistics.median(user):8.2f}")
    print("summary.json of the last run:", {k: round(v, 2) for k, v in summary["wall_seconds"].items()})
    if arguments.json:
        arguments.json.write_text(json.dumps({"times": times, "wall_seconds": summary["wall_seconds"]}, indent=1))


if __name__ == "__main__":
    main()
