# SPDX-License-Identifier: Apache-2.0
"""One member of a sweep, in its own process: `python -m presswork.study.member` under the sweep that started it.

A pickled Task comes in by stdin; progress and the end go out by stdout, one JSON object a line.
"""

from __future__ import annotations

import json
import pickle
import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from presswork.api import run
from presswork.case import CaseError
from presswork.recorder import Progress, StartError
from presswork.results import OutputError

if TYPE_CHECKING:
    from presswork.case.kinds import AnyCase

Mode = Literal["new", "overwrite", "resume"]


@dataclass(frozen=True)
class Task:
    """Task of a member's process."""

    case: AnyCase
    folder: Path
    mode: Mode


def main() -> None:
    """Run the task with one thread; a stopped or vanished sweep stops it at its last increment, with a checkpoint."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    task: Task = pickle.load(sys.stdin.buffer)
    try:
        outcome = run(
            task.case,
            task.folder,
            overwrite=task.mode == "overwrite",
            resume=task.mode == "resume",
            threads=1,
            on_increment=_send_progress,
        )
    except (CaseError, StartError) as error:
        _send(status="bad_input", reason=str(error))
    except OutputError as error:
        _send(status="failed", reason=str(error))
    except KeyboardInterrupt:
        _send(status="interrupted", reason="stopped before the first increment")
    else:
        _send(status=outcome.status, reason=outcome.reason)


def _send_progress(progress: Progress) -> None:
    try:
        _send(fraction=progress.fraction)
    except BrokenPipeError:
        raise KeyboardInterrupt from None  # the sweep is gone


def _send(**message: float | str) -> None:
    print(json.dumps(message), flush=True)


if __name__ == "__main__":
    # Pickle names the class by its module, which is not __main__ for the sweep.
    from presswork.study import member

    member.main()
