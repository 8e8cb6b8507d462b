# SPDX-License-Identifier: Apache-2.0
"""60 stampings on a scheduler and three workers, of which one is killed, one cut off and set free again, while one
member never ends; and the same in processes of this machine.

`python -m validation.cluster_sweep` prints how the members ended.
"""

from __future__ import annotations

import csv
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from presswork.examples import copy_example
from presswork.study.sweep import SweepProgress, SweepResult, run_members
from presswork.study.vary import Member, make_members
from tests.problems.dask_cluster import DaskCluster, dask_cluster

COUNT, ENDLESS = 60, 7
TIMEOUT = 90.0
"""Seconds: many times what a member takes, and far less than the endless one would."""
WORKER_TTL = "15s"
SMALL = ["blank.element_size=[4,17.5]", "stages.0.tools.punch.stroke=2", "output.rows=10", "output.steps=1"]
FINE = "blank.element_size=[0.1,0.5]"
OF_THE_CLOCK = {"wall_seconds"}


def make_stampings(folder: Path) -> list[Member]:
    """Make draws of a strip with 60 frictions; one of them has so many shells that it never ends."""
    friction = [round(0.02 + 0.004 * i, 4) for i in range(COUNT)]
    combinations = [
        ({"tools.punch.mu": mu}, [f"tools.punch.mu={mu}", *([FINE] if i == ENDLESS else [])])
        for i, mu in enumerate(friction)
    ]
    return make_members(copy_example("draw_bending", folder), combinations, SMALL)


def disturb(cluster: DaskCluster) -> Callable[[SweepProgress], None]:
    """Start three workers, and return what kills one, and cuts another off for a while, as the sweep moves on."""
    workers = [cluster.add_worker() for _ in range(3)]
    blows = [
        (10, lambda: workers[0].kill()),
        (20, lambda: workers[1].send_signal(signal.SIGSTOP)),
        (45, lambda: workers[1].send_signal(signal.SIGCONT)),
    ]

    def watch(progress: SweepProgress) -> None:
        if blows and progress.counts["completed"] >= blows[0][0] and progress.counts["running"]:
            blows.pop(0)[1]()

    return watch


def read_rows(folder: Path) -> list[dict[str, str]]:
    """The table, of the endless member only how it ended, of all others all but the time they took.

    On a busy machine the endless member may not stop by itself in time, so whether it left a checkpoint is left out.
    """
    with open(folder / "table.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    kept = {"member", "tools.punch.mu", "status", "reason"}
    return [
        {k: v.split("; --resume")[0] for k, v in row.items() if (k in kept if i == ENDLESS else k not in OF_THE_CLOCK)}
        for i, row in enumerate(rows)
    ]


def run_both(folder: Path) -> tuple[SweepResult, SweepResult]:
    """Run the family in processes, then on the cluster."""
    members = make_stampings(folder)
    (folder / "dask").mkdir()
    alone = run_members(members, folder / "processes", member_timeout=TIMEOUT)
    with dask_cluster(folder / "dask", DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL=WORKER_TTL) as cluster:
        watch = disturb(cluster)
        swept = run_members(
            members, folder / "cluster", cluster=cluster.address, member_timeout=TIMEOUT, on_progress=watch
        )
    return alone, swept


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        alone, swept = run_both(Path(folder))
        print(f"{time.perf_counter() - start:.0f} s")
        for name, result in (("processes", alone), ("cluster", swept)):
            print(name, dict(result.counts))
            for member in result.members:
                if member.status != "completed":
                    print(f"  {member.folder.name}: {member.status}, {member.reason}")
        print("same rows:", read_rows(alone.folder) == read_rows(swept.folder))


if __name__ == "__main__":
    main()
