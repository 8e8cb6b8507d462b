# SPDX-License-Identifier: Apache-2.0
"""Runs in processes of their own: begun here, held, stopped at a checkpoint, let go on; those begun elsewhere, too."""

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
from presswork.results.progress import RunProgress, read_progress
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
        """Return what the process said last on standard error."""
        self.errors.seek(0)
        lines = self.errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else ""


class Jobs:
    """The runs at work in the opened folder."""

    def __init__(self, root: Path, scratch: Path) -> None:
        """scratch: a folder for what runs say."""
        self._root, self._scratch = root, scratch
        self._begun: dict[Path, _Job] = {}
        self._held: dict[Path, int] = {}
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
        """Let a run go on: one that is held, at once; one that was stopped, from its checkpoint."""
        if folder in self._held:
            self._signal(folder, signal.SIGCONT)
            self._held.pop(folder, None)
            return
        if not (folder / CHECKPOINT).is_file():
            raise RefusedError("there is no checkpoint to go on from", 409)
        self.begin(folder / CASE, folder, "--resume")

    def pause(self, folder: Path) -> None:
        """Hold a run; it keeps its memory and goes on at once."""
        self._held[folder] = self._signal(folder, signal.SIGSTOP)

    def stop(self, folder: Path) -> None:
        """Stop a run after the increment at work, with a checkpoint, as Ctrl-C does."""
        self._signal(folder, signal.SIGINT)
        if self._held.pop(folder, None):
            self._signal(folder, signal.SIGCONT)

    def _signal(self, folder: Path, number: signal.Signals) -> int:
        progress = read_progress(folder)
        if progress is None:
            raise RefusedError("no run is at work there", 409)
        os.kill(progress.process, number)
        return progress.process

    def state(self, folder: Path, summary: dict[str, Any]) -> dict[str, Any]:
        """Return how a run stands: a word, how far it is, what can be done with it."""
        progress, job = read_progress(folder), self._begun.get(folder)
        is_begun = job is not None and job.process.poll() is None
        text = "" if job is None or is_begun or job.process.returncode == 0 else job.last_words()
        if progress:
            return self._state_at_work(folder, progress)
        self._held.pop(folder, None)
        fraction = float(summary.get("fraction_computed") or (1.0 if summary.get("status") == "completed" else 0.0))
        if is_begun and summary.get("status") != "completed":
            return {"word": "starting", "fraction": fraction, "text": "", "is_running": True, "can": []}
        word = str(summary.get("status") or ("failed" if text else "stopped" if (folder / RESULTS).exists() else "new"))
        can = ["resume"] if word not in ("completed", "failed") and (folder / CHECKPOINT).is_file() else []
        return {"word": word, "fraction": fraction, "text": text, "is_running": is_begun, "can": can}

    def _state_at_work(self, folder: Path, progress: RunProgress) -> dict[str, Any]:
        is_held = self._held.get(folder) == progress.process
        return {
            "word": "paused" if is_held else "running",
            "fraction": progress.fraction,
            "text": progress.text,
            "is_running": True,
            "can": ["resume", "stop"] if is_held else ["pause", "stop"],
        }

    def close(self) -> None:
        """Stop the runs begun here, at their checkpoints, and wait for them."""
        for folder, job in self._begun.items():
            if job.process.poll() is None:
                job.process.send_signal(signal.SIGINT)
                if folder in self._held:
                    job.process.send_signal(signal.SIGCONT)
        for job in self._begun.values():
            job.process.wait()
            job.errors.close()
