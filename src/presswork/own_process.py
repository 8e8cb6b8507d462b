# SPDX-License-Identifier: Apache-2.0
"""One call in a process of its own, for libraries in C++ that may crash on what they read, or never end."""

from __future__ import annotations

import os
import pickle
import resource
import signal
import subprocess
import sys
from pkgutil import resolve_name
from typing import Any


class DiedError(Exception):
    """A call whose process has ended without an answer; the message describes its end."""


def call_apart(place: str, *arguments: Any, seconds: int | None = None) -> Any:
    """Return what a function gives in a process of its own; raise what it raises.

    place: the function, as "module:name"; arguments, result and exceptions are pickled. seconds: most processor time,
    without a limit by default. Raises DiedError if the process crashes or runs out of time.
    """
    command = [sys.executable, "-m", "presswork.own_process"]
    request = pickle.dumps((place, arguments, seconds))
    done = subprocess.run(command, input=request, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    if done.returncode == -signal.SIGXCPU:
        raise DiedError(f"takes more than {seconds} s")
    if done.returncode < 0:
        number = -done.returncode
        raise DiedError(f"crashes ({signal.Signals(number).name if number in set(signal.Signals) else number})")
    if done.returncode or not done.stdout:
        raise DiedError(f"ends with status {done.returncode}")
    has_result, answer = pickle.loads(done.stdout)
    if not has_result:
        raise answer
    return answer


def main() -> None:
    """Answer one request; what libraries print goes nowhere."""
    with os.fdopen(os.dup(1), "wb") as answers:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for output in (1, 2):
            os.dup2(nowhere, output)
        place, arguments, seconds = pickle.load(sys.stdin.buffer)
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
        if seconds is not None:
            hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, hard))
        try:
            answer = True, resolve_name(place)(*arguments)
        except Exception as error:
            answer = False, error
        pickle.dump(answer, answers)


if __name__ == "__main__":
    main()
