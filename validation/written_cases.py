# SPDX-License-Identifier: Apache-2.0
"""Stamped parts drawn at random, laid flat by one step, and the stampings that it writes of them: accepted, and run.

Run: python -m validation.written_cases [SEED ...] [--first 0] [--count 40] [--run] [--cells 2000] [--folder runs]

Without --run the written cases are checked alone, by the same rules as `presswork check`.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from presswork.api import find_blank, load, run
from presswork.case import CaseError
from presswork.model import Model, OneStepModel
from presswork.results import Result
from validation.stamped_cases import write_onestep
from validation.stamped_parts import draw_part


@dataclass(frozen=True)
class Outcome:
    """What became of one part."""

    seed: int
    result: str
    """"completed", "accepted" where nothing was run, or why not."""
    shells: int
    thinning: tuple[float, float]
    """Largest by one step and by the stamping [per cent]; nan: not computed."""
    seconds: tuple[float, float]
    """Of one step and its check, and of the run."""

    def line(self) -> str:
        """Return a row of the table."""
        part = draw_part(self.seed)
        one, other = (f"{each:.1f}" if each == each else "" for each in self.thinning)
        return (
            f"| {self.seed} | {part.kind} | {part.material} {part.thickness:.2f} | {self.shells} | {self.result} "
            f"| {one} | {other} | {self.seconds[0]:.0f} | {self.seconds[1]:.0f} |"
        )


def try_part(seed: int, folder: Path, cells: int, *, runs: bool) -> Outcome:
    """Lay a part flat, write its stamping, and run it."""
    start = perf_counter()
    part = draw_part(seed)
    path, nan = folder / "stamping.toml", float("nan")
    try:
        model = load(write_onestep(part, folder))
    except CaseError as error:
        return Outcome(seed, f"one step refused: {error}", 0, (nan, nan), (perf_counter() - start, 0.0))
    assert isinstance(model, OneStepModel)
    blank = find_blank(model, folder / "one", overwrite=True, threads=1, write_case=path, cells=cells)
    if blank.status != "completed":
        return Outcome(seed, f"one step: {blank.reason}", 0, (nan, nan), (perf_counter() - start, 0.0))
    thinning = _largest_thinning(folder / "one", part.thickness)
    try:
        stamping = load(path)
    except CaseError as error:
        return Outcome(seed, f"refused: {error}", 0, (thinning, nan), (perf_counter() - start, 0.0))
    assert isinstance(stamping, Model)
    shells, middle = len(stamping.mesh.blocks[0].connectivity), perf_counter()
    if not runs:
        return Outcome(seed, "accepted", shells, (thinning, nan), (middle - start, 0.0))
    done = run(stamping, folder / "run", threads=1, overwrite=True)
    reason = done.status if done.status == "completed" else f"{done.status}: {done.reason}"
    found = (thinning, _largest_thinning(folder / "run", part.thickness))
    return Outcome(seed, reason, shells, found, (middle - start, perf_counter() - middle))


def _largest_thinning(folder: Path, thickness: float) -> float:
    """Return the largest thinning of a folder's last step [per cent]."""
    return float(100.0 * (1.0 - Result(folder).field("thickness").min() / thickness))


def main() -> None:
    """Try some parts and print a row for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seeds", type=int, nargs="*")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--cells", type=int, default=2000)
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    seeds = arguments.seeds or range(arguments.first, arguments.first + arguments.count)
    print("| seed | part | sheet | shells | result | thinning, one step | stamping [%] | s | s of run |", flush=True)
    print("|--:|---|---|--:|---|--:|--:|--:|--:|", flush=True)
    good = 0
    with TemporaryDirectory() as temporary:
        for seed in seeds:
            folder = (arguments.folder or Path(temporary)) / f"part_{seed}"
            found = try_part(seed, folder, arguments.cells, runs=arguments.run)
            good += found.result in ("accepted", "completed")
            print(found.line(), flush=True)
    print(f"{good} of {len(list(seeds))}")


if __name__ == "__main__":
    main()
