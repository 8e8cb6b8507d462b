# SPDX-License-Identifier: Apache-2.0
"""Ranks that are threads of one process: a communicator with the calls of mpi4py that presswork makes, without MPI."""

from __future__ import annotations

import threading
from collections.abc import Callable
from queue import Queue
from typing import Any

import numpy as np

from presswork.ranks.world import World


class _Request:
    def __init__(self, wait: Callable[[], None] = lambda: None) -> None:
        self.Wait = wait


class ThreadRank:
    """One rank's communicator."""

    def __init__(self, rank: int, board: list[Any], barrier: threading.Barrier, mail: dict[Any, Queue[Any]]) -> None:
        self._rank, self._board, self._barrier, self._mail = rank, board, barrier, mail

    def Get_rank(self) -> int:  # noqa: N802
        return self._rank

    def Get_size(self) -> int:  # noqa: N802
        return len(self._board)

    def Isend(self, array: np.ndarray, dest: int) -> _Request:  # noqa: N802
        self._mail[self._rank, dest].put(array.copy())
        return _Request()

    def Irecv(self, array: np.ndarray, source: int) -> _Request:  # noqa: N802
        def wait() -> None:
            array[...] = self._mail[source, self._rank].get(timeout=60)

        return _Request(wait)

    def allgather(self, own: Any) -> list[Any]:
        self._board[self._rank] = own
        self._barrier.wait(60)
        found = list(self._board)
        self._barrier.wait(60)
        return found

    def alltoall(self, listed: list[Any]) -> list[Any]:
        return [row[self._rank] for row in self.allgather(listed)]

    def Allgatherv(self, own: np.ndarray, into: list[Any]) -> None:  # noqa: N802
        whole, counts = into
        parts = self.allgather(own.copy())
        assert [len(part) for part in parts] == list(counts)
        whole[...] = np.concatenate(parts)

    def bcast(self, what: Any, root: int) -> Any:
        return self.allgather(what)[root]


def on_ranks(size: int, work: Callable[[World], Any]) -> list[Any]:
    """Do work on ranks at the same time; return what each returns, or raise what one of them has raised."""
    board: list[Any] = [None] * size
    barrier = threading.Barrier(size)
    mail: dict[Any, Queue[Any]] = {(a, b): Queue() for a in range(size) for b in range(size)}
    found, errors = [None] * size, []

    def begin(rank: int) -> None:
        try:
            found[rank] = work(World(ThreadRank(rank, board, barrier, mail)))
        except Exception as error:
            errors.append(error)
            barrier.abort()

    threads = [threading.Thread(target=begin, args=(rank,)) for rank in range(size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
    return found
