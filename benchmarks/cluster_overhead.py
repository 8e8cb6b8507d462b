# SPDX-License-Identifier: Apache-2.0
"""What a member costs on a cluster of this machine beyond what it costs in processes, one at a time, in turns.

Wall times, the least of all rounds; on a machine with other work they are only an upper bound. The exit status is 1 if
the target is missed.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from time import perf_counter

from presswork import Case
from presswork.examples import copy_example
from presswork.study import Cluster
from presswork.study.cluster.pool import open_cluster_pool
from presswork.study.processes import Processes
from presswork.study.runner import Ended, Runner, Task
from tests.problems.dask_cluster import dask_cluster

TARGET = 0.2
"""Seconds a member, at most."""
TINY = ["workpiece.mesh.cells=[2,1]", "stages.0.tools.punch.stroke=0.05", "output.steps=1"]


def time_members(runner: Runner, tasks: dict[int, Task]) -> float:
    """Return the seconds a member of running tasks that must complete."""
    start = perf_counter()
    ends = [event for event in runner.run(tasks) if isinstance(event, Ended)]
    assert [end.status for end in ends] == len(tasks) * ["completed"]
    return (perf_counter() - start) / len(tasks)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--members", type=int, default=5)
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as text, dask_cluster(Path(text)) as cluster:
        folder = Path(text)
        cluster.add_worker()
        case = Case.from_toml(copy_example("ring_compression", folder), TINY)
        times: dict[str, list[float]] = {"processes": [], "cluster": [], "brought back": []}
        with (
            open_cluster_pool(Cluster(cluster.address), 0) as shared,
            open_cluster_pool(Cluster(cluster.address, bring_back=True), 0) as distant,
        ):
            runners: dict[str, Runner] = {"processes": Processes(1), "cluster": shared, "brought back": distant}
            for _ in range(arguments.repeats):
                for name, runner in runners.items():
                    tasks = {i: Task(case, folder / f"member_{i:03d}", "overwrite") for i in range(arguments.members)}
                    times[name].append(time_members(runner, tasks))
    least = {name: min(values) for name, values in times.items()}
    for name, seconds in least.items():
        print(f"{name:14s}{seconds:7.3f} s a member, {seconds - least['processes']:+.3f} s")
    return int(max(least.values()) - least["processes"] > TARGET)


if __name__ == "__main__":
    raise SystemExit(main())
