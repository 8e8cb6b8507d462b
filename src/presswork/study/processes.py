# SPDX-License-Identifier: Apache-2.0
"""Processes that compute members, a few at a time; what they say comes as one stream of events."""

from __future__ import annotations

import json
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Lock, current_thread, main_thread
from typing import Literal

from presswork.study.member import Task

Ending = Literal["completed", "gave_up", "failed", "bad_input", "interrupted"]


@dataclass(frozen=True)
class Started:
    """A member's process runs."""

    member: int


@dataclass(frozen=True)
class Moved:
    """A member has come this far."""

    member: int
    fraction: float


@dataclass(frozen=True)
class Ended:
    """A member's process is over."""

    member: int
    status: Ending
    reason: str


Event = Started | Moved | Ended


class Pool:
    """Runs each task in its own process, `jobs` at a time; a thread waits for each."""

    def __init__(self, tasks: Mapping[int, Task], jobs: int) -> None:
        self._tasks = tasks
        self._jobs = max(1, min(jobs, len(tasks) or 1))
        self._events: queue.SimpleQueue[Event] = queue.SimpleQueue()
        self._running: dict[int, subprocess.Popen[bytes]] = {}
        self._lock = Lock()
        self._stopping = False
        self._interrupts = 0

    def run(self) -> Iterator[Event]:
        """Yield events until every task has ended. Ctrl-C stops the running ones; those not started get no event."""
        handled = 0
        with _count_interrupts(self), ThreadPoolExecutor(self._jobs) as threads:
            futures = [threads.submit(self._watch, member, task) for member, task in self._tasks.items()]
            try:
                while True:
                    if self._interrupts > handled:
                        self._stop(signal.SIGINT if handled == 0 else signal.SIGKILL)
                        handled = self._interrupts
                    over = all(future.done() for future in futures)
                    try:
                        yield self._events.get(timeout=0.0 if over else 0.2)
                    except queue.Empty:
                        if over:
                            break
            finally:
                self._stop(signal.SIGINT)
            for future in futures:
                future.result()

    def interrupt(self, *_: object) -> None:
        """Note that the user wants to stop: the first time gently, then at once."""
        self._interrupts += 1

    def _stop(self, number: signal.Signals) -> None:
        """Start nothing more and signal what runs: it saves a checkpoint and ends, unless it is killed."""
        with self._lock:
            self._stopping = True
            for process in self._running.values():
                process.send_signal(number)

    def _watch(self, member: int, task: Task) -> None:
        """Run one task, passing on what it says."""
        with tempfile.TemporaryFile() as errors:
            with self._lock:
                if self._stopping:
                    return
                process = subprocess.Popen(
                    [sys.executable, "-m", "presswork.study.member"],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=errors,
                    env={**os.environ, "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
                    start_new_session=True,  # Ctrl-C in the terminal comes from here, once
                )
                self._running[member] = process
            self._events.put(Started(member))
            ending = self._listen(member, task, process)
            code = process.wait()
            with self._lock:
                del self._running[member]
            if ending is None and self._stopping:
                ending = Ended(member, "interrupted", "stopped by the user or a signal; continue with --resume")
            elif ending is None:
                errors.seek(0)
                words = errors.read().decode(errors="replace").strip().splitlines()
                reason = f"its process ended with status {code}" + (f": {words[-1]}" if words else "")
                ending = Ended(member, "failed", reason)
            self._events.put(ending)

    def _listen(self, member: int, task: Task, process: subprocess.Popen[bytes]) -> Ended | None:
        """Hand over the task and return how it ended; None if the process died without a word."""
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            with process.stdin:
                pickle.dump(task, process.stdin)
        except BrokenPipeError:
            return None
        ending = None
        with process.stdout:
            for line in process.stdout:
                try:
                    message = json.loads(line)
                except ValueError:
                    continue  # a library that prints
                if "status" in message:
                    ending = Ended(member, message["status"], message["reason"])
                elif "fraction" in message:
                    self._events.put(Moved(member, message["fraction"]))
        return ending


@contextmanager
def _count_interrupts(pool: Pool) -> Iterator[None]:
    """Have Ctrl-C and SIGTERM noted by the pool for a while, where that can be: in the main thread."""
    if current_thread() is not main_thread():
        yield
        return
    former = {number: signal.signal(number, pool.interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)
