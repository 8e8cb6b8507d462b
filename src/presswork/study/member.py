# SPDX-License-Identifier: Apache-2.0
"""One member of a sweep, in its own process: `python -m presswork.study.member` under whoever started it.

A line of JSON and a pickled case or Model come in by stdin, which stays open as long as anybody waits; progress and the
end go out by stdout, one JSON object a line.
"""

from __future__ import annotations

import json
import os
import pickle
import resource
import signal
import sys
import time
import traceback
from threading import Thread

from presswork.api import build, run
from presswork.case import CaseError
from presswork.law.allowed import allow_all
from presswork.outcome import ShortOfMemoryError
from presswork.recorder import Progress, StartError
from presswork.results import OutputError
from presswork.study.member_process import GRACE


def main() -> None:
    """Do the work; whoever stops or vanishes stops it at its last increment, with a checkpoint."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    allow_all()  # whoever sends a member has built its model, and would have been refused code that may not run
    order = json.loads(sys.stdin.buffer.readline())
    try:
        model = build(pickle.loads(sys.stdin.buffer.read(order["bytes"])))
        Thread(target=_watch_for_end_of_input, daemon=True).start()
        if order["memory"]:
            _limit_memory(order["memory"])
        outcome = run(
            model,
            order["folder"],
            overwrite=order["mode"] == "overwrite",
            resume=order["mode"] == "resume",
            threads=order["threads"],
            on_increment=_send_progress,
        )
    except ShortOfMemoryError as error:
        _send(status="failed", reason=str(error))
    except (CaseError, StartError) as error:
        _send(status="bad_input", reason=str(error))
    except OutputError as error:
        _send(status="failed", reason=str(error))
    except MemoryError as error:
        _send(status="failed", reason=f"out of memory {error}".strip())
    except KeyboardInterrupt:
        _send(status="interrupted", reason="stopped before the first increment")
    else:
        _send(status=outcome.status, reason=outcome.reason)


def _limit_memory(size: int) -> None:
    """Have allocations beyond a size [bytes] fail."""
    import scipy.linalg  # noqa: F401 (OpenBLAS waits for ever when it is loaded without room for its buffers)

    resource.setrlimit(resource.RLIMIT_DATA, (size, size))


def _watch_for_end_of_input() -> None:
    """Stop this process when whoever started it is gone; kill it if it does not stop."""
    os.read(sys.stdin.fileno(), 1)
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(GRACE)
    os._exit(1)


def _send_progress(progress: Progress) -> None:
    try:
        _send(fraction=progress.fraction, text=progress.text)
    except BrokenPipeError:
        raise KeyboardInterrupt from None  # whoever started it is gone


def _send(**message: float | str) -> None:
    print(json.dumps(message), flush=True)


if __name__ == "__main__":
    status = 1
    try:
        main()
        status = 0
    except BaseException:
        traceback.print_exc()
    # At once, with all files closed: to take the interpreter down costs time, and a thread waits for the input's end.
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
