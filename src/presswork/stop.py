# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C, SIGTERM and pauses of a run: read between its steps, so that no step and no file is cut short.

A signal that raised at once could do so inside a callback of the HDF5 library, which loses it, or in the middle of a
state. `look` is called once an iteration or a second of cycles, and after every write.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)

Agree = Callable[[int], int]
"""Function for several processes that compute one run: returns the largest of their numbers."""

_EVERY = 0.1
"""Seconds between two looks for a pause."""

_agree: Agree | None = None
_is_paused: Callable[[], bool] | None = None
_looked = 0.0
_asked = 0
_seen = False


@contextmanager
def listen(agree: Agree | None = None, is_paused: Callable[[], bool] | None = None) -> Iterator[None]:
    """Count signals until the block ends. One that nobody read raises KeyboardInterrupt there.

    agree: then all processes read a signal that one of them has got, where they look next. is_paused: whether to wait
    there; a signal ends the pause.

    In a thread other than the main one, where Python does not allow it, nothing changes.
    """
    global _agree, _asked, _seen, _is_paused
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _agree, _asked, _seen, _is_paused = agree, 0, False, is_paused
    before = {number: signal.signal(number, _count) for number in SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        lost, _asked = _asked > 0 and not _seen, 0
        _agree = _is_paused = None
    if lost:
        raise KeyboardInterrupt


def look() -> None:
    """Wait while the run is paused; raise KeyboardInterrupt if a signal has come since `listen` began, once."""
    global _seen
    _wait_while_paused()
    if not _seen and (_agree(_asked) if _agree else _asked):
        _seen = True
        raise KeyboardInterrupt


def _wait_while_paused() -> None:
    global _looked
    if _is_paused is None or time.monotonic() < _looked + _EVERY:
        return
    while _is_paused() and not _asked:
        time.sleep(_EVERY)
    _looked = time.monotonic()


def is_urgent() -> bool:
    """Return whether a second signal has come."""
    return _asked > 1


def _count(number: int, frame: FrameType | None) -> None:
    global _asked
    _asked += 1
