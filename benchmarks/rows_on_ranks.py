# SPDX-License-Identifier: Apache-2.0
"""What a row of the history costs a stamping on ranks: bytes that a rank receives, and its CPU time, by part.

    mpiexec -n 2 python -m benchmarks.rows_on_ranks --size 0.5

CPU time counts that of waiting for others, too; bytes do not depend on the machine.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time

from presswork.observe.memory.of_model import list_memories
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.ranks.world import World, find_world
from tests.problems.divided_loops import read
from tests.problems.square_cup import describe_cup


def measure(world: World, work: Callable[[], object], *, by_lead: bool) -> str:
    """Return what work costs this rank, done by all ranks, or by rank 0 while the others help it."""
    received, started = world.traffic.received, process_time()
    if not by_lead:
        work()
    elif world.rank == 0:
        with world.leading():
            work()
    else:
        world.follow()
    return f"{1e3 * (process_time() - started):.1f} ms {(world.traffic.received - received) / 1e3:.1f} kB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=float, default=0.5, help="size of the shells of a quarter of a cup [mm]")
    size = parser.parse_args().size
    world = find_world()
    assert world is not None, "start it by mpiexec"
    run = ExplicitStamping(read(describe_cup(size).replace("rows = 10", "rows = 400")), threads=1, world=world)
    on, memories = run.advance(), list_memories(run.model)
    next(on)
    cycles = measure(world, lambda: next(on), by_lead=False)
    report = next(on)

    def record() -> None:
        memories.look(run, run.row(report))

    row = measure(world, record, by_lead=True)
    checkpoint = measure(world, run.to_arrays, by_lead=True)
    next(on)
    to_all = measure(world, run.shells.dump, by_lead=False)
    told = f"{report.cycles} cycles {cycles}, row {row}, checkpoint {checkpoint}, whole state to all ranks {to_all}"
    for rank, line in enumerate(world.gather_objects(told)):
        if world.rank == 0:
            print(f"rank {rank} of {len(run.shells.connectivity)} shells: {line}")


if __name__ == "__main__":
    main()
