# SPDX-License-Identifier: Apache-2.0
"""Runs in processes of their own: begun here, paused, stopped at a checkpoint, resumed; those begun elsewhere, too."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from presswork.results.folder import CASE, CHECKPOINT, RESULTS
from presswork.results.pause import end_pause, is_paused, pause_run
from presswork.results.progress import RunProgress, find_stopped, is_stopped, read_progress
from presswork.server.opened_folder import RefusedError

_PROGRAM = """import sys, pathlib
from presswork.server.confined import confine
from presswork.server.scratch import Scratch
scratch = Scratch()
confine(pathlib.Path(sys.argv.pop(1)), scratch.folder)
from presswork.cli import main
try:
    main()
finally:
    scratch.close()"""
"""The command line, confined to the folder that is the first argument."""


@dataclass
class _Job:
    process: subprocess.Popen[bytes]
    errors: IO[bytes]

    def last_words(self) -> str:
        """Return the last lines of the process on standard error."""
        self.errors.seek(0)
        lines = self.errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else ""


class Jobs:
    """The runs at work in the opened folder."""

    def __init__(self, root: Path, scratch: Path) -> None:
        """scratch: a folder for the output of runs."""
        self._root, self._scratch = root, scratch
        self._begun: dict[Path, _Job] = {}
        self._paused: dict[Path, int] = {}
        """Handles that keep runs paused."""
        self._lock = threading.Lock()

    def begin(self, case: Path, folder: Path, *options: str) -> None:
        """Run a case into a folder, confined to the opened one. Raises RefusedError if a run is at work there."""
        with self._lock:
            job = self._begun.get(folder)
            if read_progress(folder) or (job and job.process.poll() is None):
                raise RefusedError("this run is at work already", 409)
            errors = tempfile.TemporaryFile(dir=self._scratch)  # noqa: SIM115
            arguments = ["run", str(case), "--output", str(folder), "--quiet", *options]
            command = [sys.executable, "-P", "-c", _PROGRAM, str(self._root), *arguments]
            process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True
            )
            self._begun[folder] = _Job(process, errors)

    def resume(self, folder: Path) -> None:
        """Let a run go on: one that is paused, at once; one that was stopped, from its checkpoint."""
        if read_progress(folder) and (is_paused(folder) or find_stopped(folder)):
            self._end_pause(folder)
            return
        if not (folder / CHECKPOINT).is_file():
            raise RefusedError("there is no checkpoint to go on from", 409)
        self.begin(folder / CASE, folder, "--resume")

    def pause(self, folder: Path) -> None:
        """Pause a run; it keeps its memory and goes on at once, also where this process is killed."""
        with self._lock:
            if read_progress(folder) is None:
                raise RefusedError("no run is at work there", 409)
            if not is_paused(folder):
                self._forget(folder)
                self._paused[folder] = pause_run(folder)

    def stop(self, folder: Path) -> None:
        """Stop a run after the increment at work, with a checkpoint, as Ctrl-C does."""
        progress = read_progress(folder)
        if progress is None:
            raise RefusedError("no run is at work there", 409)
        os.kill(progress.process, signal.SIGINT)
        self._end_pause(folder)

    def _end_pause(self, folder: Path) -> None:
        """End the pause of a run, whoever made it, and wake one that is stopped."""
        with self._lock:
            end_pause(folder)
            self._forget(folder)
        if (process := find_stopped(folder)) is not None:
            os.kill(process, signal.SIGCONT)

    def _forget(self, folder: Path) -> None:
        """Close the handle that keeps a run paused, if there is one."""
        if (handle := self._paused.pop(folder, None)) is not None:
            os.close(handle)

    def state(self, folder: Path, summary: dict[str, Any]) -> dict[str, Any]:
        """Return how a run stands: a word, how far it is, what can be done with it."""
        progress, job = read_progress(folder), self._begun.get(folder)
        is_begun = job is not None and job.process.poll() is None
        text = "" if job is None or is_begun or job.process.returncode == 0 else job.last_words()
        if progress:
            return self._state_at_work(folder, progress)
        with self._lock:
            self._forget(folder)
        fraction = float(summary.get("fraction_computed") or (1.0 if summary.get("status") == "completed" else 0.0))
        if is_begun and summary.get("status") != "completed":
            return {"word": "starting", "fraction": fraction, "text": "", "is_running": True, "can": []}
        word = str(summary.get("status") or ("failed" if text else "stopped" if (folder / RESULTS).exists() else "new"))
        can = ["resume"] if word not in ("completed", "failed") and (folder / CHECKPOINT).is_file() else []
        return {"word": word, "fraction": fraction, "text": text, "is_running": is_begun, "can": can}

    def _state_at_work(self, folder: Path, progress: RunProgress) -> dict[str, Any]:
        is_held = is_paused(folder) or is_stopped(progress.process)
        return {
            "word": "paused" if is_held else "running",
            "fraction": progress.fraction,
            "text": progress.text,
            "is_running": True,
            "can": ["resume", "stop"] if is_held else ["pause", "stop"],
        }

    def close(self) -> None:
        """Stop the runs begun here, at their checkpoints, and wait for them; what is paused goes on."""
        for job in self._begun.values():
            if job.process.poll() is None:
                job.process.send_signal(signal.SIGINT)
        for folder in list(self._paused):
            self._end_pause(folder)
        for job in self._begun.values():
            job.process.wait()
            job.errors.close()
