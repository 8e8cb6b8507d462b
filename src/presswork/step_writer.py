# SPDX-License-Identifier: Apache-2.0
"""Saved steps of a run, written to results.vtkhdf by a thread of its own while the run computes on.

The file is whole at any instant, as ever: steps are appended one after the other, each to a copy that takes the file's
name (results/vtkhdf.py). A step that could not be written stops the run, with the message of its error, where the next
thing is recorded; and no checkpoint counts on a step that is not on the disk.
"""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from presswork.model import Mesh
from presswork.process.run import Snapshot
from presswork.results import OutputError, append_step, count_steps, truncate_steps
from presswork.results.history import BY_OTHERS


def append_snapshot(path: Path, mesh: Mesh, now: Snapshot) -> None:
    """Append a state to a results file. Raises OutputError."""
    append_step(
        path,
        mesh,
        now.time,
        now.point_data,
        now.cell_data,
        tools=now.tools,
        tool_centre=now.tool_centre,
        tool_displacement=now.tool_displacement,
        tool_angle=now.tool_angle,
        tool_rotation=now.tool_rotation,
        surfaces=now.surfaces,
        dies=now.dies,
        info=now.info,
    )


class StepWriter:
    """The results file of a run that is going on."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.count = 0
        """Steps that belong to the run, the one that is being written included."""
        self._thread = ThreadPoolExecutor(1, "results")
        self._writing: Future[None] | None = None

    def append(self, mesh: Mesh, now: Snapshot) -> None:
        """Begin to append a step, once the one before is written. Raises the OutputError of that one."""
        self.wait()
        self._writing = self._thread.submit(self._append, self.count, mesh, now)
        self.count += 1

    def _append(self, count: int, mesh: Mesh, now: Snapshot) -> None:
        self._require(count)
        append_snapshot(self._path, mesh, now)

    def _require(self, count: int) -> None:
        if count_steps(self._path) != count:
            raise OutputError(f"{self._path} was deleted or changed {BY_OTHERS}")

    def look(self) -> None:
        """Raise the OutputError of a step that has failed by now."""
        if self._writing is not None and self._writing.done():
            self.wait()

    def wait(self) -> None:
        """Wait until all steps are on the disk. Raises OutputError if one is not."""
        if self._writing is not None:
            self._writing.result()
            self._writing = None

    def append_last(self, mesh: Mesh, now: Snapshot) -> None:
        """Write a step beyond the run's own, which a run that is resumed drops again."""
        self.wait()
        truncate_steps(self._path, self.count)
        append_snapshot(self._path, mesh, now)

    def go_back(self, count: int) -> None:
        """Cut the file back to so many steps."""
        self.wait()
        self.count = count
        truncate_steps(self._path, count)

    def check(self) -> None:
        """Wait, and raise OutputError if the file has fewer steps than the run."""
        self.wait()
        if count_steps(self._path) < self.count:
            raise OutputError(f"{self._path} was deleted or changed {BY_OTHERS}")

    def close(self) -> None:
        """Let the step that is being written end; the thread ends."""
        self._thread.shutdown()
