# SPDX-License-Identifier: Apache-2.0
"""A run in a process of its own that kills or signals itself at a chosen operation on its files."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from presswork.case import build_model, read_case
from presswork.recorder import run_model
from presswork.results import OutputError, whole_file

PROCESSES = multiprocessing.get_context("forkserver")
PROCESSES.set_forkserver_preload(["presswork.recorder", "presswork.case"])


@dataclass(frozen=True)
class Fault:
    """What strikes a run, and at which of its operations on files."""

    at: int
    signals: tuple[signal.Signals, ...]


@dataclass(frozen=True)
class Ending:
    """How a run in a process of its own ended."""

    exit_code: int
    status: str
    """Of the outcome, or the error's text; empty where the process was killed."""
    operations: int
    """On files, in all."""


def run_with_fault(case: Path, overrides: list[str], folder: Path, fault: Fault | None, *, resume: bool) -> Ending:
    """Run a case and return how it ended."""
    parent, child = PROCESSES.Pipe(duplex=False)
    process = PROCESSES.Process(target=_work, args=(case, overrides, folder, fault, resume, child))
    process.start()
    child.close()
    try:
        status, operations = parent.recv()
    except EOFError:
        status, operations = "", 0
    process.join()
    assert process.exitcode is not None
    return Ending(process.exitcode, status, operations)


def _work(case: Path, overrides: list[str], folder: Path, fault: Fault | None, resume: bool, answer: Any) -> None:
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    count = 0

    def struck(operation: Callable[..., Any]) -> Callable[..., Any]:
        def strike(*args: Any, **kwargs: Any) -> Any:
            nonlocal count
            count += 1
            if fault is not None and count == fault.at:
                for each in fault.signals:
                    os.kill(os.getpid(), each)
            return operation(*args, **kwargs)

        return strike

    for module, names in (
        (os, ("replace", "fsync", "write", "unlink")),
        (shutil, ("copyfileobj",)),
        (whole_file._ForgivingFile, ("write", "readinto")),
    ):
        for name in names:
            setattr(module, name, struck(getattr(module, name)))
    model = build_model(read_case(case, overrides=overrides))
    try:
        text = run_model(model, folder, resume=resume, overwrite=not resume, threads=1).status
    except (OutputError, KeyboardInterrupt) as error:
        text = type(error).__name__ + str(error)
    answer.send((text, count))
