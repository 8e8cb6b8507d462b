# SPDX-License-Identifier: Apache-2.0
"""What the loops of neighbouring ranks exchange in every cycle: messages made once, and started again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from presswork.model import FloatArray
from presswork.ranks.world import World


class Channel:
    """Messages with each neighbour, and numbers that all ranks share.

    out, into (nodes, width): the records of all neighbours' nodes, one neighbour after the other in the order of ranks.
    shared (1 + n,): of the first the largest of all ranks is found, of the next `sums` the sums.
    """

    def __init__(
        self, world: World, sent: Mapping[int, int], received: Mapping[int, int], n_shared: int, width: int
    ) -> None:
        """sent, received: by rank, how many nodes go there and come from there; width: numbers of a node."""
        self._world = world
        self.out = np.zeros((sum(sent.values()), width))
        self.into = np.zeros((sum(received.values()), width))
        self.shared = np.zeros(1 + n_shared)
        self.sums = 0
        self._requests = [
            *(world.prepare_receive(part, rank) for rank, part in _split(self.into, received)),
            *(world.prepare_send(part, rank) for rank, part in _split(self.out, sent)),
        ]
        self._n_sent = len(sent)
        self._agreeing: list[Any] = []

    def send(self) -> None:
        """Start what goes out and comes in."""
        self._world.start(self._requests, self._n_sent, self.out.nbytes)

    def propose(self) -> None:
        """Start to agree on what is shared."""
        self._agreeing = self._world.start_to_agree(self.shared, sums=self.sums)

    def receive(self) -> None:
        """Wait until all has come, and all that goes out may be changed."""
        self._world.wait(self._requests)

    def agree(self) -> None:
        """Wait until all ranks have sent what is shared."""
        self._world.wait(self._agreeing)

    def find_largest(self, numbers: FloatArray) -> None:
        """Find the largest of each number (n,) of all ranks, in place."""
        self._world.find_largest(numbers)


def _split(records: FloatArray, counts: Mapping[int, int]) -> list[tuple[int, FloatArray]]:
    """Return the rows of each rank."""
    ranks = sorted(counts)
    ends = np.cumsum([counts[rank] for rank in ranks])[:-1].astype(np.intp)
    return list(zip(ranks, np.split(records, ends), strict=True)) if ranks else []
