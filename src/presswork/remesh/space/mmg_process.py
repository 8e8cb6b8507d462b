# SPDX-License-Identifier: Apache-2.0
"""MMG in a process of its own: a mesh that it never finishes, or on which it crashes, costs that mesh, not the run."""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from presswork.mesh.checks import MeshError


class MmgProcess:
    """The process, which starts with the first mesh and waits for the next one."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0
        """The process that has started it: one that was forked off starts another."""
        self.seconds = 0.0
        """Processor time that answers have taken so far; clocks of this process do not count it."""

    def ask(self, body: dict[str, Any], options: dict[str, Any], *, memory: int, seconds: float) -> dict[str, Any]:
        """Return what make_mesh of mmg_worker.py returns; seconds: of processor time. Raises MeshError."""
        process = self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        request = {"body": body, "options": options, "memory": memory, "seconds": seconds}
        try:
            pickle.dump(request, process.stdin)
            process.stdin.flush()
            answer: dict[str, Any] = pickle.load(process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError) as error:
            self.stop()
            ended = f"has not made a mesh in {seconds:.3g} s" if _ran_out(process) else "has crashed"
            raise MeshError(f"MMG {ended}", "smaller cells") from error
        except BaseException:  # its answer would be taken for that to the next request
            self.stop()
            raise
        self.seconds += answer["seconds"]
        if "fault" in answer:
            raise MeshError(f"MMG cannot mesh the body anew ({answer['fault']})", "smaller cells")
        return answer

    def stop(self) -> None:
        """End the process, if there is one."""
        if self._process is not None and self._owner == os.getpid():
            self._process.kill()
            self._process.communicate()
        self._process = None

    def _start(self) -> subprocess.Popen[bytes]:
        if self._process is None or self._owner != os.getpid():
            program = str(Path(__file__).with_name("mmg_worker.py"))
            pipe = subprocess.PIPE
            command = [sys.executable, "-P", program]
            try:
                self._process = subprocess.Popen(
                    command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, start_new_session=True
                )
            except OSError as error:
                raise MeshError(f"MMG's process cannot be started ({error})", "free memory") from error
            self._owner = os.getpid()
        return self._process


def _ran_out(process: subprocess.Popen[bytes]) -> bool:
    """Return whether a process has ended at the limit of its processor time."""
    limit = getattr(signal, "SIGXCPU", None)
    return limit is not None and process.returncode == -limit


MMG = MmgProcess()
"""The process of this program."""
atexit.register(MMG.stop)
