# SPDX-License-Identifier: Apache-2.0
"""What heat costs in an increment of hot upsetting: its share of the CPU time, beside equilibrium, in one run.

Rows: the example hot_upsetting to 10 % on finer and finer meshes, with dies of constant temperature, with dies that
warm up, and with a meshed die.

Run: python -m benchmarks.heat
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from time import process_time

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.implicit.stepping import ImplicitProcedure

DIES = {
    "constant": ["tools.die.heat.warms_up=false"],
    "warms up": [],
    "meshed": ["tools.die.heat.warms_up=false", "tools.die.heat.mesh={size=1,depth=40}"],
}
MESHES = ((14, 22), (28, 44), (56, 88))


@dataclass
class Clock:
    """Seconds spent in a function, and how often it was called."""

    seconds: float = 0.0
    calls: int = 0

    def wrap(self, owner: object, name: str) -> None:
        """Replace owner.name by itself with this clock around it."""
        inner = getattr(owner, name)

        def timed(*args: object, **kwargs: object) -> object:
            started = process_time()
            try:
                return inner(*args, **kwargs)
            finally:
                self.seconds += process_time() - started
                self.calls += 1

        setattr(owner, name, timed)


@dataclass(frozen=True)
class Cost:
    """Of one run."""

    increments: int
    passes: int
    heat: float
    """Part of the time of the increments."""
    seconds: float
    """Per increment."""


def measure(cells: tuple[int, int], die: str) -> Cost:
    """Run the example on one thread and return what its heat costs."""
    path = Path(str(files("presswork.examples") / "hot_upsetting.toml"))
    sets = [f"workpiece.mesh.cells=[{cells[0]},{cells[1]}]", "stages.0.tools.die.stroke=3", "stages.0.duration=0.125"]
    case = Case.from_toml(path, overrides=[*sets, *DIES[die]])
    procedure = ImplicitProcedure(build_model(case), threads=1)
    clock = Clock()
    assert procedure.heat is not None
    for name in ("advance", "begin_increment"):
        clock.wrap(procedure.heat, name)
    started = process_time()
    increments = sum(1 for _ in procedure.advance())
    total = process_time() - started
    return Cost(increments, clock.calls // 2, clock.seconds / total, total / increments)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=2, help="the least share of so many runs counts")
    repeats = parser.parse_args().repeats
    print(f"{'cells':>8} {'die':>10} {'increments':>10} {'ms each':>8} {'heat':>7}")
    for cells in MESHES:
        for die in DIES:
            found = min((measure(cells, die) for _ in range(repeats)), key=lambda cost: cost.heat)
            row = f"{cells[0]}x{cells[1]}", die, found.increments, 1e3 * found.seconds, found.heat
            print("{:>8} {:>10} {:>10} {:8.1f} {:7.1%}".format(*row), flush=True)


if __name__ == "__main__":
    main()
