# SPDX-License-Identifier: Apache-2.0
"""What heat costs a stamping: runs of the example hot_stamping_hat with and without heat, in turn, in one process.

The cold run forms the same hat between the same tools, without [heat] and the dwells before and after: its sheet
hardens alone (`hardens`), or has the hot sheet's rate and softening at a constant temperature too (`same law`). CPU
time of one thread; a ratio is that of two runs in one turn: its median, least and largest of all turns.

Run: python -m benchmarks.hot_stamping [implicit]
"""

from __future__ import annotations

import argparse
import statistics
from importlib.resources import files
from pathlib import Path
from time import process_time

from presswork.case import build_model
from presswork.case.reader import read_toml
from presswork.case.stamping.schema import StampingCase
from presswork.model import Model
from presswork.process.begin import begin

EXAMPLE = Path(str(files("presswork.examples") / "hot_stamping_hat.toml"))
KINDS = ("hardens", "same law", "hot")


def build(kind: str, procedure: str, size: float, stroke: float) -> Model:
    """Return the model of one kind, with shells of `size` [mm] along the profile, formed to `stroke` [mm]."""
    given, _ = read_toml(EXAMPLE)
    given["procedure"] = procedure
    given["blank"]["element_size"] = [size, 2 * size]
    form = next(stage for stage in given["stages"] if stage["name"] == "form")
    form["tools"]["punch"]["stroke"] = stroke
    for tool in given["tools"].values():
        tool["path"] = str(EXAMPLE.with_name(tool["path"]))
    if kind != "hot":
        given["stages"] = [form]
        steel = given["materials"]["22MnB5"]
        del given["heat"], steel["thermal"], steel["transformation"]
        for tool in given["tools"].values():
            tool.pop("heat", None)
    if kind == "hardens":
        del steel["rate"], steel["heating"], form["process_time"]
    if kind == "same law":
        steel["heating"]["start"] = 800
    return build_model(StampingCase.model_validate(given))


def measure(kind: str, procedure: str, size: float, stroke: float) -> float:
    """Return the CPU time of a run on one thread [s], without that of building the model."""
    model = build(kind, procedure, size, stroke)
    started = process_time()
    for _ in begin(model, 1).advance():
        pass
    return process_time() - started


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("procedure", choices=("explicit", "implicit"), nargs="?", default="explicit")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--size", type=float, default=1.0, help="of the shells along the profile [mm]")
    parser.add_argument("--stroke", type=float, default=29.95, help="[mm]")
    given = parser.parse_args()
    turns = [
        {kind: measure(kind, given.procedure, given.size, given.stroke) for kind in KINDS} for _ in range(given.turns)
    ]
    print(f"{'run':>9} {'CPU [s]':>8} {'hot/run':>8} {'least':>6} {'most':>6}")
    for kind in KINDS:
        ratios = [turn["hot"] / turn[kind] for turn in turns]
        row = kind, statistics.median(turn[kind] for turn in turns), statistics.median(ratios), min(ratios), max(ratios)
        print("{:>9} {:8.2f} {:8.2f} {:6.2f} {:6.2f}".format(*row))


if __name__ == "__main__":
    main()
