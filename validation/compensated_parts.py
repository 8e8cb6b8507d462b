# SPDX-License-Identifier: Apache-2.0
"""Dies of stamped parts drawn at random, corrected for springback: how many come right, in how many loops.

A part has come right when no place is farther off its shape than 0.2 mm or a tenth of its springback, whichever is
larger. Hats (seeds 0, 8, 16, ...) are slices and take seconds a loop; rails take minutes.

Run: python -m validation.compensated_parts [SEED ...] [--kind hat] [--count 3] [--loops 5] [--folder runs]
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from presswork.case import CaseError
from presswork.study import Compensation, compensate_springback
from validation.stamped_cases import write_case
from validation.stamped_parts import KINDS, draw_part

TOLERANCE, SHARE = 0.2, 0.1
"""Largest deviation of a part that has come right [mm], and as a part of its springback."""


@dataclass(frozen=True)
class Outcome:
    """What became of one part's tools."""

    seed: int
    deviations: tuple[float, ...]
    """Largest of each loop [mm]; the first is the springback of the tools as drawn."""
    allowed: float
    seconds: float
    reason: str
    was_stopped: bool = False
    """By Ctrl-C or SIGTERM."""

    @property
    def is_right(self) -> bool:
        """Whether the best part is within what is allowed."""
        return bool(self.deviations) and min(self.deviations) <= self.allowed

    def line(self) -> str:
        """Return a row of the table."""
        part = draw_part(self.seed)
        way = "drawn" if part.is_drawn else "crash formed"
        said = ", ".join(f"{each:.2f}" for each in self.deviations)
        result = "right" if self.is_right else self.reason or "not right"
        return (
            f"| {self.seed} | {part.kind} | {part.material} {part.thickness:.2f} | {way} | {said} | "
            f"{self.allowed:.2f} | {result} | {self.seconds:.0f} |"
        )


def correct(seed: int, folder: Path, loops: int = 5) -> Outcome:
    """Form a part, and correct its tools until it comes right."""
    case = write_case(draw_part(seed), folder)
    out = folder / "loops"
    try:
        found = compensate_springback(case, out, tolerance=TOLERANCE, most=0, threads=1, overwrite=True)
        if not found.loops:
            return Outcome(seed, (), TOLERANCE, 0.0, found.reason, found.status == "interrupted")
        allowed = max(TOLERANCE, SHARE * found.loops[0].worst)
        if found.status != "interrupted" and found.loops[0].worst > allowed:
            found = compensate_springback(case, out, tolerance=allowed, most=loops, threads=1, resume=True)
    except CaseError as error:
        return Outcome(seed, (), TOLERANCE, 0.0, str(error))
    return _read(seed, found, allowed)


def _read(seed: int, found: Compensation, allowed: float) -> Outcome:
    seconds = sum(loop.seconds for loop in found.loops)
    deviations = tuple(loop.worst for loop in found.loops)
    return Outcome(seed, deviations, allowed, seconds, found.reason, found.status == "interrupted")


def main() -> None:
    """Correct the tools of some parts and print a row for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seeds", type=int, nargs="*")
    parser.add_argument("--kind", choices=KINDS, default="hat")
    parser.add_argument("--count", type=int, default=3)
    parser.add_argument("--loops", type=int, default=5)
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    seeds = arguments.seeds or [KINDS.index(arguments.kind) + len(KINDS) * k for k in range(arguments.count)]
    print("| seed | part | sheet | made | largest deviation by loops [mm] | allowed | result | s |")
    print("|--:|---|---|---|---|--:|---|--:|", flush=True)
    n_right = 0
    with TemporaryDirectory() as temporary:
        for seed in seeds:
            found = correct(seed, (arguments.folder or Path(temporary)) / f"part_{seed}", arguments.loops)
            if found.was_stopped:
                sys.exit(f"stopped in seed {seed}: {found.reason}")
            n_right += found.is_right
            print(found.line(), flush=True)
    print(f"{n_right} of {len(seeds)} came right")


if __name__ == "__main__":
    main()
