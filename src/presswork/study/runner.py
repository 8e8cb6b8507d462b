# SPDX-License-Identifier: Apache-2.0
"""What runs the members of a study: tasks go in, one stream of events comes out."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import current_thread, main_thread
from typing import TYPE_CHECKING, Protocol

from presswork.study.member_process import Ending, Mode

if TYPE_CHECKING:
    from presswork.case.any_case import AnyCase
    from presswork.model import Model, OneStepModel


@dataclass(frozen=True)
class Task:
    """One member to be computed."""

    job: AnyCase | Model | OneStepModel
    folder: Path
    mode: Mode


@dataclass(frozen=True)
class Started:
    """A member's process runs."""

    member: int


@dataclass(frozen=True)
class Moved:
    """A member has come this far."""

    member: int
    fraction: float
    text: str
    """Stage, increment and tools in a line."""


@dataclass(frozen=True)
class Ended:
    """A member's process is over."""

    member: int
    status: Ending
    reason: str


Event = Started | Moved | Ended


class Runner(Protocol):
    """Processes of this machine, or the workers of a cluster."""

    def run(self, tasks: Mapping[int, Task]) -> Iterator[Event]:
        """Yield events until every task has ended. Ctrl-C stops the running ones; those not started get no event."""
        ...


class Interrupts:
    """How often the user has asked to stop: the first time gently, then at once."""

    def __init__(self) -> None:
        self.count = 0

    def add(self, *_: object) -> None:
        """Note that the user wants to stop."""
        self.count += 1

    @contextmanager
    def counted(self) -> Iterator[None]:
        """Count Ctrl-C and SIGTERM for a while, where that can be: in the main thread."""
        if current_thread() is not main_thread():
            yield
            return
        former = {number: signal.signal(number, self.add) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in former.items():
                signal.signal(number, handler)
