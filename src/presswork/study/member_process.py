# SPDX-License-Identifier: Apache-2.0
"""A member's process, as whoever started it sees it.

Nothing here knows what a case is, so that a worker of a cluster loads this module at once.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from threading import Event, Thread
from typing import Literal

Ending = Literal["completed", "gave_up", "failed", "bad_input", "interrupted"]
Mode = Literal["new", "overwrite", "resume"]

GRACE = 30.0
"""Seconds that a member has to leave a checkpoint, once its time is over or nobody waits for it; then it is killed."""
_LOOK_EVERY = 0.25
_STOPPED = "stopped by the user or a signal; continue with --resume"


@dataclass(frozen=True)
class Work:
    """What a member's process is to do."""

    job: bytes
    """The pickled case, or its Model."""
    folder: str
    mode: Mode
    threads: int = 1
    seconds: float | None = None
    """Longest time that it may take."""
    memory: int | None = None
    """Most memory that it may take [bytes]."""


class MemberProcess:
    """`python -m presswork.study.member` at work on one member."""

    def __init__(self, work: Work) -> None:
        threads = str(work.threads)
        self._work = work
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 (`follow` closes it)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "presswork.study.member"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env={**os.environ, "OMP_NUM_THREADS": threads, "MKL_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads},
            start_new_session=True,  # Ctrl-C in the terminal comes from whoever started it, once
        )
        self._stopped = self._late = False

    def stop(self, number: signal.Signals = signal.SIGINT) -> None:
        """Have it save a checkpoint and end, or kill it."""
        self._stopped = True
        self._process.send_signal(number)

    def follow(
        self, on_progress: Callable[[float, str], None], is_wanted: Callable[[], bool] | None = None
    ) -> tuple[Ending, str]:
        """Wait for its end, and return how it ended and why not well.

        on_progress: gets the completed fraction and a line of text. is_wanted: whether anybody still waits for it;
        otherwise it is stopped, as it is when its time is over.
        """
        over = Event()
        guard = Thread(target=self._guard, args=(over, is_wanted), daemon=True)
        if self._work.seconds or is_wanted:
            guard.start()
        try:
            ending = self._listen(on_progress)
            code = self._process.wait()
        finally:
            over.set()
        with self._errors:
            return self._explain(ending, code)

    def _guard(self, over: Event, is_wanted: Callable[[], bool] | None) -> None:
        """Stop it when its time is over, or when nobody waits for it; kill it if it does not stop."""
        end = time.monotonic() + (self._work.seconds or float("inf"))
        while not over.wait(_LOOK_EVERY):
            self._late = time.monotonic() > end
            if self._late or (is_wanted is not None and not is_wanted()):
                self.stop()
                if not over.wait(GRACE):
                    self.stop(signal.SIGKILL)
                return

    def _listen(self, on_progress: Callable[[float, str], None]) -> tuple[Ending, str] | None:
        """Hand over the work and return the ending that it reports; None if it died without a word."""
        work, stdin, stdout = self._work, self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        order = {name: getattr(work, name) for name in ("folder", "mode", "threads", "memory")}
        order["bytes"] = len(work.job)
        ending: tuple[Ending, str] | None = None
        try:
            with suppress(BrokenPipeError), stdin:  # open to its end: when it closes, the member knows that we are gone
                stdin.write(json.dumps(order).encode() + b"\n" + work.job)
                stdin.flush()
                for line in stdout:
                    try:
                        message = json.loads(line)
                    except ValueError:
                        continue  # a library that prints
                    if "status" in message:
                        ending = message["status"], message["reason"]
                    elif "fraction" in message:
                        on_progress(message["fraction"], message["text"])
        finally:
            stdout.close()
        return ending

    def _explain(self, ending: tuple[Ending, str] | None, code: int) -> tuple[Ending, str]:
        """Return how it ended in the end."""
        if self._late and (ending is None or ending[0] == "interrupted"):
            kept = "; --resume goes on from its checkpoint" if ending else ""
            return "failed", f"not over after --member-timeout {self._work.seconds:g} s, so it was stopped{kept}"
        if ending is not None:
            status, reason = ending
            return status, reason + self._name_share() if "memory" in reason and status == "failed" else reason
        if self._stopped:
            return "interrupted", _STOPPED
        self._errors.seek(0)
        words = self._errors.read().decode(errors="replace").strip().splitlines()
        last = f": {words[-1]}" if words else ""
        return "failed", f"its process ended with status {code}{last}" + self._name_share()

    def _name_share(self) -> str:
        """Describe the memory that it could take, if that was limited."""
        if not self._work.memory:
            return ""
        return (
            f"; its share of the worker's memory was {self._work.memory / 1e6:,.0f} MB: give the workers more memory, "
            "or fewer threads, which share it"
        )
