# SPDX-License-Identifier: Apache-2.0
"""The way to a worker: send a mutant, wait a bounded time, start another worker where one died."""

from __future__ import annotations

import json
import os
import pickle
import select
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
LONGEST = 60.0
"""Seconds after which a mutant hangs: twenty times what the slowest takes on a machine with other work."""


class Reader:
    """One worker, started when it is needed."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None

    def read(self, kind: str, content: bytes) -> tuple[str, str]:
        """Return the worker's verdict on a mutant and what it said; "crash" and "hang" are verdicts, too."""
        process = self._process or self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(pickle.dumps((kind, content)))
            process.stdin.flush()
        except BrokenPipeError:
            self.close()
            return "crash", "the process had ended before it was asked"
        process.stdout.readline()  # the worker may have to compute a run whose results are changed
        ready, _, _ = select.select([process.stdout], [], [], LONGEST)
        if not ready:
            self.close()
            return "hang", f"no answer within {LONGEST:g} s"
        line = process.stdout.readline()
        if not line:
            code = process.wait()
            self.close()
            return "crash", f"the process ended with {code}"
        verdict, text = json.loads(line)
        return verdict, text

    def close(self) -> None:
        """End the worker."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _start(self) -> subprocess.Popen[bytes]:
        paths = [str(ROOT), str(ROOT / "tests" / "verification"), os.environ.get("PYTHONPATH", "")]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OMP_NUM_THREADS": "1"}
        command = [sys.executable, "-m", "tests.mutants.worker"]
        self._process = subprocess.Popen(
            command,
            bufsize=0,  # select must see a line that has come
            cwd=ROOT,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        return self._process


def write_seed(kind: str) -> bytes:
    """Return the content of a valid file of a kind."""
    from tests.mutants.kinds import KINDS

    with tempfile.TemporaryDirectory() as folder:
        KINDS[kind].make(Path(folder))
        return (Path(folder) / KINDS[kind].name).read_bytes()
