# SPDX-License-Identifier: Apache-2.0
"""Processes of this machine that compute members, a few at a time."""

from __future__ import annotations

import os
import pickle
import queue
import signal
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from threading import Lock

from presswork.study.member_process import MemberProcess, Work
from presswork.study.runner import Ended, Event, Interrupts, Moved, Started, Task


class Processes:
    """Runs each task in its own process, `jobs` at a time (0: one a core); a thread waits for each.

    seconds: longest time of a member; threads: of each, 0 for one a core.
    """

    def __init__(self, jobs: int = 0, seconds: float | None = None, threads: int = 1) -> None:
        self._jobs = jobs or count_cores()
        self._seconds = seconds
        self._threads = threads or count_cores()
        self._events: queue.SimpleQueue[Event] = queue.SimpleQueue()
        self._running: dict[int, MemberProcess] = {}
        self._lock = Lock()
        self._stopping = False
        self.interrupts = Interrupts()

    def run(self, tasks: Mapping[int, Task]) -> Iterator[Event]:
        """Yield events until every task has ended. Ctrl-C stops the running ones; those not started get no event."""
        handled, self.interrupts.count, self._stopping = 0, 0, False
        with self.interrupts.counted(), ThreadPoolExecutor(max(1, min(self._jobs, len(tasks)))) as threads:
            futures = [threads.submit(self._watch, member, task) for member, task in tasks.items()]
            try:
                while True:
                    if self.interrupts.count > handled:
                        self._stop(signal.SIGINT if handled == 0 else signal.SIGKILL)
                        handled = self.interrupts.count
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

    def _stop(self, number: signal.Signals) -> None:
        """Start nothing more and stop what runs: it saves a checkpoint and ends, unless it is killed."""
        with self._lock:
            self._stopping = True
            for process in self._running.values():
                process.stop(number)

    def _watch(self, member: int, task: Task) -> None:
        """Run one task, passing on its messages."""
        job = pickle.dumps(task.job)
        with self._lock:
            if self._stopping:
                return
            process = MemberProcess(
                Work(job, str(task.folder), task.mode, threads=self._threads, seconds=self._seconds)
            )
            self._running[member] = process
        self._events.put(Started(member))
        status, reason = process.follow(lambda fraction, text: self._events.put(Moved(member, fraction, text)))
        with self._lock:
            del self._running[member]
        self._events.put(Ended(member, status, reason))


def count_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
