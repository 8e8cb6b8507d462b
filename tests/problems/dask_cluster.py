# SPDX-License-Identifier: Apache-2.0
"""A Dask scheduler and workers in processes of their own, on this machine's loopback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path


class DaskCluster:
    """A scheduler, and workers that are started one by one."""

    def __init__(self, folder: Path, settings: Mapping[str, str]) -> None:
        self.folder = folder
        self._environment = {**os.environ, **settings}
        self._processes: list[subprocess.Popen[bytes]] = []
        file = folder / "scheduler.json"
        options = ("--port", "0", "--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0", "--no-show")
        self._start("scheduler", *options, "--scheduler-file", str(file))
        end = time.monotonic() + 60
        while not file.exists() or not file.read_text().strip():
            assert time.monotonic() < end
            time.sleep(0.05)
        self.address: str = json.loads(file.read_text())["address"]

    def add_worker(self, *options: str) -> subprocess.Popen[bytes]:
        """Start a worker of one thread, without anything that starts it again when it dies."""
        fixed = ("--no-nanny", "--nthreads", "1", "--no-dashboard", "--local-directory", str(self.folder))
        return self._start("worker", self.address, *fixed, *options)

    def _start(self, *command: str) -> subprocess.Popen[bytes]:
        with open(self.folder / f"{len(self._processes)}.log", "wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *command],
                cwd=self.folder,
                env=self._environment,
                stdout=log,
                stderr=log,
            )
        self._processes.append(process)
        return process

    def close(self) -> None:
        """Kill all that was started."""
        for process in reversed(self._processes):
            process.kill()
            process.wait()


@contextmanager
def dask_cluster(folder: Path, **settings: str) -> Iterator[DaskCluster]:
    """Provide a scheduler. settings: of Dask, as environment variables."""
    cluster = DaskCluster(folder, settings)
    try:
        yield cluster
    finally:
        cluster.close()
